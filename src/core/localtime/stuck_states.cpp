#include "localtime/stuck_states.hpp"

#include <algorithm>

namespace tachk::localtime {

using program::Condition;
using program::Disjunct;

namespace {

bool has_deadlock(const Disjunct& disjunct) { return disjunct.deadlock != program::DeadlockLiteral::absent; }

}  // namespace

bool has_deadlock_literal(const program::Program& program) {
  return std::any_of(program.goals.begin(), program.goals.end(), [](const program::Goal& goal) {
    return std::any_of(goal.disjuncts.begin(), goal.disjuncts.end(), has_deadlock);
  });
}

StuckStates::StuckStates(const program::Program& program, const zones::ZoneOperations& operations,
                         reachability::GoalWatch& goals)
    : program_(program), operations_(operations), goals_(goals), dead_(program, operations) {}

void StuckStates::check(std::uint32_t node, std::int32_t* slots, zones::ConstZoneRef zone) {
  bool computed = false;
  open_ = goals_.open();
  for (const std::size_t goal : open_)
    for (const Disjunct& disjunct : program_.goals[goal].disjuncts) {
      if (!has_deadlock(disjunct) || !goals_.meets(disjunct.condition, slots, zone)) continue;
      if (!computed) dead_.compute(slots, zone);
      computed = true;
      if (!any_piece_meets(disjunct, slots)) continue;
      goals_.settle(goal, node);
      break;
    }
}

bool StuckStates::any_piece_meets(const Disjunct& disjunct, std::int32_t* slots) {
  const zones::Federation& found = pieces(disjunct);
  bool met = false;
  for (std::size_t piece = 0; piece < found.size() && !met; ++piece)
    met = goals_.meets(disjunct.condition, slots, found[piece]);
  return met;
}

std::vector<Condition> StuckStates::conditions(const Disjunct& disjunct, std::int32_t* slots,
                                               zones::ConstZoneRef zone) {
  dead_.compute(slots, zone);
  const zones::Federation& found = pieces(disjunct);
  std::vector<Condition> result;
  for (std::size_t piece = 0; piece < found.size(); ++piece) {
    Condition& condition = result.emplace_back(disjunct.condition);
    for (int i = 0; i < program_.dimension(); ++i)
      for (int j = 0; j < program_.dimension(); ++j) {
        const zones::Raw raw = operations_.entry(found[piece], program_.dimension(), i, j);
        if (i != j && raw != zones::unbounded_entry)
          condition.atoms.push_back({static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j), raw});
      }
  }
  return result;
}

}  // namespace tachk::localtime
