#include "monitoring/offline/monitor_operators.hpp"

#include <memory>
#include <stdexcept>

#include "monitoring/offline/stream_ends.hpp"
#include "monitoring/offline/stream_pieces.hpp"
#include "monitoring/offline/stream_until.hpp"
#include "monitoring/offline/stream_windows.hpp"

namespace tachk::monitoring::offline {
namespace stream_operators {

template <class Value, bool Dual>
class Constant : public Cloneable<Constant<Value, Dual>, Value> {
 public:
  void advance(typename StreamOperator<Value>::Inputs, const TraceEnd&, Stream<Value>& out) override {
    if (out.frontier == endless) return;
    out.append(0, Lattice<Value, Dual>::bottom);
    out.frontier = endless;
  }
  std::size_t needed(std::size_t) const override { return 0; }
};

template <class Value, bool Dual>
class Join : public Cloneable<Join<Value, Dual>, Value> {
 public:
  void advance(typename StreamOperator<Value>::Inputs inputs, const TraceEnd&, Stream<Value>& out) override {
    // At most one piece of output for each piece of the inputs that is read.
    const auto room = out.room(2 * burst + 2);
    std::size_t count = 0;
    Value last = last_;
    bool any = any_;
    const Cell known = pair_.walk(*inputs[0], *inputs[1], [&](Cell start, Value left, Value right) {
      const Value value = Lattice<Value, Dual>::join(left, right);
      room.starts[count] = start;
      room.values[count] = value;
      count += !any || value != last;
      any = true;
      last = value;
    });
    last_ = last;
    any_ = any;
    out.commit(count);
    out.frontier = std::max(out.frontier, known);
  }
  std::size_t needed(std::size_t input) const override { return pair_.at[input]; }

 private:
  Pair<Value> pair_;
  Value last_{};
  bool any_ = false;
};

template <class Value>
class Select : public Cloneable<Select<Value>, Value> {
 public:
  void advance(typename StreamOperator<Value>::Inputs inputs, const TraceEnd&, Stream<Value>& out) override {
    const Cell known = pair_.walk(*inputs[0], *inputs[1], [&](Cell start, Value even, Value odd) {
      fill(start, out);
      start_ = start;
      even_ = even;
      odd_ = odd;
    });
    if (known <= 0) return;
    if (known == endless) {
      // In the end the two windows see the same.
      fill(start_ + 2, out);
      out.append(start_ + 2, odd_);
      if (even_ != odd_) throw std::logic_error("a signal does not come to rest");
    } else {
      fill(known, out);
      start_ = known;
    }
    out.frontier = std::max(out.frontier, known);
  }
  std::size_t needed(std::size_t input) const override { return pair_.at[input]; }

 private:
  void fill(Cell stop, Stream<Value>& out) const {
    if (even_ == odd_) {
      if (start_ < stop) out.append(start_, even_);
      return;
    }
    for (Cell cell = start_; cell < stop; ++cell) out.append(cell, is_instant(cell) ? even_ : odd_);
  }

  Pair<Value> pair_;
  Cell start_ = 0;
  Value even_{};
  Value odd_{};
};

// At an instant the value of the interval before it; in an interval nothing moves.
template <class Value, bool Dual>
class Before : public Cloneable<Before<Value, Dual>, Value> {
 public:
  void advance(typename StreamOperator<Value>::Inputs inputs, const TraceEnd&, Stream<Value>& out) override {
    const Stream<Value>& in = *inputs[0];
    const Cell known = limit(in, at_);
    if (known <= 0) return;
    if (at_ == 0) out.append(0, Lattice<Value, Dual>::bottom);
    for (; at_ < in.end() && in.starts()[at_] < known; ++at_) out.append(in.starts()[at_] | 1, in.values()[at_]);
    out.frontier = known;
  }
  std::size_t needed(std::size_t) const override { return at_; }

 private:
  std::size_t at_ = 0;
};

template <class Value, bool Dual>
std::unique_ptr<StreamOperator<Value>> make(const StreamNode& node) {
  switch (node.kind) {
    case StreamKind::constant:
      return std::make_unique<Constant<Value, Dual>>();
    case StreamKind::join:
      return std::make_unique<Join<Value, Dual>>();
    case StreamKind::window:
      if (node.offsets.first == -endless) return std::make_unique<Running<Value, Dual>>(node.offsets.last);
      if (node.offsets.first == node.offsets.last) return std::make_unique<Shift<Value, Dual>>(node.offsets.first);
      return std::make_unique<Window<Value, Dual>>(node.offsets);
    case StreamKind::suffix:
      return std::make_unique<Suffix<Value, Dual>>(node.offsets.first);
    case StreamKind::before:
      return std::make_unique<Before<Value, Dual>>();
    case StreamKind::until:
      return std::make_unique<Until<Value, Dual>>(node.horizon);
    case StreamKind::since:
      return std::make_unique<Since<Value, Dual>>();
    case StreamKind::select:
      return std::make_unique<Select<Value>>();
    case StreamKind::truncate:
      return std::make_unique<Truncate<Value, Dual>>();
    case StreamKind::tail:
      return std::make_unique<Tail<Value, Dual>>();
    case StreamKind::splice:
      return std::make_unique<Splice<Value, Dual>>();
    default:
      throw std::logic_error("a leaf is not an operator");
  }
}

}  // namespace stream_operators

template <class Value>
std::unique_ptr<StreamOperator<Value>> make_operator(const StreamNode& node) {
  return node.dual ? stream_operators::make<Value, true>(node) : stream_operators::make<Value, false>(node);
}

template std::unique_ptr<StreamOperator<Truth>> make_operator<Truth>(const StreamNode& node);
template std::unique_ptr<StreamOperator<Robustness>> make_operator<Robustness>(const StreamNode& node);

}  // namespace tachk::monitoring::offline
