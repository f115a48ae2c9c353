// What an explorer looks for: predicates in new states, deadlocks in states it expands.
#include <algorithm>
#include <utility>

#include "reachability/explorer.hpp"

namespace tachk {

// Whether some valuation of the zone satisfies the condition; `atoms` are its clock constraints.
bool Explorer::meets(const Condition& condition, std::int32_t* slots, ConstZoneRef zone, std::vector<Atom>& atoms) {
  if (!semantics_.holds(condition, slots)) return false;
  atoms.clear();
  semantics_.resolve(condition, slots, atoms);
  if (atoms.empty()) return true;
  if (!operations_.meets_each(zone, dimension_, atoms.data(), atoms.size())) return false;
  scratch_.assign(zone);
  return operations_.intersect(scratch_.get(), dimension_, atoms.data(), atoms.size());
}

// Sorts the disjuncts of the goals by a location they ask for, so that most states need to look at none of them.
void Explorer::watch_goals() {
  watches_at_.resize(semantics_.location_count());
  for (std::size_t goal = 0; goal < program_.goals.size(); ++goal)
    for (const Disjunct& disjunct : program_.goals[goal].disjuncts) {
      if (disjunct.deadlock != DeadlockLiteral::absent) continue;
      const std::vector<Test>& tests = disjunct.condition.tests;
      const auto place = std::find_if(tests.begin(), tests.end(), [&](const Test& test) {
        return test.slot < program_.processes.size() && test.comparison == Comparison::equal;
      });
      std::vector<Watch>& watches = place == tests.end()
                                        ? watches_anywhere_
                                        : watches_at_[semantics_.location_number(place->slot, place->constant)];
      watches.push_back({goal, &disjunct.condition});
    }
}

void Explorer::check_goals(std::uint32_t node, std::int32_t* slots, ConstZoneRef zone) {
  if (open_goals_.empty()) return;
  const std::vector<std::uint32_t>* edges = std::exchange(current_edges_, nullptr);
  const std::uint32_t parent = std::exchange(current_node_, node);
  std::vector<std::vector<std::uint32_t>> actions = std::exchange(current_actions_, {});
  for (const Watch& watch : watches_anywhere_) check(watch, node, slots, zone);
  for (std::size_t process = 0; process < program_.processes.size(); ++process)
    for (const Watch& watch : watches_at_[semantics_.location_number(process, slots[process])])
      check(watch, node, slots, zone);
  current_edges_ = edges;
  current_node_ = parent;
  current_actions_ = std::move(actions);
}

bool Explorer::meets_an_open_goal(std::int32_t* slots, ConstZoneRef zone) {
  if (open_goals_.empty()) return false;
  const auto met = [&](const Watch& watch) {
    return reached_[watch.goal] == no_node && meets(*watch.condition, slots, zone, goal_atoms_);
  };
  // An error of a condition is one of the state, not of the action that leads there.
  current_actions_.push_back(*current_edges_);
  const std::vector<std::uint32_t>* edges = std::exchange(current_edges_, nullptr);
  bool some = std::any_of(watches_anywhere_.begin(), watches_anywhere_.end(), met);
  for (std::size_t process = 0; process < program_.processes.size() && !some; ++process) {
    const std::vector<Watch>& watches = watches_at_[semantics_.location_number(process, slots[process])];
    some = std::any_of(watches.begin(), watches.end(), met);
  }
  current_edges_ = edges;
  current_actions_.pop_back();
  return some;
}

void Explorer::check(const Watch& watch, std::uint32_t node, std::int32_t* slots, ConstZoneRef zone) {
  if (reached_[watch.goal] != no_node || !meets(*watch.condition, slots, zone, goal_atoms_)) return;
  settle(watch.goal, node);
}

void Explorer::settle(std::size_t goal, std::uint32_t node) {
  reached_[goal] = node;
  if (!options_.shortest || !asks_deadlock_[goal]) std::erase(open_goals_, goal);
}

void Explorer::begin_deadlock(ConstZoneRef zone) {
  candidates_.clear();
  deadlock_open_ = false;
  bool wants_live = false;
  for (const std::size_t goal : open_goals_)
    for (const Disjunct& disjunct : program_.goals[goal].disjuncts) {
      if (disjunct.deadlock == DeadlockLiteral::absent) continue;
      deadlock_open_ = true;
      if (!meets(disjunct.condition, source_.data(), zone, goal_atoms_)) continue;
      candidates_.emplace_back(goal, &disjunct);
      wants_live |= disjunct.deadlock == DeadlockLiteral::forbidden;
    }
  if (candidates_.empty()) return;
  Delay delay = semantics_.time_passes(source_.data()) ? Delay::free : Delay::none;
  const std::uint8_t* stopped = semantics_.stopped_clocks(source_.data());
  if (stopped != nullptr && std::find(stopped, stopped + dimension_, 1) != stopped + dimension_) delay = Delay::partial;
  deadlock_atoms_.clear();
  semantics_.invariant(source_.data(), deadlock_atoms_);
  deadlocks_.begin(zone, deadlock_atoms_, delay, wants_live);
}

void Explorer::pass_to_deadlock(ConstZoneRef guarded, const Effect& effect) {
  if (candidates_.empty() || !deadlocks_.open()) return;
  deadlock_atoms_.clear();
  if (semantics_.weakest_precondition(effect, deadlock_atoms_)) deadlocks_.add(guarded, deadlock_atoms_);
}

void Explorer::end_deadlock(std::uint32_t node) {
  for (const auto& [goal, disjunct] : candidates_) {
    if (reached_[goal] <= node) continue;  // a successor may have been found to reach it, but that is further away
    const Federation& pieces = disjunct->deadlock == DeadlockLiteral::required ? deadlocks_.dead() : deadlocks_.live();
    bool met = false;
    for (std::size_t piece = 0; piece < pieces.size() && !met; ++piece)
      met = meets(disjunct->condition, source_.data(), pieces[piece], goal_atoms_);
    if (!met) continue;
    settle(goal, node);
  }
  candidates_.clear();
}

}  // namespace tachk
