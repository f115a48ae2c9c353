// Signals as they grow: pieces of cells with one value each, known up to a frontier.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "monitoring/monitor_cells.hpp"

namespace tachk::monitoring::offline {

using Truth = std::uint8_t;  // 0 or 1
using Robustness = double;

// The values of a signal with their order. `Dual` turns the order round, so that one piece of code makes both of two
// dual operators: F and G, U and its negation.
template <class Value>
struct Bounds;
template <>
struct Bounds<Truth> {
  static constexpr Truth least = 0;
  static constexpr Truth greatest = 1;
};
template <>
struct Bounds<Robustness> {
  static constexpr Robustness least = -std::numeric_limits<Robustness>::infinity();
  static constexpr Robustness greatest = std::numeric_limits<Robustness>::infinity();
};

template <class Value, bool Dual>
struct Lattice {
  static constexpr Value bottom = Dual ? Bounds<Value>::greatest : Bounds<Value>::least;
  static constexpr Value top = Dual ? Bounds<Value>::least : Bounds<Value>::greatest;
  static constexpr Value join(Value l, Value r) { return below(l, r) ? r : l; }
  static constexpr Value meet(Value l, Value r) { return below(l, r) ? l : r; }
  static constexpr bool below(Value l, Value r) { return Dual ? r < l : l < r; }
};

// Pieces in the order of time, numbered from 0 for ever; those that no operator reads any more are dropped. Cells below
// the frontier are final. Pieces that start at the frontier or later may still be rewritten: readers must not look at
// them.
template <class Value>
class Stream {
 public:
  Cell frontier = 0;

  Stream() = default;
  Stream(const Stream& other) { *this = other; }
  // Only what is in use: the room of a stream is often much larger.
  Stream& operator=(const Stream& other) {
    if (this == &other) return *this;
    frontier = other.frontier;
    base_ = other.base_;
    size_ = 0;
    reserve(other.size_);
    size_ = other.size_;
    std::copy_n(other.starts_.begin(), size_, starts_.begin());
    std::copy_n(other.values_.begin(), size_, values_.begin());
    return *this;
  }
  Stream(Stream&&) = default;
  Stream& operator=(Stream&&) = default;
  ~Stream() = default;

  std::size_t begin() const { return base_; }
  std::size_t end() const { return base_ + size_; }
  // To be indexed by the numbers of pieces.
  const Cell* starts() const { return starts_.data() - base_; }
  const Value* values() const { return values_.data() - base_; }
  std::size_t bytes() const { return starts_.size() * (sizeof(Cell) + sizeof(Value)); }

  // From `cell` on the signal has this value. Whatever was said about later cells is forgotten.
  void append(Cell cell, Value value) {
    while (size_ > 0 && starts_[size_ - 1] >= cell) --size_;
    if (size_ > 0 && values_[size_ - 1] == value) return;
    reserve(1);
    starts_[size_] = cell;
    values_[size_] = value;
    ++size_;
  }

  // Room for `count` more pieces behind the existing ones, which the caller writes himself and then commits.
  struct Room {
    Cell* starts;
    Value* values;
  };
  Room room(std::size_t count) {
    reserve(count);
    return {starts_.data() + size_, values_.data() + size_};
  }
  void commit(std::size_t count) { size_ += count; }

  // Back to no piece at all. Memory stays, if it is not much.
  void restart() {
    frontier = 0;
    base_ = 0;
    size_ = 0;
    if (starts_.size() <= 65536) return;
    starts_ = {};
    values_ = {};
  }

  // Pieces before number `needed` are no longer read. The last one stays, so that equal neighbours can be joined.
  void trim(std::size_t needed) {
    const std::size_t unused = std::min(needed, end() - std::min<std::size_t>(size_, 1)) - base_;
    if (unused < 2048 || 2 * unused < size_) return;
    std::copy(starts_.begin() + static_cast<std::ptrdiff_t>(unused),
              starts_.begin() + static_cast<std::ptrdiff_t>(size_), starts_.begin());
    std::copy(values_.begin() + static_cast<std::ptrdiff_t>(unused),
              values_.begin() + static_cast<std::ptrdiff_t>(size_), values_.begin());
    base_ += unused;
    size_ -= unused;
    if (starts_.size() > 65536 && size_ < starts_.size() / 8) {
      starts_.resize(starts_.size() / 4);
      values_.resize(starts_.size());
      starts_.shrink_to_fit();
      values_.shrink_to_fit();
    }
  }

 private:
  void reserve(std::size_t count) {
    if (size_ + count <= starts_.size()) return;
    const std::size_t wanted = std::max(size_ + count, starts_.size() + starts_.size() / 2 + 64);
    starts_.resize(wanted);
    values_.resize(wanted);
  }

  std::vector<Cell> starts_;  // the first size_ of them are in use
  std::vector<Value> values_;
  std::size_t base_ = 0;
  std::size_t size_ = 0;
};

}  // namespace tachk::monitoring::offline
