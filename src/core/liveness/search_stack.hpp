// The stack of a depth-first search. The path to the state at hand consists of the open states; between them wait their
// successors that have not been looked at. The open states with the same discrete part are linked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "states/memory.hpp"
#include "states/store.hpp"
#include "states/zone_store.hpp"
#include "symbolic/zone_graph.hpp"

namespace tachk::liveness {

class SearchStack final {
 public:
  struct State {
    std::uint32_t discrete;
    std::uint32_t below;  // open only: the next open state with this discrete part, towards the bottom
    int dimension;        // of the zone
    bool open;
  };

  explicit SearchStack(const symbolic::ZoneGraph& graph);

  bool empty() const { return states_.empty(); }
  std::uint32_t size() const { return static_cast<std::uint32_t>(states_.size()); }
  const State& operator[](std::uint32_t number) const { return states_[number]; }
  const State& top() const { return states_.back(); }
  states::ZoneView zone(std::uint32_t number) const { return {zones_[number], states_[number].dimension}; }
  states::ZoneView top_zone() const { return zone(size() - 1); }
  // The open states, from the bottom.
  std::vector<std::uint32_t> path() const;
  std::uint32_t depth() const { return depth_; }

  void push(std::uint32_t discrete, states::ZoneView zone);
  void pop();
  // From now on the state on top is part of the path.
  void open_top();

  // An open state with this discrete part and a zone inside of this one (without subsumption: equal); else `no_node`.
  std::uint32_t find_below(std::uint32_t discrete, states::ZoneView zone, bool subsumption) const;

  // True if a state has this zone.
  bool holds(std::uint32_t number, states::ZoneView zone) const;

  std::size_t bytes() const {
    return zones_.bytes() + states_.capacity() * sizeof(State) + newest_.capacity() * sizeof(std::uint32_t);
  }

 private:
  const zones::ZoneOperations& operations(int dimension) const {
    return dimension == dimension_ ? operations_ : smaller_[static_cast<std::size_t>(dimension)];
  }

  zones::ZoneOperations operations_;
  std::vector<zones::ZoneOperations> smaller_;
  int dimension_;
  std::vector<State> states_;
  states::RecordPool zones_;           // of the states, at the same numbers
  std::vector<std::uint32_t> newest_;  // of each discrete part, the open state nearest to the top
  std::uint32_t depth_ = 0;            // how many are open
};

}  // namespace tachk::liveness
