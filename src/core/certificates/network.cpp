#include "certificates/network.hpp"

#include <algorithm>
#include <cstdlib>

namespace tachk::certificates {

using program::Channel;
using program::Edge;
using program::Location;
using program::no_code;
using zones::Raw;

namespace {

constexpr Raw largest_constant = Raw{1} << 40;

}  // namespace

Network::Network(program::Program given)
    : program(std::move(given)), n(static_cast<std::size_t>(program.dimension())), machine_(program, largest_constant) {
  for (const program::Process& process : program.processes) leaving_.emplace_back(process.locations.size());
  for (std::uint32_t number = 0; number < program.edges.size(); ++number)
    leaving_[program.edges[number].process][static_cast<std::size_t>(program.edges[number].source)].push_back(number);
  receivers_.resize(program.channels.size());
  for (std::size_t number = 0; number < program.channels.size(); ++number)
    for (std::uint32_t p = 0; p < program.processes.size(); ++p)
      if (std::any_of(program.edges.begin(), program.edges.end(), [&](const Edge& edge) {
            return edge.process == p && !edge.sends && edge.may_name(static_cast<std::int32_t>(number));
          }))
        receivers_[number].push_back(p);
  for (std::uint32_t slot = 0; slot < program.state_slots; ++slot)
    if (program.slots[slot].meta) metas_.push_back(slot);
  for (const Channel& channel : program.channels) has_urgent_channels_ |= channel.urgent;
}

const Location& Network::location(std::size_t process, const Slots& slots) const {
  return program.processes[process].locations[static_cast<std::size_t>(slots[process])];
}
const std::vector<std::uint32_t>& Network::leaving(std::size_t process, const Slots& slots) const {
  return leaving_[process][static_cast<std::size_t>(slots[process])];
}
// True if the integer part of a condition holds; then its clock constraints are appended.
bool Network::holds(const program::Condition& condition, Slots& slots, Constraints& constraints) {
  for (const program::Test& test : condition.tests)
    if (!test.holds(slots.data())) return false;
  if (condition.code != no_code && machine_.value(condition.code, slots.data()) == 0) return false;
  constraints.insert(constraints.end(), condition.atoms.begin(), condition.atoms.end());
  const auto number = [&](std::int32_t code, std::int64_t given) {
    return code == no_code ? given : machine_.value(code, slots.data());
  };
  for (const program::ComputedConstraint& each : condition.computed) {
    if (number(each.condition, 1) == 0) continue;
    const auto left = static_cast<std::uint16_t>(number(each.left_code, each.left));
    const auto right = static_cast<std::uint16_t>(number(each.right_code, each.right));
    const std::int64_t bound = number(each.bound_code, each.bound);
    if (std::abs(bound) > largest_constant) throw machine::ModelFault(machine::FaultKind::bound, each.bound_code);
    constraints.push_back({left, right, zones::raw_bound(bound, each.strict)});
  }
  return true;
}
// The part of a zone where a guard holds, which is in `room` unless it is all of the zone; null if it is empty.
const Zone* Network::where(const Edge& edge, Slots& slots, const Zone& zone, Part& room) {
  room.guard.clear();
  if (!holds(edge.guard, slots, room.guard)) return nullptr;
  if (zone.lies_in(room.guard)) return &zone;
  room.zone = zone;
  room.zone.tighten(room.guard);
  return room.zone.empty() ? nullptr : &room.zone;
}
std::int32_t Network::channel(const Edge& edge, Slots& slots) {
  if (edge.internal() || edge.channel_code == no_code) return edge.channel;
  return static_cast<std::int32_t>(machine_.value(edge.channel_code, slots.data()));
}
bool Network::receives(const Edge& edge, std::int32_t used, Slots& slots) {
  return !edge.internal() && !edge.sends && edge.may_name(used) && channel(edge, slots) == used;
}

// ---- time -----------------------------------------------------------------------------------------------------------

Network::Slots Network::initial() const {
  Slots slots;
  for (const program::Slot& slot : program.slots) slots.push_back(slot.initial);
  return slots;
}

void Network::describe(Situation& here) {
  here.possible = here.waits = true;
  here.stops = false;
  here.limits.clear();
  here.stands.assign(n, false);
  here.stands[0] = true;
  for (std::size_t p = 0; p < program.processes.size() && here.possible; ++p) {
    const Location& current = location(p, here.slots);
    here.possible = holds(current.invariant, here.slots, here.limits);
    here.waits &= !current.urgent && !current.committed;
    for (const Location::Stop& stop : current.stopped)
      if (stop.code == no_code || machine_.value(stop.code, here.slots.data()) == 0)
        here.stands[stop.clock] = here.stops = true;
  }
  here.waits = here.waits && here.possible && !(has_urgent_channels_ && is_urgent(here.slots));
}

// True if an urgent channel can be used; edges over one compare no clocks.
bool Network::is_urgent(Slots& slots) {
  Constraints ignored;
  for (std::size_t p = 0; p < program.processes.size(); ++p)
    for (const std::uint32_t number : leaving(p, slots)) {
      const Edge& sender = program.edges[number];
      if (sender.internal() || !sender.sends) continue;
      const auto first = program.channels.begin() + sender.channel;
      const auto urgent = [](const Channel& kind) { return kind.urgent; };
      if (std::none_of(first, first + sender.channels, urgent) || !holds(sender.guard, slots, ignored)) continue;
      const std::int32_t used = channel(sender, slots);
      const Channel& kind = program.channels[static_cast<std::size_t>(used)];
      if (kind.urgent && kind.broadcast) return true;
      for (std::size_t q = 0; q < program.processes.size() && kind.urgent; ++q)
        for (const std::uint32_t other : leaving(q, slots))
          if (const Edge& edge = program.edges[other];
              q != p && edge.may_name(used) && holds(edge.guard, slots, ignored) && receives(edge, used, slots))
            return true;
    }
  return false;
}

Zone Network::later(const Situation& here, Zone zone) const {
  if (zone.empty() || !here.waits) return zone;
  zone.go_on(here.stands);
  zone.tighten(here.limits);
  return zone;
}

// ---- steps ----------------------------------------------------------------------------------------------------------

std::span<Step> Network::steps(Situation& here, const Zone& zone, Steps& room) {
  find_steps(here, zone);
  if (program.has_priorities) hold_back_lower_priorities();
  std::swap(steps_, room);
  return room.found();
}

void Network::find_steps(Situation& here, const Zone& zone) {
  steps_.clear();
  Slots& slots = here.slots;
  Part room;
  most_ = 0;
  for (std::size_t p = 0; p < program.processes.size(); ++p) most_ = std::max(most_, location(p, slots).commitment());
  for (std::size_t p = 0; p < program.processes.size(); ++p)
    for (const std::uint32_t number : leaving(p, slots)) {
      const Edge& edge = program.edges[number];
      const bool free = location(p, slots).may_go(most_);
      if (edge.internal() ? !free : !edge.sends) continue;
      taking_part.assign(1, number);
      const Zone* guarded = where(edge, slots, zone, room);
      if (guarded == nullptr) continue;
      const std::int32_t used = channel(edge, slots);
      if (edge.internal())
        add_step(slots, *guarded, used);
      else if (program.channels[static_cast<std::size_t>(used)].broadcast)
        add_receivers(slots, 0, used, *guarded, free);
      else
        add_partner(slots, used, *guarded, free);
    }
}
void Network::add_partner(Slots& slots, std::int32_t used, const Zone& zone, bool free) {
  const std::size_t sender = program.edges[taking_part[0]].process;
  Part room;
  for (const std::size_t q : receivers_[static_cast<std::size_t>(used)])
    for (const std::uint32_t number : leaving(q, slots)) {
      const Edge& edge = program.edges[number];
      if (q == sender || edge.sends || !edge.may_name(used) || (!free && !location(q, slots).may_go(most_))) continue;
      const Zone* guarded = where(edge, slots, zone, room);
      if (guarded == nullptr || !receives(edge, used, slots)) continue;
      taking_part.push_back(number);
      add_step(slots, *guarded, used);
      taking_part.pop_back();
    }
}
// A process that can receive a broadcast does, by any of its edges whose guard holds; else it stays out.
void Network::add_receivers(Slots& slots, std::size_t next, std::int32_t used, const Zone& zone, bool free) {
  const auto& processes = receivers_[static_cast<std::size_t>(used)];
  for (; next < processes.size(); ++next) {
    const std::size_t q = processes[next];
    if (q == program.edges[taking_part[0]].process) continue;
    Zones staying{};
    Part part;
    bool some = false;
    for (const std::uint32_t number : leaving(q, slots)) {
      const Edge& edge = program.edges[number];
      if (edge.sends || !edge.may_name(used)) continue;
      const Zone* guarded = where(edge, slots, zone, part);
      if (guarded == nullptr || !receives(edge, used, slots)) continue;
      taking_part.push_back(number);
      add_receivers(slots, next + 1, used, *guarded, free || location(q, slots).may_go(most_));
      taking_part.pop_back();
      if (!std::exchange(some, true) && guarded != &zone) staying = {zone};
      staying = without(staying, part.guard);
    }
    if (!some) continue;
    for (const Zone& piece : staying) add_receivers(slots, next + 1, used, piece, free);
    return;
  }
  if (free) add_step(slots, zone, used);
}
void Network::add_step(const Slots& slots, const Zone& guarded, std::int32_t used) {
  const std::pair priority{
      used < 0 ? program.default_priority : program.channels[static_cast<std::size_t>(used)].priority,
      program.processes[program.edges[taking_part[0]].process].priority};
  Step& step = steps_.add();
  step.edges = taking_part;
  step.priority = priority;
  step.resets.clear();
  Slots& target = step.target.slots;
  target = slots;
  program::SlotSet ignored;
  for (const std::uint32_t number : taking_part) {
    const program::Update& update = program.edges[number].update;
    for (const program::Update::Store& store : update.stores) target[store.slot] = store.value;
    step.resets.insert(step.resets.end(), update.resets.begin(), update.resets.end());
    if (update.code != no_code) machine_.update(update.code, target.data(), ignored, step.resets);
  }
  for (const std::uint32_t number : taking_part) {
    const Edge& edge = program.edges[number];
    target[edge.process] = edge.target;
    step.priority.second = std::max(step.priority.second, program.processes[edge.process].priority);
  }
  for (const std::uint32_t slot : metas_) target[slot] = program.slots[slot].initial;
  describe(step.target);
  if (step.target.possible)
    step.guarded = guarded;
  else
    steps_.drop_last();
}
void Network::hold_back_lower_priorities() {
  Steps parts;
  for (const Step& step : steps_.found()) {
    Zones pieces{step.guarded};
    for (const Step& other : steps_.found())
      if (other.priority > step.priority)
        if (const Zone blocker = other.possible(); !blocker.empty()) pieces = without(pieces, blocker.constraints());
    for (Zone& piece : pieces) (parts.add() = step).guarded = std::move(piece);
  }
  steps_ = std::move(parts);
}

Zone Step::possible() const {
  Zone zone = guarded;
  for (zones::Atom atom : target.limits) {
    // The constraint before the clocks are set, the last one first.
    for (auto reset = resets.rbegin(); reset != resets.rend(); ++reset) {
      if (atom.left == reset->clock) atom = {reset->source, atom.right, atom.raw - 2 * Raw{reset->value}};
      if (atom.right == reset->clock) atom = {atom.left, reset->source, atom.raw + 2 * Raw{reset->value}};
    }
    zone.tighten(atom);
  }
  return zone;
}
Zone& Step::reach() {
  for (const zones::ClockReset& reset : resets) guarded.reset(reset);
  guarded.tighten(target.limits);
  return guarded;
}

// ---- predicates -----------------------------------------------------------------------------------------------------

Zones Network::where(const program::Goal& goal, Situation& here, const Zone& zone, bool widely) {
  Zones found;
  for (const program::Disjunct& disjunct : goal.disjuncts) {
    Constraints constraints;
    if (!holds(disjunct.condition, here.slots, constraints)) continue;
    const Zone met = zone.within(constraints);
    if (met.empty()) continue;
    Zones parts{met};
    if (disjunct.deadlock == program::DeadlockLiteral::required) parts = stuck(here, met, widely);
    if (disjunct.deadlock == program::DeadlockLiteral::forbidden) parts = without(parts, stuck(here, met, !widely));
    found.insert(found.end(), parts.begin(), parts.end());
  }
  return found;
}

// The past of a zone is a zone only if no clock is stopped.
Zones Network::stuck(Situation& here, const Zone& zone, bool widely) {
  Zones dead{zone};
  find_steps(here, later(here, zone));
  for (const Step& step : steps_.found()) {
    Zone alive = step.possible();
    if (alive.empty()) continue;
    if (here.waits && here.stops && !widely) return {};
    if (here.waits && !here.stops) alive.go_back();
    dead = without(dead, alive.constraints());
  }
  return dead;
}

// A valuation that lies before a met zone, on its way through time, may go on until it enters that zone; one behind all
// of it, and one that never meets it, may go on for ever. If clocks are stopped, only the met zones are left out.
Zones Network::avoiding(const program::Goal& goal, Situation& here, const Zone& zone) {
  Zones all;
  all.push_back(later(here, zone));
  const Zones met = where(goal, here, all.front(), false);
  if (met.empty()) return all;
  Zones starts = without({zone}, met);
  if (starts.empty() || !here.waits) return starts;
  std::vector<std::pair<Zone, Zones>> pieces;  // each with what it must not enter
  for (const Zone& start : starts) pieces.push_back({start, here.stops ? met : Zones{}});
  for (std::size_t number = 0; number < met.size() && !here.stops; ++number) {
    Zone future = met[number];
    future.go_on(here.stands);
    std::vector<std::pair<Zone, Zones>> split;
    for (auto& [piece, closed] : pieces) {
      if (Zone behind = piece.within(future.constraints()); !behind.empty())
        split.emplace_back(std::move(behind), closed);
      closed.push_back(future);
      for (Zone& before : without({piece}, future.constraints())) split.emplace_back(std::move(before), closed);
    }
    pieces = std::move(split);
  }
  Zones found;
  for (const auto& [piece, closed] : pieces)
    for (Zone& part : without({later(here, piece)}, closed)) found.push_back(std::move(part));
  return found;
}

}  // namespace tachk::certificates
