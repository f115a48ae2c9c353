// The stored states that wait to be explored, by their numbers in the store, and the order in which they are.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "order/by_progress.hpp"
#include "states/store.hpp"

namespace tachk::order {

// `automatic`: breadth first, and by progress once that turns out to explore most states in vain.
enum class SearchOrder { automatic, breadth_first, depth_first, random_depth_first, progress };

// Breadth first, the next is the oldest that has not been taken, which a cursor tells, because states are numbered as
// they come. Depth first, it is the one that came last; the states that one expansion adds may be shuffled.
class Waiting final {
 public:
  Waiting(SearchOrder order, std::uint32_t seed, std::uint32_t depth_limit)
      : order_(order), depth_limit_(depth_limit), random_(seed) {}

  // A new state, one step behind its parent, and those that it covers.
  void add(std::uint32_t node, std::uint32_t parent, const std::int32_t* slots,
           const std::vector<std::uint32_t>& covered) {
    if (depth_limit_ != UINT32_MAX) depth_.push_back(parent == states::no_node ? 0 : depth_[parent] + 1);
    if (by_progress_)
      by_progress_->add(node, slots);
    else if (is_queue())
      end_ = node + 1;
    else
      fresh_.push_back(node);
    for (const std::uint32_t other : covered) in_vain_ += other < cursor_;
  }

  // The state taken last is going to be expanded; its slots.
  void begin(const std::int32_t* slots) {
    if (by_progress_) by_progress_->begin(slots);
  }

  // All successors of a state have been added.
  void close() {
    if (is_queue()) return;
    if (order_ == SearchOrder::random_depth_first) std::shuffle(fresh_.begin(), fresh_.end(), random_);
    stack_.insert(stack_.end(), fresh_.begin(), fresh_.end());
    fresh_.clear();
  }

  // Changes to the order by progress where the states are to be taken in it from now on.
  void consider(const program::Program& program, states::PassedList& states) {
    if (!by_progress_ && wants_progress()) by_progress_.emplace(program, states, cursor_);
  }

  // The next in order; no_node if none is left.
  std::uint32_t next() {
    if (by_progress_) return by_progress_->next();
    if (is_queue()) return cursor_ < end_ ? cursor_++ : states::no_node;
    if (stack_.empty()) return states::no_node;
    const std::uint32_t node = stack_.back();
    stack_.pop_back();
    return node;
  }

  // The states with this number and larger ones all wait; no_node where the order is not that of the numbers.
  std::uint32_t first_untouched() const { return is_queue() && !by_progress_ ? cursor_ : states::no_node; }

  // Whether a state may be explored. Notes if it may not, because of the limit on depth.
  bool admits(std::uint32_t node) {
    const bool admitted = depth_.empty() || depth_[node] < depth_limit_;
    complete_ &= admitted;
    return admitted;
  }

  // Whether every state that was asked for has been admitted.
  bool complete() const { return complete_; }

  std::size_t bytes() const {
    return (stack_.capacity() + depth_.capacity()) * sizeof(std::uint32_t) + (by_progress_ ? by_progress_->bytes() : 0);
  }

 private:
  static constexpr std::uint32_t enough_taken = 1000;

  bool is_queue() const { return order_ != SearchOrder::depth_first && order_ != SearchOrder::random_depth_first; }
  bool wants_progress() const {
    if (order_ == SearchOrder::progress) return true;
    return order_ == SearchOrder::automatic && cursor_ >= enough_taken && in_vain_ > cursor_ / 3 * 2;
  }

  SearchOrder order_;
  std::uint32_t depth_limit_;
  std::mt19937 random_;
  std::uint32_t cursor_ = 0;          // breadth first: those from here on wait
  std::uint32_t end_ = 0;             // breadth first: of all
  std::uint32_t in_vain_ = 0;         // breadth first: how many were covered after they were taken
  std::vector<std::uint32_t> stack_;  // depth first
  std::vector<std::uint32_t> fresh_;  // depth first: added by the current expansion
  std::vector<std::uint32_t> depth_;  // of each node; kept only if there is a limit
  std::optional<ByProgress> by_progress_;
  bool complete_ = true;
};

// The layers of a breadth-first search: states that are equally far from the initial state, one after the other.
class Layers final {
 public:
  // Whether a state is the first of the next layer. That layer ends with the last state there is by then.
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
