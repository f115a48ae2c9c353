// A growing set of cells: ordered runs in one block of memory, cheap to extend at the end, to drop at the front, and
// to change near either side.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "monitoring/monitor_cells.hpp"

namespace tachk::monitoring::online {

// The cells from `first` to before `end`.
struct Span {
  Cell first = 0;
  Cell end = 0;
};

class SpanSet {
 public:
  std::size_t size() const { return runs_.size() - head_; }
  bool empty() const { return runs_.size() == head_; }
  const Span& operator[](std::size_t index) const { return runs_[head_ + index]; }
  const Span& back() const { return runs_.back(); }

  // The number of the first run that ends after a cell.
  std::size_t find(Cell cell) const {
    if (empty() || runs_.back().end <= cell) return size();
    if (runs_[head_].end > cell) return 0;
    const auto begin = runs_.begin() + static_cast<std::ptrdiff_t>(head_);
    return static_cast<std::size_t>(
        std::partition_point(begin, runs_.end(), [cell](const Span& run) { return run.end <= cell; }) - begin);
  }
  // The same, where it is likely to be `hint` or soon after.
  std::size_t find(Cell cell, std::size_t hint) const {
    if (hint > size() || (hint > 0 && (*this)[hint - 1].end > cell)) return find(cell);
    for (int n = 0; n < 4; ++n, ++hint)
      if (hint == size() || (*this)[hint].end > cell) return hint;
    return find(cell);
  }
  bool holds(Cell cell) const {
    const std::size_t index = find(cell);
    return index < size() && (*this)[index].first <= cell;
  }
  // The end of the run that holds a cell, or the cell itself.
  Cell end_of_run(Cell cell) const {
    const std::size_t index = find(cell);
    return index < size() && (*this)[index].first <= cell ? (*this)[index].end : cell;
  }
  // The number of the last run that begins at or before a cell; size() if there is none.
  std::size_t find_back(Cell cell) const {
    const auto begin = runs_.begin() + static_cast<std::ptrdiff_t>(head_);
    if (!empty() && runs_.back().first <= cell) return size() - 1;
    const auto after = std::partition_point(begin, runs_.end(), [cell](const Span& run) { return run.first <= cell; });
    return after == begin ? size() : static_cast<std::size_t>(after - begin) - 1;
  }

  // Adds cells and appends the runs of those that are new to `added`, in order.
  void add(Cell first, Cell end, std::vector<Span>& added) {
    if (first >= end) return;
    if (empty() || first > runs_.back().end) {
      runs_.push_back({first, end});
      added.push_back({first, end});
      return;
    }
    Span& last = runs_.back();
    if (first >= last.first) {
      if (end > last.end) {
        added.push_back({last.end, end});
        last.end = end;
      }
      return;
    }
    add_inside({first, end}, added);
  }

  // Forgets the runs that end before a cell; one that ends just there stays, since it may go on.
  void drop_before(Cell cell) {
    while (head_ < runs_.size() && runs_[head_].end < cell) ++head_;
    if (head_ > 64 && head_ > 2 * size()) {
      runs_.erase(runs_.begin(), runs_.begin() + static_cast<std::ptrdiff_t>(head_));
      head_ = 0;
    }
  }

  void clear() {
    runs_.clear();
    head_ = 0;
  }
  std::size_t bytes() const { return runs_.capacity() * sizeof(Span); }

 private:
  void add_inside(Span span, std::vector<Span>& added) {
    const std::size_t from = span.first == 0 ? 0 : find(span.first - 1);  // the first run that touches it, or follows
    std::size_t to = from;
    Cell at = span.first;
    while (to < size() && (*this)[to].first <= span.end) {
      const Span& run = (*this)[to];
      if (run.first > at) added.push_back({at, run.first});
      at = std::max(at, run.end);
      ++to;
    }
    if (at < span.end) added.push_back({at, span.end});
    if (from == to) {
      insert(from, span);
      return;
    }
    const Span merged{std::min(span.first, (*this)[from].first), std::max(span.end, (*this)[to - 1].end)};
    erase(from + 1, to);
    runs_[head_ + from] = merged;
  }
  // Both move the shorter side.
  void insert(std::size_t index, Span span) {
    if (2 * index < size()) {
      if (head_ == 0) {
        head_ = size() / 2 + 1;
        runs_.insert(runs_.begin(), head_, Span{});
      }
      const auto begin = runs_.begin() + static_cast<std::ptrdiff_t>(head_);
      std::move(begin, begin + static_cast<std::ptrdiff_t>(index), begin - 1);
      --head_;
      runs_[head_ + index] = span;
    } else {
      runs_.insert(runs_.begin() + static_cast<std::ptrdiff_t>(head_ + index), span);
    }
  }
  void erase(std::size_t from, std::size_t to) {
    const auto begin = runs_.begin() + static_cast<std::ptrdiff_t>(head_);
    const auto first = begin + static_cast<std::ptrdiff_t>(from);
    const auto last = begin + static_cast<std::ptrdiff_t>(to);
    if (from < size() - to) {
      std::move_backward(begin, first, last);
      head_ += to - from;
    } else {
      runs_.erase(first, last);
    }
  }

  std::vector<Span> runs_;
  std::size_t head_ = 0;
};

}  // namespace tachk::monitoring::online
