#include "monitoring/offline/monitor_leaves.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <stdexcept>
#include <type_traits>

namespace tachk::monitoring::offline {
namespace {

template <class Value>
Value opposite(Value value) {
  if constexpr (std::is_same_v<Value, Truth>) {
    return value ^ Truth{1};
  } else {
    return -value;
  }
}

template <class Value, bool Dual>
void fold_into(Value* left, const Value* right, std::size_t count) {
  for (std::size_t n = 0; n < count; ++n) left[n] = Lattice<Value, Dual>::join(left[n], right[n]);
}

}  // namespace

template <class Value>
PointwiseEvaluator<Value>::PointwiseEvaluator(const MonitorProgram& program) : program_(&program), atoms_(program) {
  std::vector<std::size_t> uses(program.nodes.size());
  for (const MonitorNode& node : program.nodes)
    for (const std::size_t operand : node.operands) ++uses[operand];
  for (std::size_t number = 0; number < program.nodes.size(); ++number) {
    const NodeKind kind = program.nodes[number].kind;
    const bool combines =
        kind == NodeKind::logical_not || kind == NodeKind::logical_and || kind == NodeKind::logical_or;
    shared_.push_back(uses[number] > 1 && combines);
    any_shared_ = any_shared_ || shared_.back();
  }
}

template <class Value>
const std::vector<std::size_t>& PointwiseEvaluator<Value>::shared_below(const StreamNode& leaf) {
  const std::vector<std::size_t> roots = leaf.parts.empty() ? std::vector{leaf.source} : leaf.parts;
  const auto [found, is_new] = shared_below_.try_emplace(roots);
  if (!is_new) return found->second;
  std::vector<bool> seen(program_->nodes.size());
  std::vector<std::size_t> open;
  const auto meet = [&](std::size_t number) {
    if (!seen[number]) open.push_back(number);
    seen[number] = true;
  };
  for (const std::size_t root : roots) meet(root);
  while (!open.empty()) {
    const std::size_t number = open.back();
    open.pop_back();
    if (shared_[number]) found->second.push_back(number);
    for (const std::size_t operand : program_->nodes[number].operands) meet(operand);
  }
  std::sort(found->second.begin(), found->second.end());
  return found->second;
}

template <class Value>
const Value* PointwiseEvaluator<Value>::evaluate(const StreamNode& leaf, const Samples& samples, std::size_t first,
                                                 std::size_t count) {
  if (any_shared_) {
    shared_blocks_.clear();
    for (const std::size_t shared : shared_below(leaf)) {
      node(shared, false, 0, samples, first, count);
      shared_blocks_[shared].assign(blocks_[0].begin(), blocks_[0].begin() + static_cast<std::ptrdiff_t>(count));
    }
  }
  if (leaf.parts.empty()) {
    node(leaf.source, leaf.dual, 0, samples, first, count);
  } else {
    const bool conjunction = (program_->nodes[leaf.source].kind == NodeKind::logical_and) != leaf.dual;
    junction(leaf.parts, leaf.dual, conjunction, 0, samples, first, count);
  }
  return blocks_[0].data();
}

template <class Value>
void PointwiseEvaluator<Value>::node(std::size_t number, bool negated, std::size_t depth, const Samples& samples,
                                     std::size_t first, std::size_t count) {
  if (blocks_.size() <= depth) blocks_.resize(depth + 1, std::vector<Value>(AtomEvaluator::block));
  const MonitorNode& what = program_->nodes[number];
  Value* out = blocks_[depth].data();
  if (any_shared_ && shared_[number]) {
    const auto found = shared_blocks_.find(number);
    if (found != shared_blocks_.end()) {
      std::transform(found->second.begin(), found->second.end(), out,
                     [&](Value value) { return negated ? opposite(value) : value; });
      return;
    }
  }
  switch (what.kind) {
    case NodeKind::always_false:
    case NodeKind::always_true:
      std::fill_n(out, count,
                  negated != (what.kind == NodeKind::always_true) ? Bounds<Value>::greatest : Bounds<Value>::least);
      return;
    case NodeKind::atom:
      if constexpr (std::is_same_v<Value, Truth>) {
        atoms_.truth(what.atom, samples, first, count, out);
      } else {
        atoms_.robustness(what.atom, samples, first, count, out);
      }
      if (negated)
        for (std::size_t n = 0; n < count; ++n) out[n] = opposite(out[n]);
      return;
    case NodeKind::logical_not:
      return node(what.operands[0], !negated, depth, samples, first, count);
    default:
      return junction(what.operands, negated, (what.kind == NodeKind::logical_and) != negated, depth, samples, first,
                      count);
  }
}

template <class Value>
void PointwiseEvaluator<Value>::junction(const std::vector<std::size_t>& operands, bool negated, bool conjunction,
                                         std::size_t depth, const Samples& samples, std::size_t first,
                                         std::size_t count) {
  node(operands[0], negated, depth, samples, first, count);
  for (std::size_t n = 1; n < operands.size(); ++n) {
    node(operands[n], negated, depth + 1, samples, first, count);
    Value* left = blocks_[depth].data();
    const Value* right = blocks_[depth + 1].data();
    if (conjunction) {
      fold_into<Value, true>(left, right, count);
    } else {
      fold_into<Value, false>(left, right, count);
    }
  }
}

template <class Value>
Value PointwiseEvaluator<Value>::with_all(const StreamNode& leaf, Value value) {
  if (any_shared_) {
    shared_constants_.clear();
    for (const std::size_t shared : shared_below(leaf)) {
      for (const bool negated : {false, true}) {
        const Value worth = node_with_all(shared, negated, value);
        shared_constants_[{shared, negated}] = worth;
      }
    }
  }
  if (leaf.parts.empty()) return node_with_all(leaf.source, leaf.dual, value);
  const bool conjunction = (program_->nodes[leaf.source].kind == NodeKind::logical_and) != leaf.dual;
  return junction_with_all(leaf.parts, leaf.dual, conjunction, value);
}

template <class Value>
Value PointwiseEvaluator<Value>::node_with_all(std::size_t number, bool negated, Value value) {
  const MonitorNode& what = program_->nodes[number];
  if (any_shared_ && shared_[number]) {
    const auto found = shared_constants_.find({number, negated});
    if (found != shared_constants_.end()) return found->second;
  }
  switch (what.kind) {
    case NodeKind::always_false:
    case NodeKind::always_true:
      return negated != (what.kind == NodeKind::always_true) ? Bounds<Value>::greatest : Bounds<Value>::least;
    case NodeKind::atom:
      return value;
    case NodeKind::logical_not:
      return node_with_all(what.operands[0], !negated, value);
    default:
      return junction_with_all(what.operands, negated, (what.kind == NodeKind::logical_and) != negated, value);
  }
}

template <class Value>
Value PointwiseEvaluator<Value>::junction_with_all(const std::vector<std::size_t>& operands, bool negated,
                                                   bool conjunction, Value value) {
  Value result = node_with_all(operands[0], negated, value);
  for (std::size_t n = 1; n < operands.size(); ++n) {
    const Value other = node_with_all(operands[n], negated, value);
    result = conjunction ? Lattice<Value, true>::join(result, other) : Lattice<Value, false>::join(result, other);
  }
  return result;
}

template class PointwiseEvaluator<Truth>;
template class PointwiseEvaluator<Robustness>;

bool rises(const std::int64_t* ticks, std::size_t count, const TracePosition& position) {
  bool falls = position.begun && ticks[0] < position.last;
  bool stays = position.begun && ticks[0] == position.last;
  for (std::size_t n = 1; n < count; ++n) {
    falls |= ticks[n] < ticks[n - 1];
    stays |= ticks[n] == ticks[n - 1];
  }
  if (falls) throw std::invalid_argument("the times of a trace must not decrease");
  return !stays;
}

void extend(Stream<Truth>& out, const Truth* values, const std::int64_t* ticks, std::size_t count, std::int64_t origin,
            bool) {
  const auto put = [&](std::size_t n) { out.append(cell_of_tick(ticks[n] - origin), values[n]); };
  put(0);
  std::size_t n = 1;
  if constexpr (std::endian::native == std::endian::little) {
    for (; n + 8 <= count; n += 8) {
      std::uint64_t now;
      std::uint64_t before;
      std::memcpy(&now, values + n, 8);
      std::memcpy(&before, values + n - 1, 8);
      for (std::uint64_t changed = now ^ before; changed != 0; changed &= changed - 1)
        put(n + static_cast<std::size_t>(std::countr_zero(changed)) / 8);
    }
  }
  for (; n < count; ++n)
    if (values[n] != values[n - 1]) put(n);
}

void extend(Stream<Robustness>& out, const Robustness* values, const std::int64_t* ticks, std::size_t count,
            std::int64_t origin, bool rising) {
  if (!rising) {
    for (std::size_t n = 0; n < count; ++n) out.append(cell_of_tick(ticks[n] - origin), values[n]);
    return;
  }
  out.append(cell_of_tick(ticks[0] - origin), values[0]);
  const auto room = out.room(count);
  std::size_t written = 0;
  for (std::size_t n = 1; n < count; ++n) {
    room.starts[written] = cell_of_tick(ticks[n] - origin);
    room.values[written] = values[n];
    written += values[n] != values[n - 1];
  }
  out.commit(written);
}

template <class Value>
void ChangeLeaf<Value>::extend(Stream<Value>& out, const double* values, const std::int64_t* ticks, std::size_t count,
                               std::int64_t origin) {
  for (std::size_t n = 0; n < count; ++n) {
    const Cell cell = cell_of_tick(ticks[n] - origin);
    if (cell != cell_) {
      settle(out);
      before_ = value_;
      cell_ = cell;
    }
    value_ = values[n];
  }
}

template <class Value>
void ChangeLeaf<Value>::settle(Stream<Value>& out) {
  if (cell_ < 0) return;
  if (cell_ == 0) {
    out.append(0, no());
    return;
  }
  const bool both_undefined = value_ != value_ && before_ != before_;
  if (value_ == before_ || both_undefined) return;
  out.append(cell_, yes());
  out.append(cell_ + 1, no());
}

template class ChangeLeaf<Truth>;
template class ChangeLeaf<Robustness>;

}  // namespace tachk::monitoring::offline
