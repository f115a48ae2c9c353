#include "simulation/simulator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tachk::simulation {

using flow::Crossings;
using flow::never;
using flow::Ticks;
using flow::Window;
using program::Condition;
using program::Edge;
using program::no_code;
using zones::ClockReset;

namespace {

constexpr std::uint64_t most_idle_draws = 100'000;
// In units of time:
constexpr Ticks near = 1;      // how far hybrid clocks are followed before something happens
constexpr Ticks far = 10'000;  // ... to see where an invariant ends
constexpr Ticks retries = 4;   // how often what only target invariants forbid is tried, where no delay is drawn

}  // namespace

Simulator::Simulator(const program::Program& program, const flow::Chances& chances, const Tables& tables, Policy policy,
                     Ticks ticks_per_unit)
    : program_(program),
      chances_(chances),
      tables_(tables),
      policy_(policy),
      machine_(program, machine::largest_exact_reset),
      random_(0, 0),
      state_{{}, flow::ClockValues(program.dimension(), ticks_per_unit)},
      flow_(chances, ticks_per_unit) {
  const std::size_t count = program.processes.size();
  race_ = {std::vector<Ticks>(count), std::vector<Ticks>(count), std::vector<Wait>(count)};
  outlooks_.resize(count);
}

bool Simulator::begin(const Random& random) {
  random_ = random;
  machine_.draw_from(&random_);
  now_ = 0;
  action_.clear();
  state_.slots.clear();
  for (const program::Slot& slot : program_.slots) state_.slots.push_back(slot.initial);
  for (const std::int32_t code : chances_.starts) {
    program::SlotSet drawn;
    std::vector<ClockReset> none;
    machine_.update(code, state_.slots.data(), drawn, none);
  }
  state_.clocks.start();
  for (const ClockReset& start : program_.starts) state_.clocks.set(start.clock, Ticks{start.value} * unit(), 0);
  change_ = {};
  if (program_.has_stopwatches) switch_clocks();
  state_.committed = 0;
  state_.urgent = 0;
  for (std::size_t p = 0; p < processes(); ++p) {
    look_from(p);
    state_.committed += outlooks_[p].committed ? 1 : 0;
    state_.urgent += outlooks_[p].urgent ? 1 : 0;
  }
  for (std::size_t p = 0; p < processes(); ++p) change_.concerned.push_back(p);
  if (!invariants_hold()) return false;
  if (flow_.exists()) flow_.start(now_, machine_, state_.slots.data());
  for (std::size_t p = 0; p < processes(); ++p) refresh(p);
  return true;
}

void Simulator::resume(const Snapshot& snapshot, const Random& random) {
  random_ = random;
  state_ = snapshot.state;
  race_ = snapshot.race;
  now_ = snapshot.now;
  action_.clear();
  for (std::size_t p = 0; p < processes(); ++p) look_from(p);
  for (std::size_t p = 0; p < processes(); ++p) race_.waits[p] == Wait::parked ? park(p) : refresh(p);
}

std::optional<Ending> Simulator::step(const RunLimits& limits) {
  machine_.draw_from(&random_);  // this may be a copy of another simulator
  for (std::uint64_t draws = 0; draws < most_idle_draws;) {
    if (frozen()) return act_now() ? std::nullopt : std::optional(Ending::deadlock);
    const auto [first, limit] = next_moments();
    if (std::min(first, limit) > limits.until) {
      move_to(limits.until);
      return Ending::horizon;
    }
    if (limit < first) {
      // Nobody has drawn a moment before an invariant ends: whoever can act then must.
      move_to(limit);
      scratch_.candidates.clear();
      for (std::size_t p = 0; p < processes(); ++p) scratch_.candidates.push_back(p);
      return act_first(scratch_.candidates) ? std::nullopt : std::optional(Ending::time_lock);
    }
    move_to(first);
    const std::size_t winner = winner_at(first);
    if (race_.waits[winner] == Wait::to_look) {
      refresh(winner);
      continue;
    }
    if (act(winner)) return std::nullopt;
    park(winner);
    ++draws;
  }
  return Ending::zeno;
}

Ticks Simulator::next_moment() {
  machine_.draw_from(&random_);  // this may be a copy of another simulator
  if (frozen()) return now_;
  const auto [first, limit] = next_moments();
  return std::min(first, limit);
}

// When somebody has drawn to act, and when an invariant ends.
std::pair<Ticks, Ticks> Simulator::next_moments() const {
  Ticks first = never;
  Ticks limit = never;
  for (std::size_t p = 0; p < processes(); ++p) {
    first = std::min(first, race_.due[p]);
    limit = std::min(limit, race_.limit[p]);
  }
  return {first, limit};
}

