#include "simulation/simulator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tachk {
namespace {

constexpr Raw largest_reset = INT32_MAX;
constexpr std::uint64_t most_idle_draws = 100'000;
constexpr Ticks retry = ticks_per_unit / 4;  // of what only target invariants forbid, where no delay is drawn
constexpr int attempts = 16;                 // of drawing an action that target invariants admit

}  // namespace

Simulator::Simulator(const Program& program, const Chances& chances, const Tables& tables, Policy policy)
    : program_(program),
      chances_(chances),
      tables_(tables),
      policy_(policy),
      machine_(program, largest_reset),
      random_(0, 0),
      state_{{}, ClockValues(program.dimension())} {
  const std::size_t count = program.processes.size();
  race_ = {std::vector<Ticks>(count), std::vector<Ticks>(count), std::vector<std::uint8_t>(count)};
}

bool Simulator::begin(Random random) {
  random_ = random;
  machine_.draw_from(&random_);
  now_ = 0;
  action_.clear();
  state_.slots.clear();
  for (const Slot& slot : program_.slots) state_.slots.push_back(slot.initial);
  state_.clocks.start();
  change_ = {};
  if (program_.has_stopwatches) switch_clocks();
  state_.committed = 0;
  state_.urgent = 0;
  for (std::size_t p = 0; p < processes(); ++p) {
    state_.committed += place(p).location->committed ? 1 : 0;
    state_.urgent += place(p).location->urgent ? 1 : 0;
  }
  for (std::size_t p = 0; p < processes(); ++p) change_.concerned.push_back(p);
  if (!invariants_hold()) return false;
  for (std::size_t p = 0; p < processes(); ++p) refresh(p);
  return true;
}

void Simulator::resume(const Snapshot& snapshot, Random random) {
  random_ = random;
  state_ = snapshot.state;
  race_ = snapshot.race;
  now_ = snapshot.now;
  action_.clear();
  for (std::size_t p = 0; p < processes(); ++p) race_.parked[p] != 0 ? park(p) : refresh(p);
}

