#include "tachk/monitor_operators.hpp"

#include <algorithm>
#include <stdexcept>

namespace tachk {
namespace {

constexpr std::size_t burst = 4096;  // pieces that one call reads at most

// The frontier up to which an operator that stands at piece `at` may read in one call.
template <class Value>
Cell limit(const Stream<Value>& in, std::size_t at) {
  return at + burst < in.end() ? std::min(in.frontier, in.starts()[at + burst]) : in.frontier;
}

template <class Value>
Cell start_or_endless(const Stream<Value>& in, std::size_t number) {
  return number < in.end() ? in.starts()[number] : endless;
}

template <class Derived, class Value>
class Cloneable : public StreamOperator<Value> {
 public:
  std::unique_ptr<StreamOperator<Value>> clone() const override {
    return std::make_unique<Derived>(static_cast<const Derived&>(*this));
  }
};

// Walks through the pieces on which two streams are constant together.
template <class Value>
class Pair {
 public:
  std::array<std::size_t, 2> at{};  // the current piece of each

  // Calls piece(start, left, right) for every joint piece that starts before the common frontier, and returns up to
  // where the two are known.
  template <class Piece>
  Cell walk(const Stream<Value>& left, const Stream<Value>& right, Piece piece) {
    const Cell known = std::min(limit(left, at[0]), limit(right, at[1]));
    if (known <= 0) return 0;
    if (!begun_) {
      begun_ = true;
      piece(Cell{0}, left.values()[0], right.values()[0]);
    }
    const Cell* left_starts = left.starts();
    const Cell* right_starts = right.starts();
    const Value* left_values = left.values();
    const Value* right_values = right.values();
    std::size_t i = at[0];
    std::size_t j = at[1];
    while (true) {
      const Cell next_left = i + 1 < left.end() ? left_starts[i + 1] : endless;
      const Cell next_right = j + 1 < right.end() ? right_starts[j + 1] : endless;
      const Cell next = std::min(next_left, next_right);
      if (next >= known) break;
      i += next_left == next;
      j += next_right == next;
      piece(next, left_values[i], right_values[j]);
    }
    at = {i, j};
    return known;
  }

 private:
  bool begun_ = false;
};

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

// The join over a window with both ends (Lemire 2006): candidates in falling order, each with the end of its piece.
template <class Value, bool Dual>
class Window : public Cloneable<Window<Value, Dual>, Value> {
  using Order = Lattice<Value, Dual>;

 public:
  explicit Window(const CellOffsets& offsets) : offsets_(offsets) { candidates_.push_back({Order::bottom, 0}); }

  void advance(typename StreamOperator<Value>::Inputs inputs, const TraceEnd&, Stream<Value>& out) override {
    const Stream<Value>& in = *inputs[0];
    const Cell known = limit(in, at_);
    if (known <= 0) return;
    if (out.frontier == 0 && out.begin() == out.end()) out.append(0, Order::bottom);  // before the trace
    const Cell* starts = in.starts();
    const Value* values = in.values();
    std::size_t at = at_;
    for (; at < in.end() && starts[at] < known; ++at) {
      const Cell enters = starts[at] - offsets_.last;
      const Value value = values[at];
      if (at > 0) candidates_.back().end = starts[at];
      leave(enters, out);
      while (candidates_.size() > head_ && !Order::below(value, candidates_.back().value)) candidates_.pop_back();
      const bool first = candidates_.size() == head_;
      candidates_.push_back({value, endless});
      if (first) out.append(std::max(enters, Cell{0}), value);
    }
    at_ = at;
    const Cell frontier = std::max(shifted(known, -offsets_.last), Cell{0});
    leave(frontier, out);
    if (head_ > 1024 && 2 * head_ > candidates_.size()) {
      candidates_.erase(candidates_.begin(), candidates_.begin() + static_cast<std::ptrdiff_t>(head_));
      head_ = 0;
    }
    out.frontier = std::max(out.frontier, frontier);
  }
  std::size_t needed(std::size_t) const override { return at_; }
  std::size_t bytes() const override { return candidates_.capacity() * sizeof(Candidate); }

 private:
  struct Candidate {
    Value value;
    Cell end;
  };

  // Drops the candidates whose piece has left the window before `cell`.
  void leave(Cell cell, Stream<Value>& out) {
    while (candidates_[head_].end - offsets_.first < cell && head_ + 1 < candidates_.size()) {
      const Cell left = candidates_[head_].end - offsets_.first;
      ++head_;
      out.append(std::max(left, Cell{0}), candidates_[head_].value);
    }
  }