// Drawn only when the moment has come, so that a run that is stopped before and goes on is the same run.
std::size_t Simulator::winner_at(Ticks moment) {
  std::size_t winner = 0;
  std::uint64_t ties = 0;
  for (std::size_t p = 0; p < processes(); ++p) {
    if (race_.due[p] != moment) continue;
    ++ties;
    if (ties == 1 || random_.below(ties) == 0) winner = p;
  }
  return winner;
}

// ---- conditions -----------------------------------------------------------------------------------------------------

bool Simulator::integers_hold(const Condition& condition) {
  for (const program::Test& test : condition.tests)
    if (!test.holds(state_.slots.data())) return false;
  return condition.code == no_code || machine_.value(condition.code, state_.slots.data()) != 0;
}

// The moments at which the conditions on clocks that are not hybrid hold, or, with the closure 1, up to which they do.
Window Simulator::clock_window(const Condition& condition, zones::Raw closure) {
  Window result;
  for (const zones::Atom& atom : condition.atoms)
    state_.clocks.narrow(atom.left, atom.right, atom.raw | closure, result);
  std::int32_t* slots = state_.slots.data();
  for (const program::ComputedConstraint& c : condition.computed) {
    if (c.condition != no_code && machine_.value(c.condition, slots) == 0) continue;
    const std::int64_t left = c.left_code == no_code ? c.left : machine_.value(c.left_code, slots);
    const std::int64_t right = c.right_code == no_code ? c.right : machine_.value(c.right_code, slots);
    const std::int64_t bound = c.bound_code == no_code ? c.bound : machine_.value(c.bound_code, slots);
    state_.clocks.narrow(static_cast<std::uint16_t>(left), static_cast<std::uint16_t>(right),
                         zones::raw_bound(bound, c.strict) | closure, result);
  }
  return result;
}

// The first interval, from a moment on, in which all conditions on clocks hold. Its end is looked for where it counts.
Window Simulator::window(const Condition& condition, Ticks from) {
  Window result = clock_window(condition);
  result.first = std::max(result.first, from);
  if (condition.flow.empty() || result.empty()) return result;
  Crossings hybrid = crossings();
  const Crossings::Found found = hybrid.opening(condition.flow, result.first, result.last, now_ + near * unit());
  sight_ = std::min(sight_, found.seen);
  result.first = found.moment;
  if (found.moment < never && policy_ != Policy::stochastic)
    result.last =
        std::min(result.last, hybrid.ending(condition.flow, found.moment, found.moment + near * unit()).moment);
  flow_.show(now_, machine_, state_.slots.data());
  return result;
}

// The last moment at which an invariant holds that holds now.
Ticks Simulator::end_of(const Condition& invariant, Ticks sight) {
  const Ticks last = clock_window(invariant).last;
  if (invariant.flow.empty()) return last;
  const Crossings::Found found = crossings().ending(invariant.flow, now_, std::min(last, sight));
  flow_.show(now_, machine_, state_.slots.data());
  if (found.moment == never && found.seen < last) sight_ = std::min(sight_, found.seen);
  return std::min(last, found.moment);
}

std::int32_t Simulator::channel_of(const Edge& edge) {
  return edge.channel_code == no_code
             ? edge.channel
             : static_cast<std::int32_t>(machine_.value(edge.channel_code, state_.slots.data()));
}

bool Simulator::hears(const Reception& reception, std::int32_t channel) {
  return reception.may_name(channel) && may_hold(reception.gate) && open(reception.edge) &&
         channel_of(program_.edges[reception.edge]) == channel;
}

// ---- the race -------------------------------------------------------------------------------------------------------

// When the process acts if nothing changes, by its own guards: whether somebody receives is asked when the moment has
// come. Where nobody does, the process waits for the next moment when somebody may, and draws again from there.
void Simulator::refresh(std::size_t process) {
  const Station& here = place(process);
  race_.waits[process] = Wait::to_act;
  race_.due[process] = never;
  race_.limit[process] = never;
  if (here.freezes()) return;
  sight_ = never;
  if (here.outlook.has_invariant) race_.limit[process] = end_of(here.location->invariant, now_ + near * unit());
  Openings openings;
  for (const auto& [number, gate] : here.outputs) {
    if (!may_hold(gate)) continue;
    const Condition& guard = program_.edges[number].guard;
    if (!integers_hold(guard)) continue;
    const Window own = window(guard, now_);
    if (!own.empty()) openings.add(own, acts_at_once(number));
  }
  wait_for(process, openings, Wait::to_act);
}

