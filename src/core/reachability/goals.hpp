// The goals of a search. A goal is a disjunction; a disjunct is a predicate on states, and may ask for deadlock as
// well. Predicates are looked at once, when a state is new; deadlock is known only when a state has been expanded
// (DeadlockWatch).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "program/program.hpp"
#include "states/store.hpp"
#include "symbolic/successor.hpp"
#include "symbolic/zone_graph.hpp"
#include "zones/zone.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk::reachability {

// A run-time error in a predicate of a goal, and the node in which that was.
struct GoalFailure {
  machine::ModelFault fault;
  std::uint32_t node;
};

class GoalWatch final {
 public:
  // `shortest`: a goal that asks for deadlock stays open until the end of the layer in which it is reached, because a
  // deadlock may still be found one step nearer.
  GoalWatch(const program::Program& program, symbolic::Semantics& semantics, const zones::ZoneOperations& operations,
            bool shortest);

  // Looks which open goals a new state satisfies by its predicates, and of which these are a run-time error there.
  void check(std::uint32_t node, std::int32_t* slots, zones::ConstZoneRef zone);
  void on_store(std::uint32_t node, const symbolic::Successor& successor) {
    check(node, successor.slots, successor.zone);
  }
  // True if there is one. Throws ModelFault.
  bool meets_any(std::int32_t* slots, zones::ConstZoneRef zone);
  // True if some valuation of the zone satisfies the condition. Throws ModelFault.
  bool meets(const program::Condition& condition, std::int32_t* slots, zones::ConstZoneRef zone);

  // A goal is reached in a node.
  void settle(std::size_t goal, std::uint32_t node);
  // A predicate of a goal is a run-time error in a node: the search goes on for the others.
  void fail(std::size_t goal, std::uint32_t node, const machine::ModelFault& fault);
  void end_layer();

  // True if there are goals, and none is open that the search goes on for.
  bool settled() const {
    return !reached_.empty() &&
           std::none_of(open_.begin(), open_.end(), [this](std::size_t goal) { return program_.goals[goal].decides; });
  }
  const std::vector<std::size_t>& open() const { return open_; }
  // The node in which a goal was reached first; no_node if it was not.
  std::uint32_t node(std::size_t goal) const { return reached_[goal]; }
  // The error of a goal that has failed.
  const std::optional<GoalFailure>& failure(std::size_t goal) const { return failures_[goal]; }
  // True if some goal has failed.
  bool any_failure() const;
  // For a search that has to know whether each goal is met. Throws ModelFault if one has failed.
  void throw_failure() const;

 private:
  // A disjunct without deadlock.
  struct Watch {
    std::size_t goal;
    const program::Condition* condition;
  };

  // Calls visit(watch) for each disjunct that a state in these locations may satisfy, until it says that this is
  // enough.
  template <class Visit>
  bool any_watch(const std::int32_t* slots, Visit&& visit) const;
  bool meets(const Watch& watch, std::int32_t* slots, zones::ConstZoneRef zone) {
    return reached_[watch.goal] == states::no_node && !failures_[watch.goal] && meets(*watch.condition, slots, zone);
  }

  const program::Program& program_;
  symbolic::Semantics& semantics_;
  zones::ZoneOperations operations_;
  bool shortest_;
  std::vector<std::uint32_t> reached_;
  std::vector<std::optional<GoalFailure>> failures_;
  std::vector<std::size_t> open_;
  std::vector<bool> has_deadlock_;              // of each goal
  std::vector<std::vector<Watch>> watches_at_;  // for each location, the disjuncts that ask for it
  std::vector<Watch> watches_anywhere_;
  std::vector<zones::Atom> atoms_;
  zones::ZoneBuffer scratch_;
};

}  // namespace tachk::reachability
