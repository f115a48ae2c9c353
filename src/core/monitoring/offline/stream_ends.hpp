// Streams cut at the end of the trace, and put together again there.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "monitoring/monitor_cells.hpp"
#include "monitoring/offline/stream_pieces.hpp"

namespace tachk::monitoring::offline::stream_operators {

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

template <class Value, bool Dual>
class Splice : public Cloneable<Splice<Value, Dual>, Value> {
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
      // Where the leaves go on for ever, so do the windows: see StreamGraph::spliced.
      const bool second = end.beyond == TraceEnd::Beyond::held ? Dual : end.beyond == TraceEnd::Beyond::least;
      const std::size_t side = second ? 1 : 2;
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

}  // namespace tachk::monitoring::offline::stream_operators
