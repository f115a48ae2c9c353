#include "symbolic/successor.hpp"

#include <algorithm>

namespace tachk::symbolic {

using program::Channel;
using program::Comparison;
using program::Edge;
using program::Location;
using program::no_code;
using program::Test;
using zones::Atom;
using zones::ClockReset;
using zones::ConstZoneRef;
using zones::Raw;

namespace {

using Processes = std::vector<std::uint32_t>;

void make_set(Processes& processes) {
  std::sort(processes.begin(), processes.end());
  processes.erase(std::unique(processes.begin(), processes.end()), processes.end());
}

// Of each channel the processes with an edge that may receive from it.
std::vector<Processes> receivers_of_channels(const program::Program& program) {
  std::vector<Processes> receivers(program.channels.size());
  for (const Edge& edge : program.edges)
    for (std::uint32_t n = 0; !edge.internal() && !edge.sends && n < edge.channels; ++n)
      receivers[static_cast<std::size_t>(edge.channel) + n].push_back(edge.process);
  std::for_each(receivers.begin(), receivers.end(), make_set);
  return receivers;
}

Processes partners_of(const Edge& sender, const std::vector<Processes>& receivers) {
  Processes partners;
  for (std::uint32_t n = 0; n < sender.channels; ++n)
    for (const std::uint32_t process : receivers[static_cast<std::size_t>(sender.channel) + n])
      if (process != sender.process) partners.push_back(process);
  if (sender.channels > 1) make_set(partners);
  return partners;
}

}  // namespace

Semantics::Semantics(const program::Program& program, const zones::ZoneOperations& operations)
    : program_(program),
      operations_(operations),
      machine_(program, operations.largest_constant),
      stopped_(static_cast<std::size_t>(program.dimension())) {
  std::size_t count = 0;
  for (const program::Process& process : program.processes) {
    first_location_.push_back(count);
    count += process.locations.size();
    for (const Location& here : process.locations) {
      has_urgent_locations_ |= here.urgent || here.committed;
      has_committed_locations_ |= here.committed;
    }
  }
  outgoing_.resize(count);
  const std::vector<Processes> receivers = receivers_of_channels(program);
  for (std::uint32_t number = 0; number < program.edges.size(); ++number) {
    const Edge& edge = program.edges[number];
    Outgoing& out = outgoing_[location_number(edge.process, edge.source)];
    if (!edge.internal() && edge.sends)
      out.sends.push_back({number, partners_of(edge, receivers)});
    else
      (edge.internal() ? out.internal : out.receives).push_back(number);
    const auto first = static_cast<std::uint32_t>(guard_tests_.size());
    for (const Test& test : edge.guard.tests) guard_tests_.emplace_back(test);
    integer_guards_.push_back({first, static_cast<std::uint32_t>(guard_tests_.size()), edge.guard.code});
  }
  for (std::uint32_t slot = 0; slot < program.state_slots; ++slot)
    if (program.slots[slot].meta) meta_slots_.push_back(slot);
  for (const Channel& channel : program.channels) has_urgent_channels_ |= channel.urgent;
}

Semantics::RangeTest::RangeTest(const Test& test)
    : slot(test.slot), low(static_cast<std::uint32_t>(test.constant)), span(0), outside(false) {
  constexpr auto smallest = static_cast<std::uint32_t>(INT32_MIN);
  const std::uint32_t constant = low;
  switch (test.comparison) {
    case Comparison::equal:
      break;
    case Comparison::not_equal:
      outside = true;
      break;
    case Comparison::less:  // not at least the constant
    case Comparison::greater_equal:
      span = static_cast<std::uint32_t>(INT32_MAX) - constant;
      outside = test.comparison == Comparison::less;
      break;
    case Comparison::less_equal:
    case Comparison::greater:  // not at most the constant
      low = smallest;
      span = constant - smallest;
      outside = test.comparison == Comparison::greater;
      break;
  }
}

bool Semantics::holds(const program::Condition& condition, std::int32_t* slots) {
  for (const Test& test : condition.tests)
    if (!test.holds(slots)) return false;
  return condition.code == no_code || machine_.value(condition.code, slots) != 0;
}

void Semantics::resolve(const program::Condition& condition, std::int32_t* slots, std::vector<Atom>& atoms) {
  for (const Atom& atom : condition.atoms) atoms.push_back(atom);
  for (const program::ComputedConstraint& c : condition.computed) {
    if (c.condition != no_code && machine_.value(c.condition, slots) == 0) continue;
    const std::int64_t left = c.left_code == no_code ? c.left : program_.renumbered(machine_.value(c.left_code, slots));
    const std::int64_t right =
        c.right_code == no_code ? c.right : program_.renumbered(machine_.value(c.right_code, slots));
    const std::int64_t bound = c.bound_code == no_code ? c.bound : machine_.time(c.bound_code, slots);
    if (bound > operations_.largest_constant || bound < -operations_.largest_constant)
      throw machine::ModelFault(machine::FaultKind::bound, c.bound_code);
    const Raw raw = zones::raw_bound(bound, c.strict);
    if (left == right) {  // x - x < c, possible where the clocks are computed
      atoms.push_back({0, 0, raw});
      continue;
    }
    atoms.push_back({static_cast<std::uint16_t>(left), static_cast<std::uint16_t>(right), raw});
  }
}

ConstZoneRef Semantics::narrowed(ConstZoneRef zone, std::size_t level, std::span<const Atom> atoms) {
  if (atoms.empty()) return zone;
  const int dimension = program_.dimension();
  if (!operations_.meets_each(zone, dimension, atoms.data(), atoms.size())) return {};
  while (levels_.size() <= level) levels_.emplace_back(operations_);
  levels_[level].assign(zone);
  const zones::ZoneRef rest = levels_[level].get();
  return operations_.intersect(rest, dimension, atoms.data(), atoms.size()) ? rest : ConstZoneRef{};
}

ConstZoneRef Semantics::guarded(const Edge& edge, std::int32_t* slots, ConstZoneRef zone, std::size_t level) {
  const std::size_t before = action_.guard.size();
  resolve(edge.guard, slots, action_.guard);
  return narrowed(zone, level, std::span(action_.guard).subspan(before));
}

std::int32_t Semantics::channel_of(const Edge& edge, std::int32_t* slots) {
  return edge.channel_code == no_code ? edge.channel
                                      : static_cast<std::int32_t>(machine_.value(edge.channel_code, slots));
}

bool Semantics::names_within(const Edge& edge, std::int32_t channel, std::int32_t* slots, ConstZoneRef zone,
                             std::size_t level) {
  const std::size_t before = action_.guard.size();
  const bool open = static_cast<bool>(guarded(edge, slots, zone, level));
  action_.guard.resize(before);
  return open && names(edge, channel, slots);
}

bool Semantics::invariant(std::int32_t* slots, std::vector<Atom>& atoms) {
  for (std::size_t p = 0; p < program_.processes.size(); ++p) {
    const Location& here = location(p, slots);
    if (!here.has_invariant) continue;
    if (!holds(here.invariant, slots)) return false;
    resolve(here.invariant, slots, atoms);
  }
  return true;
}

bool Semantics::apply(const Edges& edges, const std::int32_t* slots, Effect& effect) {
  if (effect.slots.empty())
    effect.slots.assign(slots, slots + program_.slots.size());
  else  // what lies behind the state is constant, or written before it is read
    std::copy_n(slots, program_.state_slots, effect.slots.begin());
  effect.written = {};
  effect.resets.clear();
  effect.invariant.clear();
  for (const std::uint32_t number : edges) {
    const program::Update& update = program_.edges[number].update;
    for (const program::Update::Store& store : update.stores) {
      effect.slots[store.slot] = store.value;
      effect.written.add(store.slot);
    }
    effect.resets.insert(effect.resets.end(), update.resets.begin(), update.resets.end());
    if (update.code != no_code) machine_.update(update.code, effect.slots.data(), effect.written, effect.resets);
  }
  if (program_.copies_clocks) check_advance(effect.resets);
  for (const std::uint32_t number : edges) {
    const Edge& edge = program_.edges[number];
    effect.slots[edge.process] = edge.target;
    effect.written.add(edge.process);
  }
  for (const std::uint32_t slot : meta_slots_) effect.slots[slot] = program_.slots[slot].initial;
  return invariant(effect.slots.data(), effect.invariant);
}

void Semantics::check_advance(const std::vector<ClockReset>& resets) const {
  Raw advance = 0;
  for (const ClockReset& reset : resets)
    if (reset.source != 0) advance += reset.value;
  if (advance > operations_.largest_constant) throw ConstantOverflow{};
}

bool Semantics::weakest_precondition(const Effect& effect, std::vector<Atom>& atoms) const {
  if (effect.invariant.empty()) return true;
  // The value of each clock afterwards: that of a clock before, and so much more.
  struct After {
    std::uint16_t source;
    Raw value;
  };
  const auto dimension = static_cast<std::uint16_t>(program_.dimension());
  std::vector<After> after;
  after.reserve(dimension);
  for (std::uint16_t clock = 0; clock < dimension; ++clock) after.push_back({clock, 0});
  for (const ClockReset& reset : effect.resets) {
    const After copied = after[reset.source];
    after[reset.clock] = {copied.source, copied.value + reset.value};
  }
  for (Atom atom : effect.invariant) {
    atom.raw -= 2 * (after[atom.left].value - after[atom.right].value);
    atom.left = after[atom.left].source;
    atom.right = after[atom.right].source;
    if (atom.left != atom.right)
      atoms.push_back(atom);
    else if (atom.raw < zones::raw_zero)
      return false;
  }
  return true;
}

bool Semantics::may_be_urgent(const Edge& edge) const {
  const auto first = program_.channels.begin() + edge.channel;
  return std::any_of(first, first + edge.channels, [](const Channel& channel) { return channel.urgent; });
}

bool Semantics::time_passes(std::int32_t* slots) {
  const std::size_t processes = program_.processes.size();
  if (has_urgent_locations_)
    for (std::size_t p = 0; p < processes; ++p)
      if (location(p, slots).urgent || location(p, slots).committed) return false;
  if (!has_urgent_channels_) return true;
  for (std::size_t p = 0; p < processes; ++p) {
    for (const auto& [number, partners] : outgoing(p, slots).sends) {
      const Edge& sender = program_.edges[number];
      if (!may_be_urgent(sender) || !guard_may_hold(number, slots)) continue;
      const std::int32_t channel = channel_of(sender, slots);
      const Channel& kind = program_.channels[static_cast<std::size_t>(channel)];
      if (!kind.urgent) continue;
      if (kind.broadcast) return false;
      for (const std::uint32_t q : partners)
        for (const std::uint32_t other : outgoing(q, slots).receives)
          if (may_receive(other, channel, slots) && names(program_.edges[other], channel, slots)) return false;
    }
  }
  return true;
}

const std::uint8_t* Semantics::stopped_clocks(std::int32_t* slots) {
  if (!program_.has_stopwatches) return nullptr;
  std::fill(stopped_.begin(), stopped_.end(), std::uint8_t{0});
  for (std::size_t p = 0; p < program_.processes.size(); ++p)
    for (const Location::Stop& stop : location(p, slots).stopped)
      if (stop.code == no_code || machine_.value(stop.code, slots) == 0) stopped_[stop.clock] = 1;
  return stopped_.data();
}

std::pair<std::int32_t, std::int32_t> Semantics::priority(const Edges& edges, std::int32_t* slots) {
  const Edge& first = program_.edges[edges.front()];
  const std::int32_t channel = first.internal()
                                   ? program_.default_priority
                                   : program_.channels[static_cast<std::size_t>(channel_of(first, slots))].priority;
  std::int32_t process = program_.processes[first.process].priority;
  for (const std::uint32_t number : edges)
    process = std::max(process, program_.processes[program_.edges[number].process].priority);
  return {channel, process};
}

void Semantics::for_each_action(std::int32_t* slots, zones::ConstZoneRef zone, Visit visit,
                                Callback<bool(std::size_t)> skips) {
  const std::size_t processes = program_.processes.size();
  receiving_.clear();
  int most = 0;
  if (has_committed_locations_)
    for (std::size_t p = 0; p < processes; ++p) most = std::max(most, location(p, slots).commitment());

  for (std::size_t p = 0; p < processes; ++p) {
    const bool goes = location(p, slots).may_go(most);
    const Outgoing& out = outgoing(p, slots);
    if (goes && !skips(p)) {
      for (const std::uint32_t number : out.internal) {
        const program::Edge& edge = program_.edges[number];
        if (!guard_may_hold(number, slots)) continue;
        action_.edges.assign(1, number);
        action_.guard.clear();
        if (const zones::ConstZoneRef rest = guarded(edge, slots, zone, 0)) visit(action_, rest);
      }
    }
    for (const auto& [number, partners] : out.sends) {
      const program::Edge& sender = program_.edges[number];
      if (!guard_may_hold(number, slots)) continue;
      action_.edges.assign(1, number);
      action_.guard.clear();
      const zones::ConstZoneRef sent = guarded(sender, slots, zone, 0);
      if (!sent) continue;
      const std::int32_t channel = channel_of(sender, slots);
      if (program_.channels[static_cast<std::size_t>(channel)].broadcast) {
        broadcast(partners, channel, most, goes, slots, sent, 1, visit);
        continue;
      }
      const std::size_t sender_atoms = action_.guard.size();
      for (const std::uint32_t q : partners) {
        if (!goes && !location(q, slots).may_go(most)) continue;
        for (const std::uint32_t other : outgoing(q, slots).receives) {
          if (!may_receive(other, channel, slots)) continue;
          const program::Edge& partner = program_.edges[other];
          action_.edges.resize(1);
          action_.edges.push_back(other);
          action_.guard.resize(sender_atoms);
          const zones::ConstZoneRef rest = guarded(partner, slots, sent, 1);
          if (rest && names(partner, channel, slots)) visit(action_, rest);
        }
      }
    }
  }
}

// Extends the broadcast action by those of the receivers, which are processes, that take part. A process with an
// enabled receiving edge must take part; where that depends on clocks the valuations are split. `zone` is what the
// guards so far leave, so combinations that exclude each other are given up at once. `participates`: the committed rule
// lets a participant go.
void Semantics::broadcast(std::span<const std::uint32_t> receivers, std::int32_t channel, int most, bool participates,
                          std::int32_t* slots, zones::ConstZoneRef zone, std::size_t level, Visit visit) {
  const std::size_t first = receiving_.size();
  bool must_join = false;  // some receiver has no clock guard
  std::uint32_t receiver = 0;
  for (; !receivers.empty() && receiving_.size() == first; receivers = receivers.subspan(1)) {
    receiver = receivers.front();
    for (const std::uint32_t number : outgoing(receiver, slots).receives) {
      if (!may_receive(number, channel, slots)) continue;
      const program::Edge& receiving_edge = program_.edges[number];
      if (receiving_edge.channel_code != program::no_code && !names_within(receiving_edge, channel, slots, zone, level))
        continue;
      receiving_.push_back(number);
      must_join |= !receiving_edge.guard.constrains_clocks();
    }
  }
  const std::size_t last = receiving_.size();
  if (first == last) {
    if (participates) visit(action_, zone);
    return;
  }
  const std::size_t atoms = action_.guard.size();
  const bool joined = participates || location(receiver, slots).may_go(most);
  std::vector<std::vector<zones::Atom>> guards;
  for (std::size_t n = first; n < last; ++n) {
    const std::uint32_t number = receiving_[n];
    action_.edges.push_back(number);
    const zones::ConstZoneRef rest = guarded(program_.edges[number], slots, zone, level);
    if (!must_join)
      guards.emplace_back(action_.guard.begin() + static_cast<std::ptrdiff_t>(atoms), action_.guard.end());
    if (rest) broadcast(receivers, channel, most, joined, slots, rest, level + 1, visit);
    action_.edges.pop_back();
    action_.guard.resize(atoms);
  }
  if (!must_join)
    stay_out(guards, 0, zone, level, [&](zones::ConstZoneRef rest, std::size_t next_level) {
      broadcast(receivers, channel, most, participates, slots, rest, next_level, visit);
    });
  receiving_.resize(first);
}

// Calls visit(rest, level) for each of the disjoint parts of the zone that together make up where none of the guards
// holds.
void Semantics::stay_out(const std::vector<std::vector<zones::Atom>>& guards, std::size_t next,
                         zones::ConstZoneRef zone, std::size_t level,
                         Callback<void(zones::ConstZoneRef, std::size_t)> visit) {
  if (next == guards.size()) {
    visit(zone, level);
    return;
  }
  const std::size_t atoms = action_.guard.size();
  zones::ConstZoneRef inside = zone;  // where the atoms before the current one hold
  for (const zones::Atom& atom : guards[next]) {
    const zones::Atom outside = zones::negated(atom);
    action_.guard.push_back(outside);
    if (const zones::ConstZoneRef rest = narrowed(inside, level, {&outside, 1}))
      stay_out(guards, next + 1, rest, level + 1, visit);
    action_.guard.back() = atom;
    inside = narrowed(inside, level, {&atom, 1});
    if (!inside) break;
    ++level;
  }
  action_.guard.resize(atoms);
}

}  // namespace tachk::symbolic
