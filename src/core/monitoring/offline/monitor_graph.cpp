#include "monitoring/offline/monitor_graph.hpp"

namespace tachk::monitoring::offline {

StreamGraph::StreamGraph(const MonitorProgram& program, Leaves leaves) : program_(&program), leaves_(leaves) {
  for (const MonitorNode& node : program.nodes) {
    bool pointwise = false;
    switch (node.kind) {
      case NodeKind::always_false:
      case NodeKind::always_true:
      case NodeKind::atom:
        pointwise = true;
        break;
      case NodeKind::logical_not:
      case NodeKind::logical_and:
      case NodeKind::logical_or:
        pointwise = leaves == Leaves::combined;
        for (const std::size_t operand : node.operands) pointwise = pointwise && pointwise_[operand];
        break;
      default:
        break;
    }
    pointwise_.push_back(pointwise);
  }
}

std::size_t StreamGraph::add(StreamNode node) {
  streams_.push_back(std::move(node));
  return streams_.size() - 1;
}

std::size_t StreamGraph::stream_of(std::size_t node, bool negated) {
  const auto found = known_.find({node, negated});
  if (found != known_.end()) return found->second;
  const std::size_t stream = build(node, negated);
  known_[{node, negated}] = stream;
  return stream;
}

std::size_t StreamGraph::build(std::size_t number, bool negated) {
  const MonitorNode& node = program_->nodes[number];
  if (pointwise_[number]) {
    StreamNode leaf{.kind = StreamKind::pointwise, .dual = negated, .inputs = {}};
    leaf.source = number;
    return add(leaf);
  }
  switch (node.kind) {
    case NodeKind::logical_not:
      return stream_of(node.operands[0], !negated);
    case NodeKind::logical_and:
    case NodeKind::logical_or:
      return junction(number, negated);
    case NodeKind::rise:
      return edge(node.operands[0], true, negated);
    case NodeKind::fall:
      return edge(node.operands[0], false, negated);
    case NodeKind::change: {
      StreamNode leaf{.kind = StreamKind::change, .dual = negated, .inputs = {}};
      leaf.source = node.atom;
      return add(leaf);
    }
    case NodeKind::eventually:
    case NodeKind::always:
      return eventually(stream_of(node.operands[0], negated), node, negated != (node.kind == NodeKind::always));
    case NodeKind::once:
    case NodeKind::historically:
      return window(stream_of(node.operands[0], negated), past_window(node),
                    negated != (node.kind == NodeKind::historically));
    case NodeKind::until:
      return until(stream_of(node.operands[0], negated), stream_of(node.operands[1], negated), node, negated);
    default:
      return since(stream_of(node.operands[0], negated), stream_of(node.operands[1], negated), node, negated);
  }
}

// The operands that are pointwise make one leaf.
std::size_t StreamGraph::junction(std::size_t number, bool negated) {
  const MonitorNode& node = program_->nodes[number];
  const bool dual = negated != (node.kind == NodeKind::logical_and);
  StreamNode leaf{.kind = StreamKind::pointwise, .dual = negated, .inputs = {}};
  leaf.source = number;
  std::vector<std::size_t> streams;
  for (const std::size_t operand : node.operands) {
    if (pointwise_[operand] && leaves_ == Leaves::combined) {
      leaf.parts.push_back(operand);
    } else {
      streams.push_back(stream_of(operand, negated));
    }
  }
  if (leaf.parts.size() == 1) {
    streams.push_back(stream_of(leaf.parts[0], negated));
  } else if (!leaf.parts.empty()) {
    streams.push_back(add(leaf));
  }
  std::size_t result = streams[0];
  for (std::size_t n = 1; n < streams.size(); ++n) result = join(result, streams[n], dual);
  return result;
}

// rise f = f and not what was before; fall f = not f and what was before. Before the trace everything is false.
std::size_t StreamGraph::edge(std::size_t operand, bool rising, bool negated) {
  const bool now_negated = rising == negated;
  const std::size_t now = stream_of(operand, now_negated);
  StreamNode before{.kind = StreamKind::before, .dual = !now_negated, .inputs = {stream_of(operand, !now_negated)}};
  return join(now, add(before), !negated);
}

std::size_t StreamGraph::constant(bool dual) { return add({.kind = StreamKind::constant, .dual = dual, .inputs = {}}); }

std::size_t StreamGraph::join(std::size_t left, std::size_t right, bool dual) {
  return add({.kind = StreamKind::join, .dual = dual, .inputs = {left, right}});
}

std::size_t StreamGraph::window(std::size_t operand, const CellWindow& offsets, bool dual) {
  if (offsets.empty) return constant(dual);
  if (offsets.uniform()) {
    if (offsets.even == CellOffsets{0, 0}) return operand;
    return add({.kind = StreamKind::window, .dual = dual, .inputs = {operand}, .offsets = offsets.even});
  }
  const std::size_t even =
      add({.kind = StreamKind::window, .dual = dual, .inputs = {operand}, .offsets = offsets.even});
  const std::size_t odd = add({.kind = StreamKind::window, .dual = dual, .inputs = {operand}, .offsets = offsets.odd});
  return add({.kind = StreamKind::select, .dual = dual, .inputs = {even, odd}});
}

std::size_t StreamGraph::suffix(std::size_t operand, const CellWindow& offsets, bool dual) {
  const std::size_t even =
      add({.kind = StreamKind::suffix, .dual = dual, .inputs = {operand}, .offsets = offsets.even});
  if (offsets.uniform()) return even;
  const std::size_t odd = add({.kind = StreamKind::suffix, .dual = dual, .inputs = {operand}, .offsets = offsets.odd});
  return add({.kind = StreamKind::select, .dual = dual, .inputs = {even, odd}});
}

// An operator without upper bound speaks about the trace up to its end. At a cell after the end of the trace, the end
// of what it speaks about is not known either: it is there or later. So `own`, the part of the window that is not later
// than the cell itself, bounds a join from below, and `full`, the whole window, bounds it from above.
std::size_t StreamGraph::spliced(std::size_t cut, std::size_t own, std::size_t full, bool dual) {
  StreamNode node{.kind = StreamKind::splice, .dual = dual, .inputs = {cut, own, full}};
  if (dual) node.inputs = {cut, full, own};
  return add(node);
}

std::size_t StreamGraph::eventually(std::size_t operand, const MonitorNode& node, bool dual) {
  const CellWindow offsets = future_window(node);
  if (node.upper != unbounded) return window(operand, offsets, dual);
  const std::size_t cut = add({.kind = StreamKind::truncate, .dual = dual, .inputs = {operand}});
  const std::size_t tail = add({.kind = StreamKind::tail, .dual = dual, .inputs = {operand}});
  const std::size_t own = node.lower == 0 && node.lower_closed ? operand : constant(dual);
  return spliced(suffix(cut, offsets, dual), own, suffix(tail, offsets, dual), dual);
}

// f U[a,b] g = F[a,b] g and G[0,a) f and F[a,a] (f U g), with (a and G[0,a] and the strict until if a is left out:
// compare Donze, Ferrere, Maler 2013. The last part may look ahead as far as it likes, as long as it is far enough for
// b. And f U g = g or the strict until.
std::size_t StreamGraph::until(std::size_t left, std::size_t right, const MonitorNode& node, bool dual) {
  const CellWindow offsets = future_window(node);
  if (offsets.empty) return constant(dual);
  const CellWindow lead = future_window(0, node.lower, true, !node.lower_closed);
  const CellWindow shift = future_window(node.lower, node.lower, true, true);
  const auto from_lower_on = [&](std::size_t f, std::size_t g, Cell horizon) {
    std::size_t core = add({.kind = StreamKind::until, .dual = dual, .inputs = {f, g}, .horizon = horizon});
    if (node.lower_closed) core = join(core, g, dual);
    if (node.lower == 0) return core;
    return join(window(core, shift, dual), window(f, lead, !dual), !dual);
  };
  if (node.upper != unbounded)
    return join(from_lower_on(left, right, 2 * (node.upper - node.lower) + 2), window(right, offsets, dual), !dual);
  const std::size_t cut = add({.kind = StreamKind::truncate, .dual = dual, .inputs = {right}});
  const std::size_t left_tail = add({.kind = StreamKind::tail, .dual = dual, .inputs = {left}});
  const std::size_t right_tail = add({.kind = StreamKind::tail, .dual = dual, .inputs = {right}});
  const std::size_t own = node.lower == 0 && node.lower_closed ? right : constant(dual);
  return spliced(from_lower_on(left, cut, endless), own, from_lower_on(left_tail, right_tail, endless), dual);
}

std::size_t StreamGraph::since(std::size_t left, std::size_t right, const MonitorNode& node, bool dual) {
  const CellWindow offsets = past_window(node);
  if (offsets.empty) return constant(dual);
  std::size_t core = add({.kind = StreamKind::since, .dual = dual, .inputs = {left, right}});
  if (node.lower_closed) core = join(core, right, dual);
  if (node.lower > 0) {
    const CellWindow lead = mirrored(future_window(0, node.lower, true, !node.lower_closed));
    const CellWindow shift = mirrored(future_window(node.lower, node.lower, true, true));
    core = join(window(core, shift, dual), window(left, lead, !dual), !dual);
  }
  return node.upper == unbounded ? core : join(core, window(right, offsets, dual), !dual);
}

}  // namespace tachk::monitoring::offline
