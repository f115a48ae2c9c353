// Drops what is lost: a state from which, for each disjunct of each open goal, one process or one variable that it
// names can no longer reach its part of the goal, whatever everybody else does, and none a run-time error.
#pragma once

#include <cstdint>
#include <vector>

#include "reachability/goals.hpp"
#include "reachability/pruning/aims.hpp"
#include "symbolic/receiver.hpp"
#include "zones/zone.hpp"

namespace tachk::reachability::pruning {

class LostStates final {
 public:
  LostStates(const program::Program& program, const zones::ZoneOperations& operations, const GoalWatch& goals,
             Aims aims);

  // An initial state is kept in any case, so that a search has a state.
  bool on_successor(const symbolic::Successor& successor) {
    if (!active_ || is_hopeful(successor)) return true;
    if (successor.edges.empty()) return all_is_lost_ = true;
    ++lost_;
    return false;
  }
  const Aims& aims() const { return aims_; }
  // True if the initial state is lost.
  bool all_is_lost() const { return all_is_lost_; }
  // How many successors have been dropped.
  std::uint64_t lost() const { return lost_; }

 private:
  bool is_hopeful(const symbolic::Successor& state);
  bool may_meet(const Aim& aim, const symbolic::Successor& state) const;

  int dimension_;
  zones::ZoneOperations operations_;
  const GoalWatch& goals_;
  Aims aims_;
  bool active_;
  const Aim* last_ = nullptr;  // that a state could meet
  std::size_t goal_ = 0;       // to which it belongs
  bool all_is_lost_ = false;
  std::uint64_t lost_ = 0;
};

}  // namespace tachk::reachability::pruning
