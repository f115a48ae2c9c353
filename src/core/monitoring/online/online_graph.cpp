#include "monitoring/online/online_graph.hpp"

namespace tachk::monitoring::online {
namespace {

Literal until(OnlineGraph& graph, const MonitorNode& node, Literal left, Literal right, bool ahead) {
  const CellWindow window = ahead ? future_window(node) : past_window(node);
  if (window.empty) return graph.falsity();
  OnlineNode strict;
  strict.kind = ahead ? OnlineKind::strict_until : OnlineKind::strict_since;
  strict.left = left;
  strict.right = right;
  strict.to_the_end = ahead && node.upper == unbounded;
  Literal base = graph.add(strict);
  if (node.lower_closed) base = graph.either(right, base);
  if (node.lower > 0) {
    CellWindow shift = future_window(node.lower, node.lower, true, true);
    CellWindow meanwhile = future_window(0, node.lower, true, false);
    if (!ahead) {
      shift = mirrored(shift);
      meanwhile = mirrored(meanwhile);
    }
    base = graph.both(graph.everywhere(meanwhile, left), graph.somewhere(shift, base));
  }
  if (node.lower == 0 && node.upper == unbounded) return base;
  return graph.both(graph.somewhere(window, right), base);
}

}  // namespace

Literal OnlineGraph::add(const OnlineNode& node) {
  nodes.push_back(node);
  return {static_cast<std::uint32_t>(nodes.size() - 1), false};
}

Literal OnlineGraph::falsity() { return add({}); }

Literal OnlineGraph::either(Literal left, Literal right) {
  OnlineNode node;
  node.kind = OnlineKind::either;
  node.left = left;
  node.right = right;
  return add(node);
}

Literal OnlineGraph::somewhere(const CellWindow& window, Literal operand) {
  if (window.empty) return falsity();
  if (window.uniform() && window.odd == CellOffsets{}) return operand;
  OnlineNode node;
  node.kind = OnlineKind::window;
  node.left = operand;
  node.window = window;
  node.to_the_end = window.odd.last == endless;
  return add(node);
}

bool OnlineGraph::is_everywhere_ahead(Literal operand) const {
  const OnlineNode& node = nodes[operand.node];
  return operand.negated && node.kind == OnlineKind::window && node.window.uniform() &&
         node.window.odd == CellOffsets{0, endless};
}

namespace {

// The image of a node; `made`: the images of those before it.
Literal made_of(OnlineGraph& graph, const MonitorNode& node, const std::vector<Literal>& made) {
  const auto operand = [&](std::size_t which) { return made[node.operands[which]]; };
  const auto joined = [&](auto join) {
    Literal result = operand(0);
    for (std::size_t n = 1; n < node.operands.size(); ++n) result = join(result, operand(n));
    return result;
  };
  const auto leaf = [&](OnlineKind kind) {
    OnlineNode result;
    result.kind = kind;
    result.atom = node.atom;
    return graph.add(result);
  };
  const auto just_before = [&] {
    OnlineNode result;
    result.kind = OnlineKind::just_before;
    result.left = operand(0);
    return graph.add(result);
  };
  switch (node.kind) {
    case NodeKind::always_false:
      return graph.falsity();
    case NodeKind::always_true:
      return !graph.falsity();
    case NodeKind::atom:
      return leaf(OnlineKind::atom);
    case NodeKind::change:
      return leaf(OnlineKind::change);
    case NodeKind::logical_not:
      return !operand(0);
    case NodeKind::logical_and:
      return joined([&](Literal left, Literal right) { return graph.both(left, right); });
    case NodeKind::logical_or:
      return joined([&](Literal left, Literal right) { return graph.either(left, right); });
    case NodeKind::rise:
      return graph.both(operand(0), !just_before());
    case NodeKind::fall:
      return graph.both(!operand(0), just_before());
    case NodeKind::eventually:
      return graph.somewhere(future_window(node), operand(0));
    case NodeKind::always:
      return graph.everywhere(future_window(node), operand(0));
    case NodeKind::once:
      return graph.somewhere(past_window(node), operand(0));
    case NodeKind::historically:
      return graph.everywhere(past_window(node), operand(0));
    case NodeKind::until:
      return until(graph, node, operand(0), operand(1), true);
    case NodeKind::since:
      break;
  }
  return until(graph, node, operand(0), operand(1), false);
}

}  // namespace

OnlineGraph make_online_graph(const MonitorProgram& program) {
  OnlineGraph graph;
  std::vector<Literal> made;
  made.reserve(program.nodes.size());
  for (const MonitorNode& node : program.nodes) made.push_back(made_of(graph, node, made));
  graph.root = made.back();
  return graph;
}

}  // namespace tachk::monitoring::online