  CellOffsets offsets_;
  std::vector<Candidate> candidates_;
  std::size_t head_ = 0;
  std::size_t at_ = 0;
};

// A window of one cell: the signal moved.
template <class Value, bool Dual>
class Shift : public Cloneable<Shift<Value, Dual>, Value> {
 public:
  explicit Shift(Cell offset) : offset_(offset) {}

  void advance(typename StreamOperator<Value>::Inputs inputs, const TraceEnd&, Stream<Value>& out) override {
    const Stream<Value>& in = *inputs[0];
    const Cell known = limit(in, at_);
    if (known <= 0) return;
    if (at_ == 0) out.append(0, Lattice<Value, Dual>::bottom);
    for (; at_ < in.end() && in.starts()[at_] < known; ++at_)
      out.append(std::max(in.starts()[at_] - offset_, Cell{0}), in.values()[at_]);
    out.frontier = std::max(shifted(known, -offset_), out.frontier);
  }
  std::size_t needed(std::size_t) const override { return at_; }

 private:
  Cell offset_;
  std::size_t at_ = 0;
};

// A window that reaches back to the beginning of the trace.
template <class Value, bool Dual>
class Running : public Cloneable<Running<Value, Dual>, Value> {
  using Order = Lattice<Value, Dual>;

 public:
  explicit Running(Cell last) : last_(last) {}

  void advance(typename StreamOperator<Value>::Inputs inputs, const TraceEnd&, Stream<Value>& out) override {
    const Stream<Value>& in = *inputs[0];
    const Cell known = limit(in, at_);
    if (known <= 0) return;
    if (at_ == 0) out.append(0, Order::bottom);
    for (; at_ < in.end() && in.starts()[at_] < known; ++at_) {
      if (!Order::below(best_, in.values()[at_])) continue;
      best_ = in.values()[at_];
      out.append(std::max(in.starts()[at_] - last_, Cell{0}), best_);
    }
    out.frontier = std::max(shifted(known, -last_), out.frontier);
  }
  std::size_t needed(std::size_t) const override { return at_; }

 private:
  Cell last_;
  Value best_ = Order::bottom;
  std::size_t at_ = 0;
};

// The join over everything from an offset on: nothing is known before the input is known to its end, except up to the
// last place with the greatest value of all.
template <class Value, bool Dual>
class Suffix : public Cloneable<Suffix<Value, Dual>, Value> {
  using Order = Lattice<Value, Dual>;

 public:
  explicit Suffix(Cell first) : first_(first) {}

  void advance(typename StreamOperator<Value>::Inputs inputs, const TraceEnd&, Stream<Value>& out) override {
    const Stream<Value>& in = *inputs[0];
    const Cell known = limit(in, at_);
    for (; at_ < in.end() && in.starts()[at_] < known; ++at_) {
      if (!candidates_.empty()) candidates_.back().end = in.starts()[at_];
      const Value value = in.values()[at_];
      while (!candidates_.empty() && !Order::below(value, candidates_.back().value)) candidates_.pop_back();
      candidates_.push_back({value, endless});
    }
    if (candidates_.empty()) return;
    if (known < endless) {
      const Candidate& front = candidates_.front();
      if (front.value != Order::top) return;
      const Cell frontier = std::min(front.end, known) - first_;
      if (frontier <= out.frontier) return;
      out.append(out.frontier, Order::top);
      out.frontier = frontier;
    } else if (out.frontier < endless) {
      Cell start = out.frontier;
      for (const Candidate& candidate : candidates_) {
        const Cell stop = shifted(candidate.end, -first_);
        if (stop <= start) continue;
        out.append(start, candidate.value);
        start = stop;
      }
      out.frontier = endless;
      candidates_.clear();
      candidates_.shrink_to_fit();
    }
  }
  std::size_t needed(std::size_t) const override { return at_; }
  std::size_t bytes() const override { return candidates_.capacity() * sizeof(Candidate); }

 private:
  struct Candidate {
    Value value;
    Cell end;
  };
  Cell first_;
  std::vector<Candidate> candidates_;
  std::size_t at_ = 0;
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

// f S (0,oo) g. On a piece with constant f and g that is entered with value x, which is bottom before the trace, the
// value is f and (g or x), but f and x at the first cell if that is an instant.
template <class Value, bool Dual>
class Since : public Cloneable<Since<Value, Dual>, Value> {
  using Order = Lattice<Value, Dual>;

