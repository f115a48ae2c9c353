#include "localtime/local_explorer.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "localtime/local_paths.hpp"
#include "localtime/order_of_time.hpp"

namespace tachk::localtime {

using reachability::Status;
using states::no_node;
using symbolic::Path;

void ActionsTaken::add(const symbolic::Edges& action) {
  const auto [place, fresh] = known_.try_emplace(action, static_cast<std::uint32_t>(actions_.size()));
  if (fresh) actions_.push_back(&place->first);
  numbers_.push_back(place->second);
}

void WaitingZones::add(std::uint32_t node, const std::vector<LocalEntry>& zone) {
  zones_.resize(node + 1);
  zones_[node] = zone;
  most_ = std::max(most_, ++count_);
}

std::vector<LocalEntry> WaitingZones::take(std::uint32_t node) {
  --count_;
  return std::exchange(zones_[node], {});
}

LocalExplorer::LocalExplorer(program::Program program, const reachability::Options& options,
                             const reachability::Limits& limits)
    : limits_(limits),
      subsumption_(options.subsumption),
      graph_(std::move(program), options),
      passed_(graph_.program(), graph_.ordinary().operations(), options, graph_.ordinary().smaller_operations()),
      waiting_(options.order, options.seed, limits.depth),
      zones_(graph_.zones().size()),
      goals_(graph_.program(), graph_.ordinary().semantics(), graph_.ordinary().operations(), false),
      slots_(graph_.program().slots.size()),
      exact_(graph_.ordinary().operations()) {
  if (options.shortest || limits.depth != UINT32_MAX) throw std::invalid_argument("steps are counted");
  if (!has_deadlock_literal(graph_.program())) return;
  if (options.extrapolation == symbolic::Extrapolation::lu)
    throw std::invalid_argument("deadlock is asked for with LU bounds");
  stuck_.emplace(graph_.program(), graph_.ordinary().operations(), goals_);
}

// ---- the loop -------------------------------------------------------------------------------------------------------

Status LocalExplorer::run(std::uint64_t expansions) {
  return in_pieces_([&] {
    try {
      return search(expansions);
    } catch (const machine::ModelFault&) {
      return Status::fault;
    } catch (const symbolic::ConstantOverflow&) {
      return Status::constant_limit;
    }
  });
}

Status LocalExplorer::search(std::uint64_t expansions) {
  if (!std::exchange(started_, true)) {
    graph_.start([&](const LocalSuccessor& initial) {
      passed_.announce(initial.effect.slots.data(), initial.effect.written);
      store(initial, no_node);
    });
    waiting_.close(graph_.program(), passed_);
  }
  while (!goals_.settled()) {
    if (expansions-- == 0) return Status::running;
    const std::uint32_t node = next();
    if (node == no_node) return Status::finished;
    expand(node);
    if (passed_.stored() > limits_.states) return Status::state_limit;
    if (limits_.memory_bytes != UINT64_MAX && statistics().bytes > limits_.memory_bytes) return Status::memory_limit;
  }
  return Status::finished;
}

std::uint32_t LocalExplorer::next() {
  std::uint32_t node = waiting_.next();
  for (; node != no_node && passed_.covered(node); node = waiting_.next()) zones_.take(node);
  return node;
}

void LocalExplorer::expand(std::uint32_t node) {
  passed_.unpack(node, slots_.data());
  waiting_.begin(slots_.data());
  ++explored_;
  graph_.expand(
      slots_.data(), zones_.take(node),
      [&](const symbolic::Effect& effect) { passed_.announce(effect.slots.data(), effect.written); },
      [&](const LocalSuccessor& successor) {
        ++transitions_;
        store(successor, node);
      });
  waiting_.close(graph_.program(), passed_);
}

void LocalExplorer::store(const LocalSuccessor& successor, std::uint32_t parent) {
  symbolic::ZoneGraph& ordinary = graph_.ordinary();
  std::int32_t* slots = successor.effect.slots.data();
  const std::uint32_t discrete = passed_.locate();
  if (subsumption_ && passed_.covers(discrete, ordinary.packed(slots, successor.synchronised.get()))) return;
  exact_.assign(successor.synchronised.get());
  ordinary.abstract(slots, successor.synchronised, [&](zones::ConstZoneRef zone) {
    const std::uint32_t node = passed_.add(discrete, ordinary.packed(slots, zone), parent, subsumption_);
    if (node == no_node) return;
    waiting_.add(node, parent, slots, passed_.covered_last());
    zones_.add(node, successor.zone);
    actions_.add(successor.edges);
    goals_.check(node, slots, exact_.get());
    goals_.throw_failure();
    if (stuck_) stuck_->check(node, slots, exact_.get());
  });
}

// ---- the interface --------------------------------------------------------------------------------------------------

reachability::Statistics LocalExplorer::statistics() const {
  const std::size_t bytes = passed_.bytes() + waiting_.bytes() + zones_.bytes() + actions_.bytes();
  return {explored_, passed_.stored(), transitions_, bytes};
}

std::uint64_t LocalExplorer::effort() const {
  constexpr std::uint64_t entries_as_long = 1024;  // as a state takes
  const std::uint64_t dimension = graph_.agents().count + static_cast<std::uint64_t>(graph_.program().clocks);
  return passed_.stored() + transitions_ * dimension * dimension / entries_as_long;
}

std::optional<std::uint32_t> LocalExplorer::reached(std::size_t goal) const {
  return goals_.node(goal) == no_node ? std::nullopt : std::optional(goals_.node(goal));
}

Path LocalExplorer::path_to_goal(std::size_t goal) {
  Path actions;
  for (std::uint32_t node = goals_.node(goal); passed_.parent(node) != no_node; node = passed_.parent(node))
    actions.push_back(actions_.of(node));
  std::reverse(actions.begin(), actions.end());
  if (graph_.symmetry().active()) actions = unsorted_path(graph_, actions);
  symbolic::Semantics& semantics = graph_.ordinary().semantics();
  for (const program::Disjunct& disjunct : graph_.program().goals[goal].disjuncts)
    for (const program::Condition& end : ends(disjunct, actions))
      if (auto ordered = in_order_of_time(semantics, graph_.agents(), actions, end)) return *std::move(ordered);
  throw std::logic_error("no times are right for a run over local times");
}

std::vector<program::Condition> LocalExplorer::ends(const program::Disjunct& disjunct, const Path& actions) {
  if (disjunct.deadlock == program::DeadlockLiteral::absent) return {disjunct.condition};
  LocalState last = state_after(graph_, actions);
  return stuck_->conditions(disjunct, last.slots.data(), last.synchronised.get());
}

}  // namespace tachk::localtime
