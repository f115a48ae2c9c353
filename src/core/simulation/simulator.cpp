#include "simulation/simulator.hpp"

#include <algorithm>
#include <numeric>

namespace tachk::simulation {

using flow::Ticks;

namespace {

constexpr std::uint64_t most_idle_draws = 100'000;
constexpr int draws = 16;  // of an action, until target invariants admit one

}  // namespace

bool Simulator::begin(const Random& random) {
  present_.start(random);
  action_.clear();
  if (!transition_.begin(present_)) return false;
  if (present_.flow.exists()) present_.flow.start(present_.now, present_.machine, slots());
  for (std::size_t p = 0; p < present_.processes(); ++p) race_.refresh(present_, p);
  return true;
}

void Simulator::resume(const Snapshot& snapshot, const Random& random) {
  present_.random = random;
  present_.values = snapshot.values;
  present_.now = snapshot.now;
  race_ = snapshot.race;
  action_.clear();
  for (std::size_t p = 0; p < present_.processes(); ++p) present_.update_dependencies(p);
  race_.resume(present_);
}

// ---- the next transition --------------------------------------------------------------------------------------------

std::optional<Ending> Simulator::step(const RunLimits& limits) {
  present_.draw_from_own();  // this may be a copy of another simulator
  for (std::uint64_t draws = 0; draws < most_idle_draws;) {
    if (frozen()) return act_now() ? std::nullopt : std::optional(Ending::deadlock);
    const auto [first, limit] = race_.next_moments();
    if (std::min(first, limit) > limits.until) {
      present_.move_to(limits.until);
      return Ending::horizon;
    }
    if (limit < first) {
      // No process has drawn a moment before an invariant ends: one that can act then must.
      present_.move_to(limit);
      candidates_.resize(present_.processes());
      std::iota(candidates_.begin(), candidates_.end(), std::size_t{0});
      return act_first(candidates_) ? std::nullopt : std::optional(Ending::time_lock);
    }
    present_.move_to(first);
    const std::size_t winner = race_.winner_at(first, present_.random);
    if (race_.resumes(winner)) {
      race_.refresh(present_, winner);
      continue;
    }
    if (act(winner)) return std::nullopt;
    race_.park(present_, winner);
    ++draws;
  }
  return Ending::zeno;
}

Ticks Simulator::next_moment() {
  present_.draw_from_own();  // this may be a copy of another simulator
  if (frozen()) return present_.now;
  const auto [first, limit] = race_.next_moments();
  return std::min(first, limit);
}

// True if time cannot pass; finds those who stop it, and those who would act at this moment anyway.
bool Simulator::frozen() {
  const Values& values = present_.values;
  candidates_.clear();
  if (values.committed == 0)
    for (const std::uint32_t p : present_.tables.urgent_senders)
      if (present_.sends_urgently(p)) candidates_.push_back(p);
  const std::size_t senders = candidates_.size();
  if (values.committed == 0 && values.urgent == 0 && senders == 0) return false;
  const auto end = [&] { return candidates_.begin() + static_cast<std::ptrdiff_t>(senders); };
  for (std::size_t p = 0; p < present_.processes(); ++p) {
    const Dependencies& here = present_.dependencies[p];
    const bool first = values.committed > 0 ? here.committed : here.urgent || race_.is_due(p, present_.now);
    if (first && std::find(candidates_.begin(), end(), p) == end()) candidates_.push_back(p);
  }
  return true;
}

// Time cannot pass. Those who stop it, whom `frozen` has found, go first.
bool Simulator::act_now() {
  if (act_first(candidates_)) return true;
  const std::vector<std::size_t> tried = candidates_;
  candidates_.clear();
  for (std::size_t p = 0; p < present_.processes(); ++p)
    if (std::find(tried.begin(), tried.end(), p) == tried.end()) candidates_.push_back(p);
  return act_first(candidates_);
}

// One of those that can act does, each with the same probability.
bool Simulator::act_first(std::vector<std::size_t>& candidates) {
  for (std::size_t left = candidates.size(); left > 0; --left) {
    const std::size_t n = left == 1 ? 0 : present_.random.below(left);
    if (act(candidates[n])) return true;
    std::swap(candidates[n], candidates[left - 1]);
  }
  return false;
}

// The process takes one of its edges, alone or with others; false if it cannot.
bool Simulator::act(std::size_t process) {
  if (present_.program.has_priorities) return act_by_priority(process);
  enabled_.clear();
  for (const auto& [number, first_test] : present_.place(process).outputs)
    if (present_.may_hold(first_test) && present_.open(number)) enabled_.push_back(number);
  // A receiver of a single edge is checked below.
  if (enabled_.size() > 1)
    std::erase_if(enabled_, [&](std::uint32_t number) { return !present_.is_enabled(process, number); });
  if (enabled_.empty() || (enabled_.size() == 1 && !present_.is_enabled_alone(process, enabled_.front()))) return false;
  return carry_out();
}

bool Simulator::take(std::uint32_t edge, Ticks moment) {
  present_.draw_from_own();  // this may be a copy of another simulator
  present_.move_to(moment);
  enabled_.assign(1, edge);
  return carry_out();
}

// Draws an action that begins with one of `offered_`, and takes it.
bool Simulator::carry_out() {
  for (int draw = 0; draw < draws; ++draw) {
    if (!choice_.choose(present_, enabled_, action_)) return false;
    if (apply()) return true;
  }
  return act_exhaustively();
}

// Draws among all actions that begin with one of `offered_` and that target invariants admit.
bool Simulator::act_exhaustively() {
  WeightedActions possible;
  choice_.enumerate(present_, enabled_, possible);
  while (const auto drawn = draw_weighted(possible.probabilities, present_.random)) {
    action_ = possible.actions[*drawn];
    if (apply()) return true;
    possible.remove(*drawn);
  }
  return false;
}

// The process takes one of its actions, if none of higher priority is possible.
bool Simulator::act_by_priority(std::size_t process) {
  WeightedActions all;
  std::size_t own = 0;  // actions of the process, which stand first
  for (std::size_t n = 0; n < present_.processes(); ++n) {
    const std::size_t p = n == 0 ? process : n <= process ? n - 1 : n;
    std::vector<std::uint32_t> offered;
    for (const auto& [number, first_test] : present_.place(p).outputs)
      if (present_.may_hold(first_test) && present_.open(number) && present_.is_enabled(p, number))
        offered.push_back(number);
    choice_.enumerate(present_, offered, all);
    if (n == 0) own = all.actions.size();
  }
  std::optional<Priority> highest;
  for (const Action& action : all.actions) {
    const Priority its = priority(action);
    if ((!highest || *highest < its) && admitted(action)) highest = its;
  }
  WeightedActions possible;
  for (std::size_t n = 0; n < own; ++n)
    if (highest && priority(all.actions[n]) == *highest && admitted(all.actions[n]))
      possible.add(all.actions[n], all.probabilities[n]);
  const auto drawn = draw_weighted(possible.probabilities, present_.random);
  if (!drawn) return false;
  action_ = possible.actions[*drawn];
  return apply();
}

// Of the channel, then the highest of the processes that take part.
Simulator::Priority Simulator::priority(const Action& action) {
  const program::Program& program = present_.program;
  const program::Edge& first = program.edges[action.front()];
  Priority result{first.internal() ? program.default_priority : present_.channel(present_.channel_of(first)).priority,
                  program.processes[first.process].priority};
  for (const std::uint32_t number : action)
    result.second = std::max(result.second, program.processes[program.edges[number].process].priority);
  return result;
}

// True if invariants admit the state after an action.
bool Simulator::admitted(const Action& action) {
  const Random before = present_.random;
  action_ = action;
  const bool result = transition_.enter(present_, action_);
  transition_.undo(present_);
  present_.random = before;
  return result;
}

// Takes the action; false, with nothing changed, if an invariant does not admit the state after it. Who is concerned
// draws anew.
bool Simulator::apply() {
  if (!transition_.enter(present_, action_)) {
    transition_.undo(present_);
    return false;
  }
  Values& values = present_.values;
  for (const std::uint32_t number : action_) {
    const std::size_t process = present_.program.edges[number].process;
    const Dependencies before = present_.dependencies[process];
    present_.update_dependencies(process);
    const Dependencies& after = present_.dependencies[process];
    values.committed += (after.committed ? 1U : 0U) - (before.committed ? 1U : 0U);
    values.urgent += (after.urgent ? 1U : 0U) - (before.urgent ? 1U : 0U);
  }
  if (transition_.changes_flow()) present_.flow.start(present_.now, present_.machine, slots());
  for (const std::size_t p : transition_.concerned()) race_.refresh(present_, p);
  race_.refresh_parked(present_);
  transition_.settle();
  return true;
}

// ---- behind the end -------------------------------------------------------------------------------------------------

// A tick may be too long: where x < 5 ends time, some passes at each moment before 5.
bool Simulator::time_passes() {
  present_.draw_from_own();  // this may be a copy of another simulator
  if (frozen()) return false;
  for (std::size_t p = 0; p < present_.processes(); ++p) {
    const LocationTables& here = present_.place(p);
    if (!here.dependencies.has_invariant) continue;
    const program::Condition& invariant = here.location->invariant;
    if (present_.clock_window(invariant, 1).last <= present_.now) return false;
    if (!invariant.flow.empty() && present_.end_of(invariant, present_.now + 1) <= present_.now) return false;
  }
  return true;
}

void Simulator::retreat() {
  if (!transition_.under_way()) return;
  transition_.undo(present_);
  present_.update_all_dependencies();
}

}  // namespace tachk::simulation
