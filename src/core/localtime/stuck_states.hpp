// Which states of the network in a zone over local times are deadlocks: goals that contain `deadlock`.
//
// Being stuck depends on all processes at the same time, so that only the synchronised part of a zone is
// checked. With LU bounds a state that is covered may be stuck where those that cover it are not. With equal lower and
// upper bounds each clock of the two has the same value or is beyond its bound for both: one is stuck iff the other one
// is.
#pragma once

#include <cstdint>
#include <vector>

#include "program/program.hpp"
#include "reachability/goals.hpp"
#include "symbolic/dead_states.hpp"
#include "zones/zone.hpp"

namespace tachk::localtime {

bool has_deadlock_literal(const program::Program& program);

class StuckStates final {
 public:
  StuckStates(const program::Program& program, const zones::ZoneOperations& operations, reachability::GoalWatch& goals);

  // Settles the open goals that some valuation of a new state meets that is stuck, or is not, as the goal requires. The
  // valuations are those that can be there at once, not abstracted. Throws ModelFault.
  void check(std::uint32_t node, std::int32_t* slots, zones::ConstZoneRef zone);

  // For a disjunct with deadlock: the valuations of the state that meet it are those that meet one of these
  // conditions. Throws ModelFault.
  std::vector<program::Condition> conditions(const program::Disjunct& disjunct, std::int32_t* slots,
                                             zones::ConstZoneRef zone);

 private:
  // Of the zone of the last call of `compute`.
  const zones::Federation& pieces(const program::Disjunct& disjunct) {
    return disjunct.deadlock == program::DeadlockLiteral::required ? dead_.dead() : dead_.live();
  }
  bool any_piece_meets(const program::Disjunct& disjunct, std::int32_t* slots);

  const program::Program& program_;
  zones::ZoneOperations operations_;
  reachability::GoalWatch& goals_;
  symbolic::DeadStates dead_;
  std::vector<std::size_t> open_;
};

}  // namespace tachk::localtime
