// The common part of operators on streams: how they are copied, and how they walk through the pieces of their inputs.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>

#include "monitoring/offline/monitor_operators.hpp"
#include "monitoring/offline/monitor_stream.hpp"

namespace tachk::monitoring::offline::stream_operators {

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

}  // namespace tachk::monitoring::offline::stream_operators
