#include "reachability/deadlock_watch.hpp"

#include <algorithm>

namespace tachk::reachability {

using program::DeadlockLiteral;
using program::Disjunct;
using symbolic::SymbolicState;

DeadlockWatch::DeadlockWatch(symbolic::ZoneGraph& graph, GoalWatch& goals)
    : program_(graph.program()),
      semantics_(graph.semantics()),
      goals_(goals),
      finder_(graph.operations(), program_.dimension()),
      has_deadlock_(std::any_of(program_.goals.begin(), program_.goals.end(),
                                [](const program::Goal& goal) {
                                  return std::any_of(goal.disjuncts.begin(), goal.disjuncts.end(),
                                                     [](const Disjunct& disjunct) {
                                                       return disjunct.deadlock != DeadlockLiteral::absent;
                                                     });
                                })),
      open_(has_deadlock_) {}

void DeadlockWatch::find_candidates(std::uint32_t node, SymbolicState& source) {
  candidates_.clear();
  open_ = false;
  const std::vector<std::size_t> goals = goals_.open();  // those that fail leave them
  for (const std::size_t goal : goals) {
    const std::size_t before = candidates_.size();
    try {
      for (const Disjunct& disjunct : program_.goals[goal].disjuncts) {
        if (disjunct.deadlock == DeadlockLiteral::absent) continue;
        open_ = true;
        if (goals_.meets(disjunct.condition, source.slots.data(), source.zone.get()))
          candidates_.push_back({goal, &disjunct});
      }
    } catch (const machine::ModelFault& fault) {
      candidates_.resize(before);
      goals_.fail(goal, node, fault);
    }
  }
}

void DeadlockWatch::before_expand(std::uint32_t node, SymbolicState& source) {
  if (!open_) return;
  find_candidates(node, source);
  if (candidates_.empty()) return;
  const bool wants_live = std::any_of(candidates_.begin(), candidates_.end(), [](const Candidate& candidate) {
    return candidate.disjunct->deadlock == DeadlockLiteral::forbidden;
  });
  const symbolic::Delay delay = symbolic::delay_in(semantics_, source.slots.data());
  atoms_.clear();
  semantics_.invariant(source.slots.data(), atoms_);
  finder_.begin(source.zone.get(), atoms_, delay, wants_live);
}

void DeadlockWatch::possible(zones::ConstZoneRef guarded, const symbolic::Effect& effect) {
  if (candidates_.empty() || !finder_.open()) return;
  atoms_.clear();
  if (semantics_.weakest_precondition(effect, atoms_)) finder_.add(guarded, atoms_);
}

bool DeadlockWatch::meets(const Candidate& candidate, std::uint32_t node, SymbolicState& source) {
  if (goals_.node(candidate.goal) <= node) return false;  // a successor may have met it too, but that is further away
  const Disjunct& disjunct = *candidate.disjunct;
  const zones::Federation& pieces = disjunct.deadlock == DeadlockLiteral::required ? finder_.dead() : finder_.live();
  bool met = false;
  for (std::size_t piece = 0; piece < pieces.size() && !met; ++piece)
    met = goals_.meets(disjunct.condition, source.slots.data(), pieces[piece]);
  return met;
}

void DeadlockWatch::after_expand(std::uint32_t node, SymbolicState& source) {
  for (const Candidate& candidate : candidates_)
    if (meets(candidate, node, source)) goals_.settle(candidate.goal, node);
  candidates_.clear();
}

}  // namespace tachk::reachability
