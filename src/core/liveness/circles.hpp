// The states of a graph that lie on circles: its strongly connected components, known while it is gone through depth
// first (path-based, after H. Gabow, "Path-based depth-first search for strong and biconnected components", 2000).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tachk::liveness {

class Circles final {
 public:
  using State = std::uint32_t;

  // There are so many states.
  void resize(std::size_t states) { orders_.resize(states, 0); }
  bool is_new(State state) const { return orders_[state] == 0; }

  void enter(State state) {
    orders_[state] = ++count_;
    members_.push_back(state);
    growing_.push_back({count_, false});
  }

  // The state on top of the path leads to this one, which has been entered.
  void join(State state) {
    const std::uint32_t order = orders_[state];
    if (order == finished) return;
    while (growing_.back().order > order) growing_.pop_back();
    growing_.back().has_circle = true;
  }

  // The state on top of the path has no more steps.
  void leave(State state) {
    if (growing_.back().order != orders_[state]) return;
    const bool has_circle = growing_.back().has_circle;
    growing_.pop_back();
    State member;
    do {
      member = members_.back();
      members_.pop_back();
      orders_[member] = finished;
      if (has_circle) circular_.push_back(member);
    } while (member != state);
  }

  // Those of the states that have been left that lie on a circle.
  const std::vector<State>& circular() const { return circular_; }
  // How many have been entered.
  std::uint32_t entered() const { return count_; }

  std::size_t bytes() const {
    return (orders_.capacity() + members_.capacity() + circular_.capacity()) * sizeof(State) +
           growing_.capacity() * sizeof(Component);
  }

 private:
  static constexpr std::uint32_t finished = UINT32_MAX;

  struct Component {
    std::uint32_t order;  // of the state by which it was entered
    bool has_circle;
  };

  std::vector<std::uint32_t> orders_;  // in which states were entered, from 1 on; 0: not yet
  std::vector<State> members_;         // of components that grow
  std::vector<Component> growing_;
  std::vector<State> circular_;
  std::uint32_t count_ = 0;
};

}  // namespace tachk::liveness