// Draws when the process acts that may do so from one moment to another. A process whose hybrid clocks have to be
// followed farther looks again: what it draws then is distributed alike, for it is exponential.
void Simulator::wait_for(std::size_t process, const Openings& openings, Wait wait) {
  const auto& [first, last, at_once] = openings;
  const Condition& invariant = place(process).location->invariant;
  race_.waits[process] = wait;
  if (first < never) {
    sight_ = never;
    if (race_.limit[process] == never) race_.limit[process] = end_of(invariant, now_ + far * unit());
  }
  race_.due[process] = first < never && first <= race_.limit[process] ? drawn(process, first, last) : never;
  if (at_once <= race_.limit[process]) race_.due[process] = std::min(race_.due[process], at_once);
  if (sight_ >= std::min(race_.due[process], race_.limit[process])) return;
  race_.due[process] = std::max(sight_, now_ + 1);
  race_.waits[process] = Wait::to_look;
}

void Simulator::park(std::size_t process) {
  const Station& here = place(process);
  sight_ = never;
  if (!here.location->invariant.flow.empty())
    race_.limit[process] = end_of(here.location->invariant, now_ + near * unit());
  Openings openings;
  for (const auto& [number, gate] : here.outputs) {
    if (!may_hold(gate)) continue;
    const Condition& guard = program_.edges[number].guard;
    if (!integers_hold(guard)) continue;
    const bool random = policy_ == Policy::stochastic || policy_ == Policy::uniform;
    const bool forbidden = program_.edges[number].internal() && holds(guard);
    const Window own = window(guard, now_ + (forbidden && !random ? unit() / retries : 1));
    if (own.empty()) continue;
    const Ticks opening = next_opening(number, own);
    if (opening != never) openings.add({opening, own.last}, acts_at_once(number));
  }
  wait_for(process, openings, Wait::parked);
}

// Whether the edge is taken as soon as hybrid clocks allow it. (Other clocks are not in guards of urgent edges.)
bool Simulator::acts_at_once(std::uint32_t number) {
  const Edge& edge = program_.edges[number];
  return !edge.guard.flow.empty() && !edge.internal() &&
         program_.channels[static_cast<std::size_t>(channel_of(edge))].urgent;
}

// The first moment in the window at which the edge can be taken, as far as guards tell.
Ticks Simulator::next_opening(std::uint32_t number, Window own) {
  const Edge& edge = program_.edges[number];
  if (edge.internal()) return own.first;
  const std::int32_t channel = channel_of(edge);
  if (program_.channels[static_cast<std::size_t>(channel)].broadcast) return own.first;
  Ticks first = never;
  for (const std::uint32_t q : tables_.listening[static_cast<std::size_t>(channel)]) {
    if (q == edge.process) continue;
    for (const Reception& other : place(q).receives) {
      const Edge& partner = program_.edges[other.edge];
      if (!other.may_name(channel) || !integers_hold(partner.guard)) continue;
      Window both = window(partner.guard, own.first);
      both.last = std::min(both.last, own.last);
      if (!both.empty() && channel_of(partner) == channel) first = std::min(first, both.first);
    }
  }
  return first;
}

// A moment from `first` on; behind `last` the guards are false, and behind its limit the invariant.
Ticks Simulator::drawn(std::size_t process, Ticks first, Ticks last) {
  const Ticks limit = race_.limit[process];
  const Ticks bound = policy_ == Policy::stochastic ? limit : std::min(limit, last);
  if (policy_ == Policy::earliest) return first;
  if (bound < never) return policy_ == Policy::latest ? bound : uniform(first, bound);
  if (policy_ == Policy::latest) return first;
  const double rate = place(process).rate->value(machine_, state_.slots.data());
  if (!(rate >= 0)) throw machine::ModelFault(machine::FaultKind::range, place(process).rate->code);
  const double wait = random_.exponential() / rate * static_cast<double>(unit());
  if (wait < static_cast<double>(flow::latest_end)) return first + static_cast<Ticks>(wait);
  return std::isfinite(wait) ? never - 1 : never;  // behind the end of every run, but not never
}

// ---- changes --------------------------------------------------------------------------------------------------------

// Takes the action; false, with nothing changed, if an invariant does not admit the state after it.
bool Simulator::apply() {
  if (!enter()) {
    undo();
    return false;
  }
  settle();
  return true;
}

// Makes the changes of the action; says whether invariants admit the state after it.
bool Simulator::enter() {
  std::copy_n(state_.slots.begin(), program_.state_slots,
              (change_.slots.resize(program_.state_slots), change_.slots.begin()));
  change_.written = {};
  change_.resets.clear();
  change_.values.clear();
  change_.switched.clear();
  change_.clocks = 0;
  change_.under_way = true;
  update();
  if (program_.has_stopwatches) switch_clocks();
  find_concerned();
  return invariants_hold();
}

