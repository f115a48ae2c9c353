// The strict until and since without bounds.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "monitoring/monitor_cells.hpp"
#include "monitoring/offline/stream_pieces.hpp"

namespace tachk::monitoring::offline::stream_operators {

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

}  // namespace tachk::monitoring::offline::stream_operators
