#include "reachability/pruning/lost_states.hpp"

#include <algorithm>
#include <utility>

namespace tachk::reachability::pruning {

LostStates::LostStates(const program::Program& program, const zones::ZoneOperations& operations, const GoalWatch& goals,
                       Aims aims)
    : dimension_(program.dimension()),
      operations_(operations),
      goals_(goals),
      aims_(std::move(aims)),
      active_(!aims_.none()) {}

bool LostStates::may_meet(const Aim& aim, const symbolic::Successor& state) const {
  const bool right_values = std::all_of(aim.values.begin(), aim.values.end(),
                                        [&](const ValueSet& values) { return values.holds(state.slots); });
  return right_values && std::all_of(aim.places.begin(), aim.places.end(), [&](std::size_t number) {
           const Places& places = aims_.places[number];
           const auto& intervals = places.intervals[static_cast<std::size_t>(state.slots[places.process])];
           return std::any_of(intervals.begin(), intervals.end(), [&](const std::vector<zones::Atom>& atoms) {
             return atoms.empty() || operations_.meets_each(state.zone, dimension_, atoms.data(), atoms.size());
           });
         });
}

bool LostStates::is_hopeful(const symbolic::Successor& state) {
  const std::vector<std::size_t>& open = goals_.open();
  if (last_ != nullptr && std::find(open.begin(), open.end(), goal_) != open.end() && may_meet(*last_, state))
    return true;
  for (const std::size_t goal : open) {
    if (aims_.always[goal]) return true;
    for (const Aim& aim : aims_.goals[goal])
      if (may_meet(aim, state)) {
        last_ = &aim;
        goal_ = goal;
        return true;
      }
  }
  return std::any_of(aims_.errors.begin(), aims_.errors.end(), [&](const Aim& aim) { return may_meet(aim, state); });
}

}  // namespace tachk::reachability::pruning
