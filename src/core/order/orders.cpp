#include "order/orders.hpp"

#include <algorithm>
#include <array>
#include <concepts>
#include <random>

#include "order/buckets.hpp"
#include "order/by_progress.hpp"
#include "order/goal_distance.hpp"

namespace tachk::order {

namespace {

// The state that came last is the next. The states that one expansion adds may be shuffled.
template <bool shuffled>
class DepthFirst final : public Order {
 public:
  explicit DepthFirst(const Beginning& at) : random_(at.seed) {}

  void add(const NewState& state) override { fresh_.push_back(state.node); }
  void close() override {
    if constexpr (shuffled) std::shuffle(fresh_.begin(), fresh_.end(), random_);
    stack_.insert(stack_.end(), fresh_.begin(), fresh_.end());
    fresh_.clear();
  }
  std::uint32_t next() override {
    if (stack_.empty()) return states::no_node;
    const std::uint32_t node = stack_.back();
    stack_.pop_back();
    return node;
  }
  std::size_t bytes() const override { return stack_.capacity() * sizeof(std::uint32_t); }

 private:
  std::mt19937 random_;
  std::vector<std::uint32_t> stack_;
  std::vector<std::uint32_t> fresh_;  // added by the current expansion
};

// The state that is nearest to a goal is the next, among equal ones the oldest.
class BestFirst final : public Order {
 public:
  explicit BestFirst(const Beginning& at) : distance_(at.program) {}

  void add(const NewState& state) override { waiting_.add(state.node, distance_.of(state.slots)); }
  std::uint32_t next() override {
    std::uint32_t distance = 0;
    return waiting_.next(distance);
  }
  std::size_t bytes() const override { return waiting_.bytes(); }

 private:
  GoalDistance distance_;
  Buckets waiting_;
};

template <class Kind>
std::unique_ptr<Order> make(const Beginning& at) {
  std::unique_ptr<Order> made;
  if constexpr (std::constructible_from<Kind, const Beginning&>)
    made = std::make_unique<Kind>(at);
  else
    made = std::make_unique<Kind>();
  made->start(at);
  return made;
}

constexpr std::array rows{
    OrderRow{"AUTO", nullptr},
    OrderRow{"BFS", nullptr},
    OrderRow{"DFS", make<DepthFirst<false>>},
    OrderRow{"RANDOM_DFS", make<DepthFirst<true>>},
    OrderRow{"PROGRESS", make<ByProgress>},
    OrderRow{"BEST_FIRST", make<BestFirst>},
};

}  // namespace

void Order::start(const Beginning& at) {
  const std::vector<std::uint32_t> none;
  std::vector<std::int32_t> slots(at.program.slots.size());
  for (std::uint32_t node = at.first; node < at.states.size(); ++node) {
    if (at.states.covered(node)) continue;
    at.states.unpack(node, slots.data());
    add({node, slots.data(), none});
  }
}

std::span<const OrderRow> orders() { return rows; }

}  // namespace tachk::order