std::optional<Ending> Simulator::step(const RunLimits& limits) {
  machine_.draw_from(&random_);  // this may be a copy of another simulator
  for (std::uint64_t draws = 0; draws < most_idle_draws; ++draws) {
    if (frozen()) return act_now() ? std::nullopt : std::optional(Ending::deadlock);
    const auto [first, limit] = next_moments();
    if (std::min(first, limit) > limits.until) {
      now_ = limits.until;
      return Ending::horizon;
    }
    if (limit < first) {
      // Nobody has drawn a moment before an invariant ends: whoever can act then must.
      now_ = limit;
      candidates_.clear();
      for (std::size_t p = 0; p < processes(); ++p) candidates_.push_back(p);
      return act_first(candidates_) ? std::nullopt : std::optional(Ending::time_lock);
    }
    now_ = first;
    const std::size_t winner = winner_at(first);
    if (act(winner)) return std::nullopt;
    park(winner);
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
  for (const Test& test : condition.tests)
    if (!test.holds(state_.slots.data())) return false;
  return condition.code == no_code || machine_.value(condition.code, state_.slots.data()) != 0;
}

Window Simulator::window(const Condition& condition) {
  Window result;
  for (const Atom& atom : condition.atoms) state_.clocks.narrow(atom.left, atom.right, atom.raw, result);
  std::int32_t* slots = state_.slots.data();
  for (const ComputedConstraint& c : condition.computed) {
    if (c.condition != no_code && machine_.value(c.condition, slots) == 0) continue;
    const std::int64_t left = c.left_code == no_code ? c.left : machine_.value(c.left_code, slots);
    const std::int64_t right = c.right_code == no_code ? c.right : machine_.value(c.right_code, slots);
    const std::int64_t bound = c.bound_code == no_code ? c.bound : machine_.value(c.bound_code, slots);
    state_.clocks.narrow(static_cast<std::uint16_t>(left), static_cast<std::uint16_t>(right),
                         raw_bound(bound, c.strict), result);
  }
  return result;
}

std::int32_t Simulator::channel_of(const Edge& edge) {
  return edge.channel_code == no_code
             ? edge.channel
             : static_cast<std::int32_t>(machine_.value(edge.channel_code, state_.slots.data()));
}

bool Simulator::hears(std::uint32_t number, std::int32_t channel) {
  const Edge& edge = program_.edges[number];
  return edge.may_name(channel) && open(number) && channel_of(edge) == channel;
}

// ---- the race -------------------------------------------------------------------------------------------------------

// When the process acts if nothing changes, by its own guards: whether somebody receives is asked when the moment has
// come. Where nobody does, the process waits for the next moment when somebody may, and draws again from there.
void Simulator::refresh(std::size_t process) {
  const Station& here = place(process);
  race_.parked[process] = 0;
  race_.due[process] = never;
  race_.limit[process] = never;
  if (here.freezes()) return;
  if (here.location->has_invariant) race_.limit[process] = window(here.location->invariant).last;
  Ticks first = never;
  Ticks last = -never;
  for (const std::uint32_t number : here.outputs) {
    const Condition& guard = program_.edges[number].guard;
    if (!integers_hold(guard)) continue;
    Window own = window(guard);
    own.first = std::max(own.first, now_);
    if (own.empty()) continue;
    first = std::min(first, own.first);
    last = std::max(last, own.last);
  }
  if (first < never && first <= race_.limit[process]) race_.due[process] = drawn(process, first, last);
}

void Simulator::park(std::size_t process) {
  const Station& here = place(process);
  Ticks first = never;
  Ticks last = -never;
  for (const std::uint32_t number : here.outputs) {
    const Condition& guard = program_.edges[number].guard;
    if (!integers_hold(guard)) continue;
    Window own = window(guard);
    const bool random = policy_ == Policy::stochastic || policy_ == Policy::uniform;
    const bool forbidden = own.first <= now_ && program_.edges[number].internal();
    own.first = std::max(own.first, now_ + (forbidden && !random ? retry : 1));
    if (own.empty()) continue;
    const Ticks opening = next_opening(number, own);
    if (opening == never) continue;
    first = std::min(first, opening);
    last = std::max(last, own.last);
  }
  race_.parked[process] = 1;
  race_.due[process] = first <= race_.limit[process] && first < never ? drawn(process, first, last) : never;
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
    for (const std::uint32_t other : place(q).receives) {
      const Edge& partner = program_.edges[other];
      if (!partner.may_name(channel) || !integers_hold(partner.guard)) continue;
      Window both = window(partner.guard);
      both.first = std::max(both.first, own.first);
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
  if (!(rate >= 0)) throw ModelFault(FaultKind::range, place(process).rate->code);
  const double wait = random_.exponential() / rate * static_cast<double>(ticks_per_unit);
  return wait < static_cast<double>(latest_end) ? first + static_cast<Ticks>(wait) : never;
}

// ---- actions --------------------------------------------------------------------------------------------------------

// Whether time cannot pass; finds those who stop it, and those who would act at this moment anyway.
bool Simulator::frozen() {
  candidates_.clear();
  if (state_.committed == 0)
    for (const std::uint32_t p : tables_.urgent_senders)
      if (sends_urgently(p)) candidates_.push_back(p);
  const std::size_t senders = candidates_.size();
  if (state_.committed == 0 && state_.urgent == 0 && senders == 0) return false;
  const auto end = [&] { return candidates_.begin() + static_cast<std::ptrdiff_t>(senders); };
  for (std::size_t p = 0; p < processes(); ++p) {
    const Location& here = *place(p).location;
    const bool first = state_.committed > 0 ? here.committed : here.urgent || race_.due[p] == now_;
    if (first && std::find(candidates_.begin(), end(), p) == end()) candidates_.push_back(p);
  }
  return true;
}

// Whether an urgent synchronisation of the process stops time.
bool Simulator::sends_urgently(std::size_t process) {
  for (const std::uint32_t number : place(process).urgent) {
    if (!open(number)) continue;
    const std::int32_t channel = channel_of(program_.edges[number]);
    const Channel& kind = program_.channels[static_cast<std::size_t>(channel)];
    if (kind.urgent && (kind.broadcast || has_receiver(process, channel, false))) return true;
  }
  return false;
}

// Time cannot pass. Those who stop it, whom `frozen` has found, go first.
bool Simulator::act_now() {
  if (act_first(candidates_)) return true;
  const std::vector<std::size_t> tried = candidates_;
  candidates_.clear();
  for (std::size_t p = 0; p < processes(); ++p)
    if (std::find(tried.begin(), tried.end(), p) == tried.end()) candidates_.push_back(p);
  return act_first(candidates_);
}

// One of those that can act does, each with the same probability.
bool Simulator::act_first(std::vector<std::size_t>& candidates) {
  for (std::size_t left = candidates.size(); left > 0; --left) {
    const std::size_t n = left == 1 ? 0 : random_.below(left);
    if (act(candidates[n])) return true;
    std::swap(candidates[n], candidates[left - 1]);
  }
  return false;
}

// The process takes one of its edges, alone or with others; false if it cannot.
bool Simulator::act(std::size_t process) {
  offered_.clear();
  for (const std::uint32_t number : place(process).outputs)
    if (open(number)) offered_.push_back(number);
  // Of a single edge it is asked below whether somebody receives.
  if (offered_.size() > 1) std::erase_if(offered_, [&](std::uint32_t number) { return !offers(process, number); });
  if (offered_.empty() || (offered_.size() == 1 && !offers_alone(process, offered_.front()))) return false;
  return carry_out();
}

bool Simulator::take(std::uint32_t edge, Ticks moment) {
  machine_.draw_from(&random_);  // this may be a copy of another simulator
  now_ = moment;
  offered_.assign(1, edge);
  return carry_out();
}

// Draws an action that begins with one of `offered_`, and takes it.
bool Simulator::carry_out() {
  for (int attempt = 0; attempt < attempts; ++attempt) {
    if (!choose(offered_)) return false;
    if (apply()) return true;
  }
  return act_exhaustively(offered_);
}

// Whether a single edge may be tried without asking who receives.
bool Simulator::offers_alone(std::size_t process, std::uint32_t number) {
  const Edge& edge = program_.edges[number];
  if (edge.internal()) return admits(process);
  const std::int32_t channel = channel_of(edge);
  return !program_.channels[static_cast<std::size_t>(channel)].broadcast || offers(process, number);
}

// Whether an edge whose guard holds can be taken, but for target invariants.
bool Simulator::offers(std::size_t process, std::uint32_t number) {
  const Edge& edge = program_.edges[number];
  if (edge.internal()) return admits(process);
  const std::int32_t channel = channel_of(edge);
  const bool broadcast = program_.channels[static_cast<std::size_t>(channel)].broadcast;
  if (broadcast && admits(process)) return true;
  return has_receiver(process, channel, !admits(process));
}

bool Simulator::has_receiver(std::size_t sender, std::int32_t channel, bool committed_only) {
  for (const std::uint32_t q : tables_.listening[static_cast<std::size_t>(channel)]) {
    if (q == sender) continue;
    const Station& there = place(q);
    if (committed_only && !there.location->committed) continue;
    for (const std::uint32_t other : there.receives)
      if (hears(other, channel)) return true;
  }
  return false;
}

void Simulator::open_receives(std::size_t process, std::int32_t channel, std::vector<std::uint32_t>& found) {
  found.clear();
  for (const std::uint32_t other : place(process).receives)
    if (hears(other, channel)) found.push_back(other);
}

double Simulator::weight(std::uint32_t edge) {
  if (policy_ == Policy::uniform) return 1.0;
  const Number& number = chances_.weights[edge];
  const double value = number.value(machine_, state_.slots.data());
  if (!(value >= 0)) throw ModelFault(FaultKind::range, number.code);
  return value;
}

// Each way with the same probability, and of a way into a branchpoint each branch by its weight.
std::vector<std::pair<std::uint32_t, double>> Simulator::shares(std::span<const std::uint32_t> edges) {
  std::vector<std::pair<std::uint32_t, double>> result;
  std::vector<std::pair<std::uint32_t, double>> totals;  // of each way
  for (const std::uint32_t edge : edges) {
    const std::uint32_t way = chances_.choices[edge];
    const auto same = std::find_if(totals.begin(), totals.end(), [&](const auto& each) { return each.first == way; });
    const double share = weight(edge);
    result.emplace_back(edge, share);
    if (same == totals.end())
      totals.emplace_back(way, share);
    else
      same->second += share;
  }
  for (auto& [edge, share] : result) {
    const std::uint32_t way = chances_.choices[edge];
    const auto total = std::find_if(totals.begin(), totals.end(), [&](const auto& each) { return each.first == way; });
    share = total->second > 0 ? share / (total->second * static_cast<double>(totals.size())) : 0.0;
  }
  return result;
}

std::uint32_t Simulator::pick(std::span<const std::uint32_t> edges) {
  if (edges.size() == 1) return edges.front();
  if (!tables_.has_branches) return edges[random_.below(edges.size())];
  const auto known = shares(edges);
  double total = 0;
  for (const auto& [edge, share] : known) total += share;
  double left = random_.fraction() * total;
  std::uint32_t last = edges.front();
  for (const auto& [edge, share] : known) {
    if (share <= 0) continue;
    last = edge;
    if (left < share) break;
    left -= share;
  }
  return last;
}

// Draws an action that begins with one of the edges; false if nobody receives.
bool Simulator::choose(std::span<const std::uint32_t> offered) {
  const std::uint32_t first = pick(offered);
  const Edge& edge = program_.edges[first];
  action_.assign(1, first);
  if (edge.internal()) return true;
  const std::int32_t channel = channel_of(edge);
  const std::vector<std::uint32_t>& listening = tables_.listening[static_cast<std::size_t>(channel)];
  const bool broadcast = program_.channels[static_cast<std::size_t>(channel)].broadcast;
  const bool committed_only = !broadcast && !admits(edge.process);
  std::uint64_t partners = 0;
  for (const std::uint32_t q : listening) {
    if (q == edge.process || (committed_only && !place(q).location->committed)) continue;
    open_receives(q, channel, heard_);
    if (heard_.empty()) continue;
    if (broadcast) {
      action_.push_back(pick(heard_));
      continue;
    }
    ++partners;
    if (partners == 1 || random_.below(partners) == 0) std::swap(heard_, partner_);
  }
  if (broadcast) return true;
  if (partners > 0) action_.push_back(pick(partner_));
  return partners > 0;
}

// Draws among all actions that target invariants admit, by the probabilities that `choose` gives them.
bool Simulator::act_exhaustively(std::span<const std::uint32_t> offered) {
  std::vector<std::vector<std::uint32_t>> actions;
  std::vector<double> probabilities;
  for (const auto& [edge, share] : shares(offered)) enumerate(edge, actions, probabilities, share);
  while (!actions.empty()) {
    double total = 0;
    for (const double probability : probabilities) total += probability;
    if (total <= 0) return false;
    double left = random_.fraction() * total;
    std::size_t n = 0;
    while (n + 1 < actions.size() && left >= probabilities[n]) left -= probabilities[n++];
    action_ = actions[n];
    if (apply()) return true;
    actions.erase(actions.begin() + static_cast<std::ptrdiff_t>(n));
    probabilities.erase(probabilities.begin() + static_cast<std::ptrdiff_t>(n));
  }
  return false;
}

// Appends the actions that begin with an edge, each with its probability.
void Simulator::enumerate(std::uint32_t first, std::vector<std::vector<std::uint32_t>>& actions,
                          std::vector<double>& probabilities, double probability) {
  const Edge& edge = program_.edges[first];
  std::vector<std::vector<std::uint32_t>> found{{first}};
  std::vector<double> chances{probability};
  if (!edge.internal()) {
    const std::int32_t channel = channel_of(edge);
    const bool broadcast = program_.channels[static_cast<std::size_t>(channel)].broadcast;
    std::vector<std::vector<std::uint32_t>> partners;
    for (const std::uint32_t q : tables_.listening[static_cast<std::size_t>(channel)]) {
      if (q == edge.process || (!broadcast && !admits(edge.process) && !place(q).location->committed)) continue;
      open_receives(q, channel, heard_);
      if (!heard_.empty()) partners.push_back(heard_);
    }
    const std::size_t count = partners.size();
    if (!broadcast && count > 0) {
      found.clear();
      chances.clear();
    }
    for (const std::vector<std::uint32_t>& heard : partners) {
      std::vector<std::vector<std::uint32_t>> longer = broadcast ? std::exchange(found, {}) : decltype(found){{first}};
      std::vector<double> of_longer = broadcast ? std::exchange(chances, {}) : std::vector<double>{probability};
      for (std::size_t n = 0; n < longer.size(); ++n)
        for (const auto& [other, share] : shares(heard)) {
          found.push_back(longer[n]);
          found.back().push_back(other);
          chances.push_back(of_longer[n] * share / (broadcast ? 1.0 : static_cast<double>(count)));
        }
    }
  }
  actions.insert(actions.end(), found.begin(), found.end());
  probabilities.insert(probabilities.end(), chances.begin(), chances.end());
}

// ---- changes --------------------------------------------------------------------------------------------------------

// Takes the action; false, with nothing changed, if an invariant does not admit the state after it.
bool Simulator::apply() {
  std::copy_n(state_.slots.begin(), program_.state_slots,
              (change_.slots.resize(program_.state_slots), change_.slots.begin()));
  change_.written = {};
  change_.resets.clear();
  change_.values.clear();
  change_.switched.clear();
  change_.clocks = 0;
  update();
  if (program_.has_stopwatches) switch_clocks();
  find_concerned();
  if (!invariants_hold()) {
    undo();
    return false;
  }
  settle();
  return true;
}

void Simulator::update() {
  for (const std::uint32_t number : action_) {
    const Update& update = program_.edges[number].update;
    for (const Update::Store& store : update.stores) {
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
    state_.clocks.set(reset.clock, Ticks{reset.value} * ticks_per_unit, now_);
  }
}

// Lets clocks run or stand as the locations want.
void Simulator::switch_clocks() {
  std::vector<std::uint8_t> stands(static_cast<std::size_t>(program_.dimension()), 0);
  for (std::size_t p = 0; p < processes(); ++p)
    for (const Location::Stop& stop : place(p).location->stopped)
      if (stop.code == no_code || machine_.value(stop.code, state_.slots.data()) == 0) stands[stop.clock] = 1;
  for (std::uint16_t clock = 1; clock < program_.dimension(); ++clock) {
    if (state_.clocks.runs(clock) != (stands[clock] != 0)) continue;
    state_.clocks.run(clock, stands[clock] == 0, now_);
    change_.switched.push_back(clock);
    change_.clocks |= clock_group(clock);
  }
}

// Finds the processes that the change concerns: no other invariant can have become false, no other draw is void.
void Simulator::find_concerned() {
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
    const Location& here = *place(p).location;
    if (!here.has_invariant) continue;
    if (!integers_hold(here.invariant) || !window(here.invariant).holds(now_)) return false;
  }
  return true;
}

void Simulator::undo() {
  for (const std::uint16_t clock : change_.switched) state_.clocks.run(clock, !state_.clocks.runs(clock), now_);
  for (auto each = change_.values.rbegin(); each != change_.values.rend(); ++each)
    state_.clocks.set(each->first, each->second, now_);
  std::copy(change_.slots.begin(), change_.slots.end(), state_.slots.begin());
}

// Who is concerned draws anew.
void Simulator::settle() {
  for (const std::uint32_t number : action_) {
    const Edge& edge = program_.edges[number];
    const std::vector<Location>& locations = program_.processes[edge.process].locations;
    const Location& before = locations[static_cast<std::size_t>(edge.source)];
    const Location& after = locations[static_cast<std::size_t>(edge.target)];
    state_.committed += (after.committed ? 1U : 0U) - (before.committed ? 1U : 0U);
    state_.urgent += (after.urgent ? 1U : 0U) - (before.urgent ? 1U : 0U);
  }
  for (const std::size_t p : change_.concerned) refresh(p);
  for (std::size_t p = 0; p < processes(); ++p)
    if (race_.parked[p] != 0) refresh(p);
}

}  // namespace tachk
