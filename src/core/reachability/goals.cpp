#include "reachability/goals.hpp"

#include <algorithm>

namespace tachk::reachability {

using program::Disjunct;
using zones::ConstZoneRef;

namespace {

bool has_deadlock_literal(const Disjunct& disjunct) { return disjunct.deadlock != program::DeadlockLiteral::absent; }

}  // namespace

// The disjuncts are sorted by a location they ask for, so that most states need to look at none of them.
GoalWatch::GoalWatch(const program::Program& program, symbolic::Semantics& semantics,
                     const zones::ZoneOperations& operations, bool shortest)
    : program_(program),
      semantics_(semantics),
      operations_(operations),
      shortest_(shortest),
      reached_(program.goals.size(), states::no_node),
      failures_(program.goals.size()),
      watches_at_(semantics.location_count()),
      scratch_(operations) {
  for (std::size_t goal = 0; goal < program.goals.size(); ++goal) {
    const std::vector<Disjunct>& disjuncts = program.goals[goal].disjuncts;
    open_.push_back(goal);
    has_deadlock_.push_back(std::any_of(disjuncts.begin(), disjuncts.end(), has_deadlock_literal));
    for (const Disjunct& disjunct : disjuncts) {
      if (has_deadlock_literal(disjunct)) continue;
      const std::vector<program::Test>& tests = disjunct.condition.tests;
      const auto place = std::find_if(tests.begin(), tests.end(), [&](const program::Test& test) {
        return test.slot < program.processes.size() && test.comparison == program::Comparison::equal;
      });
      std::vector<Watch>& watches = place == tests.end()
                                        ? watches_anywhere_
                                        : watches_at_[semantics.location_number(place->slot, place->constant)];
      watches.push_back({goal, &disjunct.condition});
    }
  }
}

template <class Visit>
bool GoalWatch::any_watch(const std::int32_t* slots, Visit&& visit) const {
  for (const Watch& watch : watches_anywhere_)
    if (visit(watch)) return true;
  for (std::size_t process = 0; process < program_.processes.size(); ++process)
    for (const Watch& watch : watches_at_[semantics_.location_number(process, slots[process])])
      if (visit(watch)) return true;
  return false;
}

void GoalWatch::check(std::uint32_t node, std::int32_t* slots, ConstZoneRef zone) {
  if (open_.empty()) return;
  any_watch(slots, [&](const Watch& watch) {
    try {
      if (meets(watch, slots, zone)) settle(watch.goal, node);
    } catch (const machine::ModelFault& fault) {
      fail(watch.goal, node, fault);
    }
    return false;
  });
}

bool GoalWatch::meets_any(std::int32_t* slots, ConstZoneRef zone) {
  return !open_.empty() && any_watch(slots, [&](const Watch& watch) { return meets(watch, slots, zone); });
}

bool GoalWatch::meets(const program::Condition& condition, std::int32_t* slots, ConstZoneRef zone) {
  if (!semantics_.holds(condition, slots)) return false;
  atoms_.clear();
  semantics_.resolve(condition, slots, atoms_);
  if (atoms_.empty()) return true;
  const int dimension = program_.dimension();
  if (!operations_.meets_each(zone, dimension, atoms_.data(), atoms_.size())) return false;
  scratch_.assign(zone);
  return operations_.intersect(scratch_.get(), dimension, atoms_.data(), atoms_.size());
}

void GoalWatch::settle(std::size_t goal, std::uint32_t node) {
  reached_[goal] = node;
  if (!shortest_ || !has_deadlock_[goal]) std::erase(open_, goal);
}

void GoalWatch::fail(std::size_t goal, std::uint32_t node, const machine::ModelFault& fault) {
  failures_[goal] = GoalFailure{fault, node};
  std::erase(open_, goal);
}

bool GoalWatch::any_failure() const {
  return std::any_of(failures_.begin(), failures_.end(), [](const auto& failure) { return failure.has_value(); });
}

void GoalWatch::throw_failure() const {
  for (const std::optional<GoalFailure>& failure : failures_)
    if (failure) throw failure->fault;
}

// The states reached by now are no further away than those that the next layer leads to.
void GoalWatch::end_layer() {
  std::erase_if(open_, [this](std::size_t goal) { return reached_[goal] != states::no_node; });
}

}  // namespace tachk::reachability