void Simulator::update() {
  for (const std::uint32_t number : action_) {
    const program::Update& update = program_.edges[number].update;
    for (const program::Update::Store& store : update.stores) {
      state_.slots[store.slot] = store.value;
      change_.written.add(store.slot);
    }
    change_.resets.insert(change_.resets.end(), update.resets.begin(), update.resets.end());
    if (update.code != no_code) machine_.update(update.code, state_.slots.data(), change_.written, change_.resets);
  }
  for (const std::uint32_t number : action_) {
    const Edge& edge = program_.edges[number];
    state_.slots[edge.process] = edge.target;
    if (tables_.reads_locations) change_.written.add(edge.process);
  }
  for (const std::uint32_t slot : tables_.meta_slots) state_.slots[slot] = program_.slots[slot].initial;
  for (const ClockReset& reset : change_.resets) {
    change_.values.emplace_back(reset.clock, state_.clocks.value(reset.clock, now_));
    change_.clocks |= clock_group(reset.clock);
    const Ticks copied = state_.clocks.value(reset.source, now_);
    const Ticks advance = Ticks{reset.value} * unit();
    if (copied > machine::largest_exact_reset * unit() + flow::latest_end - advance)
      throw machine::ModelFault(machine::FaultKind::bound, no_code);
    state_.clocks.set(reset.clock, copied + advance, now_);
  }
}

// Lets clocks run or stand as the locations want.
void Simulator::switch_clocks() {
  std::vector<std::uint8_t> stands(static_cast<std::size_t>(program_.dimension()), 0);
  for (std::size_t p = 0; p < processes(); ++p)
    for (const program::Location::Stop& stop : place(p).location->stopped)
      if (stop.code == no_code || machine_.value(stop.code, state_.slots.data()) == 0) stands[stop.clock] = 1;
  const auto dimension = static_cast<std::uint16_t>(program_.dimension());
  for (std::uint16_t clock = 1; clock < dimension; ++clock) {
    if (state_.clocks.runs(clock) != (stands[clock] != 0)) continue;
    state_.clocks.run(clock, stands[clock] == 0, now_);
    change_.switched.push_back(clock);
    change_.clocks |= clock_group(clock);
  }
}

// Whether hybrid clocks get other values or rates.
bool Simulator::changes_flow() const {
  if (chances_.flow_reads.meets(change_.written)) return true;
  return std::any_of(action_.begin(), action_.end(), [&](std::uint32_t number) {
    const Edge& edge = program_.edges[number];
    const auto& rates = chances_.flow_rates[edge.process];
    return edge.source != edge.target && (!rates[static_cast<std::size_t>(edge.source)].empty() ||
                                          !rates[static_cast<std::size_t>(edge.target)].empty());
  });
}

// Finds the processes that the change concerns: no other invariant can have become false, no other draw is void.
void Simulator::find_concerned() {
  change_.flow = flow_.exists() && changes_flow();
  change_.concerned.clear();
  for (const std::uint32_t number : action_) change_.concerned.push_back(program_.edges[number].process);
  const std::size_t participants = change_.concerned.size();
  for (std::size_t p = 0; p < processes(); ++p) {
    if (!touched(p)) continue;
    const auto end = change_.concerned.begin() + static_cast<std::ptrdiff_t>(participants);
    if (std::find(change_.concerned.begin(), end, p) == end) change_.concerned.push_back(p);
  }
}

bool Simulator::invariants_hold() {
  for (const std::size_t p : change_.concerned) {
    const Station& here = place(p);
    if (here.outlook.has_invariant && !holds(here.location->invariant)) return false;
  }
  return true;
}

void Simulator::undo() {
  for (const std::uint16_t clock : change_.switched) state_.clocks.run(clock, !state_.clocks.runs(clock), now_);
  for (auto each = change_.values.rbegin(); each != change_.values.rend(); ++each)
    state_.clocks.set(each->first, each->second, now_);
  std::copy(change_.slots.begin(), change_.slots.end(), state_.slots.begin());
  change_.under_way = false;
}

// Who is concerned draws anew.
void Simulator::settle() {
  for (const std::uint32_t number : action_) {
    const std::size_t process = program_.edges[number].process;
    const Outlook before = outlooks_[process];
    look_from(process);
    const Outlook& after = outlooks_[process];
    state_.committed += (after.committed ? 1U : 0U) - (before.committed ? 1U : 0U);
    state_.urgent += (after.urgent ? 1U : 0U) - (before.urgent ? 1U : 0U);
  }
  if (change_.flow) flow_.start(now_, machine_, state_.slots.data());
  for (const std::size_t p : change_.concerned) refresh(p);
  for (std::size_t p = 0; p < processes(); ++p)
    if (race_.waits[p] == Wait::parked) refresh(p);
  change_.under_way = false;
}

}  // namespace tachk::simulation
