#include "simulation/race.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tachk::simulation {

using flow::never;
using flow::Ticks;
using flow::Window;
using program::Condition;
using program::Edge;

namespace {

// In units of time:
constexpr Ticks far = 10'000;  // how far hybrid clocks are followed to see where an invariant ends
constexpr Ticks retries = 4;   // how often what only target invariants forbid is tried, where no delay is drawn

// True if the edge is taken as soon as hybrid clocks allow it. (Other clocks are not in guards of urgent edges.)
bool acts_at_once(Present& present, std::uint32_t number) {
  const Edge& edge = present.program.edges[number];
  return !edge.guard.flow.empty() && !edge.internal() && present.channel(present.channel_of(edge)).urgent;
}

// The first moment in the window at which the edge can be taken, as far as guards decide.
Ticks next_opening(Present& present, std::uint32_t number, Window own) {
  const Edge& edge = present.program.edges[number];
  if (edge.internal()) return own.first;
  const std::int32_t channel = present.channel_of(edge);
  if (present.channel(channel).broadcast) return own.first;
  Ticks first = never;
  for (const std::uint32_t q : present.receivers_of(channel)) {
    if (q == edge.process) continue;
    for (const ReceivingEdge& other : present.place(q).receives) {
      const Edge& partner = present.program.edges[other.edge];
      if (!other.may_name(channel) || !present.integers_hold(partner.guard)) continue;
      Window both = present.window(partner.guard, own.first);
      both.last = std::min(both.last, own.last);
      if (!both.empty() && present.channel_of(partner) == channel) first = std::min(first, both.first);
    }
  }
  return first;
}

// True if guards allow the edge now, so that only a target invariant can forbid it.
bool is_open(Present& present, std::uint32_t number) {
  const Condition& guard = present.program.edges[number].guard;
  return present.holds(guard) && next_opening(present, number, present.window(guard, present.now)) == present.now;
}

}  // namespace

void Openings::add(Window window, bool urgent) {
  if (urgent) {
    at_once = std::min(at_once, window.first);
    return;
  }
  first = std::min(first, window.first);
  last = std::max(last, window.last);
}

std::size_t Race::winner_at(Ticks moment, Random& random) const {
  std::size_t winner = 0;
  std::uint64_t ties = 0;
  due_.for_each_at(moment, [&](std::size_t process) {
    ++ties;
    if (ties == 1 || random.below(ties) == 0) winner = process;
  });
  return winner;
}

void Race::resume(Present& present) {
  for (std::size_t p = 0; p < waits_.size(); ++p) waits_[p] == Wait::parked ? park(present, p) : refresh(present, p);
}

void Race::refresh_parked(Present& present) {
  parked_.for_each([&](std::size_t process) { refresh(present, process); });
}

void Race::refresh(Present& present, std::size_t process) {
  const LocationTables& here = present.place(process);
  present.lookahead = never;
  if (here.freezes()) return wait_for(present, process, {}, never, Wait::to_act);
  const Ticks limit = here.dependencies.has_invariant
                          ? present.end_of(here.location->invariant, present.now + first_lookahead * present.unit())
                          : never;
  Openings openings;
  for (const auto& [number, first_test] : here.outputs) {
    if (!present.may_hold(first_test)) continue;
    const Condition& guard = present.program.edges[number].guard;
    if (!present.integers_hold(guard)) continue;
    const Window own = present.window(guard, present.now);
    if (!own.empty()) openings.add(own, acts_at_once(present, number));
  }
  wait_for(present, process, openings, limit, Wait::to_act);
}

void Race::park(Present& present, std::size_t process) {
  const LocationTables& here = present.place(process);
  present.lookahead = never;
  const Ticks limit = here.location->invariant.flow.empty()
                          ? limit_[process]
                          : present.end_of(here.location->invariant, present.now + first_lookahead * present.unit());
  Openings openings;
  for (const auto& [number, first_test] : here.outputs) {
    if (!present.may_hold(first_test)) continue;
    const Condition& guard = present.program.edges[number].guard;
    if (!present.integers_hold(guard)) continue;
    const Ticks later = !present.random_delays() && is_open(present, number) ? present.unit() / retries : 1;
    const Window own = present.window(guard, present.now + later);
    if (own.empty()) continue;
    const Ticks opening = next_opening(present, number, own);
    if (opening != never) openings.add({opening, own.last}, acts_at_once(present, number));
  }
  wait_for(present, process, openings, limit, Wait::parked);
}

// Draws when the process acts that may do so from one moment to another. A process whose hybrid clocks have to be
// followed farther looks again: what it draws then is distributed alike, for it is exponential.
void Race::wait_for(Present& present, std::size_t process, const Openings& openings, Ticks limit, Wait wait) {
  const auto& [first, last, at_once] = openings;
  if (first < never) {
    present.lookahead = never;
    if (limit == never)
      limit = present.end_of(present.place(process).location->invariant, present.now + far * present.unit());
  }
  Ticks due = first < never && first <= limit ? drawn(present, process, first, last, limit) : never;
  if (at_once <= limit) due = std::min(due, at_once);
  if (present.lookahead < std::min(due, limit)) {
    due = std::max(present.lookahead, present.now + 1);
    wait = Wait::to_resume;
  }
  due_.set(process, due);
  limit_.set(process, limit);
  if ((std::exchange(waits_[process], wait) == Wait::parked) != (wait == Wait::parked))
    wait == Wait::parked ? parked_.add(process) : parked_.remove(process);
}

namespace {

// How one delay is drawn where those at boundaries are likelier.
Policy near_boundary(Random& random) {
  constexpr Policy each[] = {Policy::earliest, Policy::latest, Policy::boundary, Policy::uniform};
  return each[random.below(std::size(each))];
}

}  // namespace

// A moment from `first` on; behind `last` the guards are false, and behind its limit the invariant.
Ticks Race::drawn(Present& present, std::size_t process, Ticks first, Ticks last, Ticks limit) {
  const Policy policy = present.policy == Policy::boundary ? near_boundary(present.random) : present.policy;
  const Ticks bound = policy == Policy::stochastic ? limit : std::min(limit, last);
  if (policy == Policy::earliest) return first;
  if (bound < never) {
    if (policy == Policy::latest) return bound;
    if (policy == Policy::boundary)  // a whole number of units behind the first moment
      return first + present.unit() * static_cast<Ticks>(present.random.below(
                                          static_cast<std::uint64_t>((bound - first) / present.unit()) + 1));
    return first + static_cast<Ticks>(present.random.below(static_cast<std::uint64_t>(bound - first) + 1));
  }
  if (policy == Policy::latest) return first;
  const double rate = present.place(process).rate->value(present.machine, present.values.slots.data());
  if (!(rate >= 0)) throw machine::ModelFault(machine::FaultKind::range, present.place(process).rate->code);
  const double wait = present.random.exponential() / rate * static_cast<double>(present.unit());
  if (wait < static_cast<double>(flow::latest_end)) return first + static_cast<Ticks>(wait);
  return std::isfinite(wait) ? never - 1 : never;  // behind the end of every run, but not never
}

}  // namespace tachk::simulation