 public:
  void advance(typename StreamOperator<Value>::Inputs inputs, const TraceEnd&, Stream<Value>& out) override {
    const Cell known = pair_.walk(*inputs[0], *inputs[1], [&](Cell start, Value f, Value g) {
      if (start > 0) {
        const Value body = Order::meet(f_, Order::join(g_, entered_));
        entered_ = is_instant(start - 1) ? Order::join(g_, Order::meet(f_, entered_)) : body;
      }
      f_ = f;
      g_ = g;
      if (is_instant(start)) {
        out.append(start, Order::meet(f, entered_));
        ++start;
      }
      out.append(start, Order::meet(f, Order::join(g, entered_)));
    });
    out.frontier = std::max(out.frontier, known);
  }
  std::size_t needed(std::size_t input) const override { return pair_.at[input]; }

 private:
  Pair<Value> pair_;
  Value f_ = Order::bottom;
  Value g_ = Order::bottom;
  Value entered_ = Order::bottom;
};

// f U (0,oo) g. On a piece with constant f and g that is left for value x the value is f and (g or x), but f and x at
// the last cell if that is an instant. x is known once the pieces behind it are; what is not known is bounded from both
// sides, and known where the bounds meet. Values further than the horizon ahead do not matter.
template <class Value, bool Dual>
class Until : public Cloneable<Until<Value, Dual>, Value> {
  using Order = Lattice<Value, Dual>;

 public:
  explicit Until(Cell horizon) : horizon_(horizon) {}

  void advance(typename StreamOperator<Value>::Inputs inputs, const TraceEnd&, Stream<Value>& out) override {
    const Cell known = pair_.walk(*inputs[0], *inputs[1], [&](Cell start, Value f, Value g) {
      if (!pieces_.empty() && pieces_.back().f == f && pieces_.back().g == g) return;
      pieces_.push_back({start, f, g, Order::bottom, Order::top});
    });
    if (pieces_.empty() || out.frontier == endless) return;
    if (pieces_.size() < due_ && known < endless) return;
    resolve(known);
    release(known, out);
    due_ = 2 * pieces_.size() + 256;
  }
  std::size_t needed(std::size_t input) const override { return pair_.at[input]; }
  std::size_t bytes() const override { return pieces_.capacity() * sizeof(Piece); }

 private:
  struct Piece {
    Cell start;
    Value f;
    Value g;
    Value low;  // bounds of the value for which the piece is left
    Value high;
  };

  void resolve(Cell known) {
    Value low = Order::bottom;
    Value high = Order::top;
    if (known == endless) low = high = Order::meet(pieces_.back().f, pieces_.back().g);
    for (std::size_t n = pieces_.size(); n-- > 0;) {
      Piece& piece = pieces_[n];
      piece.low = low;
      piece.high = high;
      if (is_instant(piece.start)) {
        low = Order::join(piece.g, Order::meet(piece.f, low));
        high = Order::join(piece.g, Order::meet(piece.f, high));
      } else {
        low = Order::meet(piece.f, Order::join(piece.g, low));
        high = Order::meet(piece.f, Order::join(piece.g, high));
      }
    }
  }

  void release(Cell known, Stream<Value>& out) {
    const Cell far = horizon_ == endless || known == endless ? known : known - horizon_;  // below it nothing is open
    const bool bounded = horizon_ != endless;
    std::size_t done = 0;
    for (; done < pieces_.size(); ++done) {
      Piece& piece = pieces_[done];
      const Cell stop = done + 1 < pieces_.size() ? pieces_[done + 1].start : known;
      const bool odd_end = stop != endless && is_instant(stop - 1);
      const Cell middle = odd_end ? stop - 1 : stop;  // the cells before it have one value
      if (piece.start < middle) {
        const Value low = Order::meet(piece.f, Order::join(piece.g, piece.low));
        const Value high = Order::meet(piece.f, Order::join(piece.g, piece.high));
        const Cell until = low == high ? middle : bounded ? std::min(middle, far) : piece.start;
        if (piece.start < until) {
          out.append(piece.start, low);
          piece.start = until;
        }
        if (until < middle) break;
      }
      if (odd_end && piece.start < stop) {
        const Value low = Order::meet(piece.f, piece.low);
        const Value high = Order::meet(piece.f, piece.high);
        if (low != high && !(bounded && stop <= far)) break;
        out.append(piece.start, low);
        piece.start = stop;
      }
    }
    if (done == pieces_.size()) {
      // Everything is known; the last piece may go on.
      out.frontier = known;
      pieces_.erase(pieces_.begin(), pieces_.end() - 1);
      return;
    }
    out.frontier = std::max(out.frontier, pieces_[done].start);
    pieces_.erase(pieces_.begin(), pieces_.begin() + static_cast<std::ptrdiff_t>(done));
  }

