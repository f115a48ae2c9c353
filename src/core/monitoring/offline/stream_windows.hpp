// The join of a stream over a window: with both ends, of one cell, back to the beginning, on without end.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "monitoring/monitor_cells.hpp"
#include "monitoring/offline/stream_pieces.hpp"

namespace tachk::monitoring::offline::stream_operators {

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

}  // namespace tachk::monitoring::offline::stream_operators
