#include "monitoring/online/online_graph.hpp"

namespace tachk {
namespace {

Operand until(OnlineGraph& graph, const MonitorNode& node, Operand left, Operand right, bool ahead) {
  const CellWindow window = ahead ? future_window(node) : past_window(node);
  if (window.empty) return graph.falsity();
  OnlineNode strict;
  strict.kind = ahead ? OnlineKind::strict_until : OnlineKind::strict_since;
  strict.left = left;
  strict.right = right;
  strict.to_the_end = ahead && node.upper == unbounded;
  Operand base = graph.add(strict);
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

Operand OnlineGraph::add(const OnlineNode& node) {
  nodes.push_back(node);
  return {static_cast<std::uint32_t>(nodes.size() - 1), false};
}

Operand OnlineGraph::falsity() { return add({}); }

Operand OnlineGraph::either(Operand left, Operand right) {
  OnlineNode node;
  node.kind = OnlineKind::either;
  node.left = left;
  node.right = right;
  return add(node);
}

Operand OnlineGraph::somewhere(const CellWindow& window, Operand operand) {
  if (window.empty) return falsity();
  if (window.uniform() && window.odd == CellOffsets{}) return operand;
  OnlineNode node;
  node.kind = OnlineKind::window;
  node.left = operand;
  node.window = window;
  node.to_the_end = window.odd.last == endless;
  return add(node);
}

bool OnlineGraph::is_everywhere_ahead(Operand operand) const {
  const OnlineNode& node = nodes[operand.node];
  return operand.negated && node.kind == OnlineKind::window && node.window.uniform() &&
         node.window.odd == CellOffsets{0, endless};
}

OnlineGraph make_online_graph(const MonitorProgram& program) {
  OnlineGraph graph;
  std::vector<Operand> made;
  for (const MonitorNode& node : program.nodes) {
    const auto operand = [&](std::size_t which) { return made[node.operands[which]]; };
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
    Operand result;
    switch (node.kind) {
      case NodeKind::always_false:
        result = graph.falsity();
        break;
      case NodeKind::always_true:
        result = !graph.falsity();
        break;
      case NodeKind::atom:
        result = leaf(OnlineKind::atom);
        break;
      case NodeKind::change:
        result = leaf(OnlineKind::change);
        break;
      case NodeKind::logical_not:
        result = !operand(0);
        break;
      case NodeKind::logical_and:
        result = operand(0);
        for (std::size_t n = 1; n < node.operands.size(); ++n) result = graph.both(result, operand(n));
        break;
      case NodeKind::logical_or:
        result = operand(0);
        for (std::size_t n = 1; n < node.operands.size(); ++n) result = graph.either(result, operand(n));
        break;
      case NodeKind::rise:
        result = graph.both(operand(0), !just_before());
        break;
      case NodeKind::fall:
        result = graph.both(!operand(0), just_before());
        break;
      case NodeKind::eventually:
        result = graph.somewhere(future_window(node), operand(0));
        break;
      case NodeKind::always:
        result = graph.everywhere(future_window(node), operand(0));
        break;
      case NodeKind::once:
        result = graph.somewhere(past_window(node), operand(0));
        break;
      case NodeKind::historically:
        result = graph.everywhere(past_window(node), operand(0));
        break;
      case NodeKind::until:
        result = until(graph, node, operand(0), operand(1), true);
        break;
      case NodeKind::since:
        result = until(graph, node, operand(0), operand(1), false);
        break;
    }
    made.push_back(result);
  }
  graph.root = made.back();
  return graph;
}

}  // namespace tachk
