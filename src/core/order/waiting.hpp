// The stored states that wait to be explored, by their numbers in the store, and the order in which they are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "order/orders.hpp"

namespace tachk::order {

// Breadth first, the next is the oldest that has not been taken, which a cursor counts, because states are numbered as
// they come. Another order takes over when the initial states are stored, or later.
class Waiting final {
 public:
  Waiting(SearchOrder order, std::uint32_t seed, std::uint32_t depth_limit)
      : kind_(order), seed_(seed), depth_limit_(depth_limit) {}

  // A new state, one step behind its parent, and those that it covers.
  void add(std::uint32_t node, std::uint32_t parent, const std::int32_t* slots,
           const std::vector<std::uint32_t>& covered) {
    if (depth_limit_ != UINT32_MAX) depth_.push_back(parent == states::no_node ? 0 : depth_[parent] + 1);
    if (order_)
      order_->add({node, slots, covered});
    else
      end_ = node + 1;
    for (const std::uint32_t other : covered) in_vain_ += other < cursor_;
  }

  // The state taken last is going to be expanded; its slots.
  void begin(const std::int32_t* slots) {
    if (order_) order_->begin(slots);
  }

  // All successors of a state, or all initial states, have been added.
  void close(const program::Program& program, states::PassedList& states) {
    if (!order_) take_over(program, states);
    if (order_) order_->close();
  }

  // The next in order; no_node if none is left.
  std::uint32_t next() {
    if (order_) return order_->next();
    return cursor_ < end_ ? cursor_++ : states::no_node;
  }

  // The states with this number and larger ones all wait; no_node where the order is not that of the numbers.
  std::uint32_t first_untouched() const { return row_of(kind_).make ? states::no_node : cursor_; }

  // True if a state may be explored. Notes if it may not, because of the limit on depth.
  bool admits(std::uint32_t node) {
    const bool admitted = depth_.empty() || depth_[node] < depth_limit_;
    complete_ &= admitted;
    return admitted;
  }

  // True if every requested state has been admitted.
  bool complete() const { return complete_; }

  std::size_t bytes() const { return depth_.capacity() * sizeof(std::uint32_t) + (order_ ? order_->bytes() : 0); }

 private:
  static constexpr std::uint32_t enough_taken = 1000;

  void take_over(const program::Program& program, states::PassedList& states) {
    if (kind_ == SearchOrder::automatic && cursor_ >= enough_taken && in_vain_ > cursor_ / 3 * 2)
      kind_ = SearchOrder::progress;
    if (row_of(kind_).make) order_ = row_of(kind_).make({program, states, cursor_, seed_});
  }

  SearchOrder kind_;
  std::uint32_t seed_;
  std::uint32_t depth_limit_;
  std::uint32_t cursor_ = 0;          // breadth first: those from here on wait
  std::uint32_t end_ = 0;             // breadth first: of all
  std::uint32_t in_vain_ = 0;         // breadth first: how many were covered after they were taken
  std::vector<std::uint32_t> depth_;  // of each node; kept only if there is a limit
  std::unique_ptr<Order> order_;      // null: breadth first
  bool complete_ = true;
};

// The layers of a breadth-first search: states that are equally far from the initial state, one after the other.
class Layers final {
 public:
  // True if a state is the first of the next layer. That layer ends with the last state there is by then.
  bool begins(std::uint32_t node, std::uint32_t nodes) {
    if (node < end_) return false;
    end_ = nodes;
    return true;
  }

  // The first state behind the present layer.
  std::uint32_t end() const { return end_; }

 private:
  std::uint32_t end_ = 0;
};

}  // namespace tachk::order