  Cell horizon_;
  Pair<Value> pair_;
  std::vector<Piece> pieces_;
  std::size_t due_ = 256;
};

// The parts of a stream up to the end of the trace and after it.
template <class Value, bool Dual>
class Truncate : public Cloneable<Truncate<Value, Dual>, Value> {
 public:
  void advance(typename StreamOperator<Value>::Inputs inputs, const TraceEnd& end, Stream<Value>& out) override {
    const Stream<Value>& in = *inputs[0];
    const Cell known = std::min(limit(in, at_), end.reached + 1);
    for (; at_ < in.end() && in.starts()[at_] < known; ++at_) out.append(in.starts()[at_], in.values()[at_]);
    out.frontier = std::max(out.frontier, known);
    if (end.finished && known == end.reached + 1) {
      out.append(known, Lattice<Value, Dual>::bottom);
      out.frontier = endless;
    }
  }
  std::size_t needed(std::size_t) const override { return at_; }

 private:
  std::size_t at_ = 0;
};

template <class Value, bool Dual>
class Tail : public Cloneable<Tail<Value, Dual>, Value> {
 public:
  void advance(typename StreamOperator<Value>::Inputs inputs, const TraceEnd& end, Stream<Value>& out) override {
    const Stream<Value>& in = *inputs[0];
    if (out.begin() == out.end()) out.append(0, Lattice<Value, Dual>::bottom);
    const Cell known = limit(in, at_);
    const Cell first = end.reached + 1;
    // A piece that reaches beyond the end is kept until it is known where the end is.
    while (at_ < in.end() && in.starts()[at_] < known && start_or_endless(in, at_ + 1) <= std::min(first, known - 1))
      ++at_;
    if (!end.finished) return;
    for (; at_ < in.end() && in.starts()[at_] < known; ++at_)
      out.append(std::max(in.starts()[at_], first), in.values()[at_]);
    out.frontier = std::max(out.frontier, known);
  }
  std::size_t needed(std::size_t) const override { return at_; }

 private:
  std::size_t at_ = 0;
};

template <class Value>
class Splice : public Cloneable<Splice<Value>, Value> {
 public:
  void advance(typename StreamOperator<Value>::Inputs inputs, const TraceEnd& end, Stream<Value>& out) override {
    const Stream<Value>& cut = *inputs[0];
    const Cell stop = end.reached + 1;
    Cell known = std::min(limit(cut, at_[0]), stop);
    for (; at_[0] < cut.end() && cut.starts()[at_[0]] < known; ++at_[0])
      out.append(cut.starts()[at_[0]], cut.values()[at_[0]]);
    for (const std::size_t n : {1u, 2u}) {
      const Stream<Value>& in = *inputs[n];
      while (at_[n] + 1 < in.end() && in.starts()[at_[n] + 1] <= std::min(stop, in.frontier - 1)) ++at_[n];
    }
    if (end.finished && known == stop && end.beyond != TraceEnd::Beyond::unknown) {
      const std::size_t side = end.beyond == TraceEnd::Beyond::least ? 1 : 2;
      const Stream<Value>& in = *inputs[side];
      for (; at_[side] < in.end() && in.starts()[at_[side]] < in.frontier; ++at_[side])
        out.append(std::max(in.starts()[at_[side]], stop), in.values()[at_[side]]);
      known = std::max(known, in.frontier);
    }
    out.frontier = std::max(out.frontier, known);
  }
  std::size_t needed(std::size_t input) const override { return at_[input]; }

 private:
  std::array<std::size_t, 3> at_{};
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
      return std::make_unique<Splice<Value>>();
    default:
      throw std::logic_error("a leaf is not an operator");
  }
}

}  // namespace

template <class Value>
std::unique_ptr<StreamOperator<Value>> make_operator(const StreamNode& node) {
  return node.dual ? make<Value, true>(node) : make<Value, false>(node);
}

template std::unique_ptr<StreamOperator<Truth>> make_operator<Truth>(const StreamNode& node);
template std::unique_ptr<StreamOperator<Robustness>> make_operator<Robustness>(const StreamNode& node);

}  // namespace tachk
