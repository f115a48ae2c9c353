#include "certificates/closed_set.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "machine/machine.hpp"

namespace tachk {
namespace {

constexpr Raw unbounded = Raw{1} << 60;
constexpr Raw largest_constant = Raw{1} << 40;
constexpr std::int64_t any_rank = std::numeric_limits<std::int64_t>::max();

Raw sum(Raw a, Raw b) { return a >= unbounded || b >= unbounded ? unbounded : a + b - ((a | b) & 1); }

using Constraints = std::vector<Atom>;

// ---- zones ----------------------------------------------------------------------------------------------------------

// A canonical difference bound matrix over `n` clocks, or no valuation at all (no entries).
struct Zone {
  std::size_t n = 0;
  std::vector<Raw> entries;

  static Zone filled(std::size_t n, Raw raw) { return {n, std::vector<Raw>(n * n, raw)}; }
  static Zone universe(std::size_t n) {
    Zone zone = filled(n, unbounded);
    for (std::size_t i = 0; i < n; ++i) zone.at(0, i) = zone.at(i, i) = raw_zero;
    return zone;
  }
  bool empty() const { return entries.empty(); }
  Raw& at(std::size_t i, std::size_t j) { return entries[i * n + j]; }
  Raw at(std::size_t i, std::size_t j) const { return entries[i * n + j]; }

  // Entries that are longer than the way over the new one become that way. No entry that is read on it changes.
  void tighten(const Atom& atom) {
    if (empty() || atom.raw >= at(atom.left, atom.right)) return;
    if (sum(atom.raw, at(atom.right, atom.left)) < raw_zero) return entries.clear();
    for (std::size_t i = 0; i < n; ++i)
      if (const Raw there = sum(at(i, atom.left), atom.raw); there < unbounded)
        for (std::size_t j = 0; j < n; ++j) at(i, j) = std::min(at(i, j), sum(there, at(atom.right, j)));
  }
  Zone within(const Constraints& constraints) const {
    Zone part = *this;
    for (const Atom& atom : constraints) part.tighten(atom);
    return part;
  }
  // The rest of the zone outside of the constraints, in disjoint pieces.
  void without(const Constraints& constraints, std::vector<Zone>& pieces) const {
    Zone rest = *this;
    for (const Atom& atom : constraints) {
      if (rest.empty()) return;
      if (atom.raw >= rest.at(atom.left, atom.right)) continue;
      if (Zone outside = rest.within({negated(atom)}); !outside.empty()) pieces.push_back(std::move(outside));
      rest.tighten(atom);
    }
  }
  Constraints constraints() const {
    Constraints found;
    for (std::size_t k = 0; k < entries.size(); ++k)
      if (k / n != k % n && entries[k] < unbounded)
        found.push_back({static_cast<std::uint16_t>(k / n), static_cast<std::uint16_t>(k % n), entries[k]});
    return found;
  }
  void reset(const ClockReset& reset) {
    const std::size_t x = reset.clock;
    for (std::size_t j = 0; j < n; ++j) at(x, j) = sum(raw_bound(reset.value, false), at(0, j));
    for (std::size_t j = 0; j < n; ++j) at(j, x) = sum(at(j, 0), raw_bound(-Raw{reset.value}, false));
    at(x, x) = raw_zero;
  }
  // What is reached when time passes; the smallest such zone if clocks stand still (Floyd and Warshall).
  void go_on(const std::vector<bool>& stands) {
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        if (!stands[i] && stands[j]) at(i, j) = unbounded;
    if (std::count(stands.begin(), stands.end(), true) == 1) return;  // only the reference clock: canonical
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) at(i, j) = std::min(at(i, j), sum(at(i, k), at(k, j)));
  }
  // From where the zone is reached when time passes.
  void go_back() {
    for (std::size_t j = 1; j < n && !empty(); ++j) {
      at(0, j) = raw_zero;
      for (std::size_t i = 1; i < n; ++i) at(0, j) = std::min(at(0, j), at(i, j));
    }
  }
};

}  // namespace

// ---- the network ----------------------------------------------------------------------------------------------------

class ClosedSet::Checker {
 public:
  using State = std::vector<std::int32_t>;  // all slots; those of frames have no meaning
  struct Group {
    State discrete;
    std::vector<Constraints> zones;
    std::vector<std::int64_t> ranks;
  };
  struct Step {
    std::vector<std::uint32_t> edges;
    Zone guarded;  // where the guards hold
    State target;
    std::vector<ClockReset> resets;
    Constraints invariant;  // of the target
  };
  struct Hash {
    std::size_t operator()(const State& state) const {
      std::uint64_t hash = state.size();
      for (const std::int32_t number : state) hash = (hash ^ static_cast<std::uint32_t>(number)) * 0x9E3779B97F4A7C15u;
      return static_cast<std::size_t>(hash ^ hash >> 32);
    }
  };

  Checker(Program given, Claim claimed)
      : program(std::move(given)),
        claim(claimed),
        machine(program, largest_constant),
        n(static_cast<std::size_t>(program.dimension())) {
    for (const Goal& goal : program.goals)
      for (const Disjunct& disjunct : goal.disjuncts) asks_deadlock |= disjunct.deadlock != DeadlockLiteral::absent;
    for (const Process& process : program.processes) {
      first_location.push_back(leaving_location.size());
      leaving_location.resize(leaving_location.size() + process.locations.size());
    }
    for (std::uint32_t number = 0; number < program.edges.size(); ++number) {
      const Edge& edge = program.edges[number];
      leaving_location[first_location[edge.process] + static_cast<std::size_t>(edge.source)].push_back(number);
    }
    for (const Channel& channel : program.channels) has_urgent_channels |= channel.urgent;
  }

  const Location& location(std::size_t process, const State& state) const {
    return program.processes[process].locations[static_cast<std::size_t>(state[process])];
  }
  const std::vector<std::uint32_t>& leaving(std::size_t process, const State& state) const {
    return leaving_location[first_location[process] + static_cast<std::size_t>(state[process])];
  }
  // Whether the integer part of a condition holds; then its clock constraints are appended.
  bool holds(const Condition& condition, State& state, Constraints& constraints) {
    for (const Test& test : condition.tests)
      if (!test.holds(state.data())) return false;
    if (condition.code != no_code && machine.value(condition.code, state.data()) == 0) return false;
    constraints.insert(constraints.end(), condition.atoms.begin(), condition.atoms.end());
    const auto number = [&](std::int32_t code, std::int64_t given) {
      return code == no_code ? given : machine.value(code, state.data());
    };
    for (const ComputedConstraint& each : condition.computed) {
      if (number(each.condition, 1) == 0) continue;
      const auto left = static_cast<std::uint16_t>(number(each.left_code, each.left));
      const auto right = static_cast<std::uint16_t>(number(each.right_code, each.right));
      const std::int64_t bound = number(each.bound_code, each.bound);
      if (std::abs(bound) > largest_constant) throw ModelFault(FaultKind::bound, each.bound_code);
      constraints.push_back({left, right, raw_bound(bound, each.strict)});
    }
    return true;
  }
  bool invariant(State& state, Constraints& constraints) {
    for (std::size_t p = 0; p < program.processes.size(); ++p)
      if (!holds(location(p, state).invariant, state, constraints)) return false;
    return true;
  }
  std::int32_t channel(const Edge& edge, State& state) {
    if (edge.channel_code == no_code) return edge.channel;
    return static_cast<std::int32_t>(machine.value(edge.channel_code, state.data()));
  }
  bool hears(const Edge& edge, std::int32_t used, State& state) {
    return !edge.internal() && !edge.sends && edge.may_name(used) && channel(edge, state) == used;
  }

  // In an urgent or committed location, and where an urgent channel can be used; edges over one compare no clocks.
  bool time_stands_still(State& state) {
    const std::size_t processes = program.processes.size();
    for (std::size_t p = 0; p < processes; ++p)
      if (location(p, state).urgent || location(p, state).committed) return true;
    for (std::size_t p = 0; p < processes && has_urgent_channels; ++p)
      for (const std::uint32_t number : leaving(p, state)) {
        const Edge& sender = program.edges[number];
        Constraints ignored;
        if (sender.internal() || !sender.sends || !names_urgent(sender) || !holds(sender.guard, state, ignored))
          continue;
        const std::int32_t used = channel(sender, state);
        const Channel& kind = program.channels[static_cast<std::size_t>(used)];
        if (kind.urgent && kind.broadcast) return true;
        for (std::size_t q = 0; q < processes && kind.urgent; ++q)
          for (const std::uint32_t other : leaving(q, state))
            if (const Edge& edge = program.edges[other];
                q != p && edge.may_name(used) && holds(edge.guard, state, ignored) && hears(edge, used, state))
              return true;
      }
    return false;
  }
  bool names_urgent(const Edge& edge) const {
    const auto first = program.channels.begin() + edge.channel;
    return std::any_of(first, first + edge.channels, [](const Channel& channel) { return channel.urgent; });
  }
  // The clocks that stand still, the reference clock among them.
  std::vector<bool> standing(State& state) {
    std::vector<bool> stands(n, false);
    stands[0] = true;
    for (std::size_t p = 0; p < program.processes.size(); ++p)
      for (const Location::Stop& stop : location(p, state).stopped)
        if (stop.code == no_code || machine.value(stop.code, state.data()) == 0) stands[stop.clock] = true;
    return stands;
  }
  Zone delayed(Zone zone, State& state, const Constraints& limits) {
    if (zone.empty() || time_stands_still(state)) return zone;
    zone.go_on(standing(state));
    return zone.within(limits);
  }

  // ---- its actions --------------------------------------------------------------------------------------------------

  void find_steps(State& state, const Zone& zone) {
    steps.clear();
    committed = false;
    for (std::size_t p = 0; p < program.processes.size(); ++p) committed |= location(p, state).committed;
    for (std::size_t p = 0; p < program.processes.size(); ++p)
      for (const std::uint32_t number : leaving(p, state)) {
        const Edge& edge = program.edges[number];
        const bool free = !committed || location(p, state).committed;
        if (edge.internal() ? !free : !edge.sends) continue;
        const Zone guarded = where(edge, state, zone);
        if (guarded.empty()) continue;
        taking_part.assign(1, number);
        if (edge.internal()) {
          add_step(state, guarded);
          continue;
        }
        const std::int32_t used = channel(edge, state);
        if (program.channels[static_cast<std::size_t>(used)].broadcast)
          add_receivers(state, 0, used, guarded, free);
        else
          add_partner(state, used, guarded, free);
      }
  }
  Zone where(const Edge& edge, State& state, const Zone& zone) {
    Constraints guard;
    return holds(edge.guard, state, guard) ? zone.within(guard) : Zone{};
  }
  void add_partner(State& state, std::int32_t used, const Zone& zone, bool free) {
    const std::size_t sender = program.edges[taking_part[0]].process;
    for (std::size_t q = 0; q < program.processes.size(); ++q)
      for (const std::uint32_t number : leaving(q, state)) {
        const Edge& edge = program.edges[number];
        if (q == sender || !edge.may_name(used) || (!free && !location(q, state).committed)) continue;
        const Zone guarded = where(edge, state, zone);
        if (guarded.empty() || !hears(edge, used, state)) continue;
        taking_part.resize(1);
        taking_part.push_back(number);
        add_step(state, guarded);
      }
  }
  // A process that can hear a broadcast does, by any of its edges whose guard holds; else it stays out.
  void add_receivers(State& state, std::size_t q, std::int32_t used, const Zone& zone, bool free) {
    if (q == program.processes.size()) {
      if (free) add_step(state, zone);
      return;
    }
    std::vector<Zone> staying{zone};
    if (q != program.edges[taking_part[0]].process)
      for (const std::uint32_t number : leaving(q, state)) {
        const Edge& edge = program.edges[number];
        if (edge.internal() || edge.sends || !edge.may_name(used)) continue;
        Constraints guard;
        if (!holds(edge.guard, state, guard)) continue;
        const Zone guarded = zone.within(guard);
        if (guarded.empty() || !hears(edge, used, state)) continue;
        taking_part.push_back(number);
        add_receivers(state, q + 1, used, guarded, free || location(q, state).committed);
        taking_part.pop_back();
        std::vector<Zone> rest;
        for (const Zone& piece : staying) piece.without(guard, rest);
        staying = std::move(rest);
      }
    for (const Zone& piece : staying) add_receivers(state, q + 1, used, piece, free);
  }
  void add_step(const State& state, const Zone& guarded) {
    Step step{taking_part, guarded, state, {}, {}};
    SlotSet ignored;
    for (const std::uint32_t number : taking_part) {
      const Update& update = program.edges[number].update;
      for (const Update::Store& store : update.stores) step.target[store.slot] = store.value;
      step.resets.insert(step.resets.end(), update.resets.begin(), update.resets.end());
      if (update.code != no_code) machine.update(update.code, step.target.data(), ignored, step.resets);
    }
    for (const std::uint32_t number : taking_part)
      step.target[program.edges[number].process] = program.edges[number].target;
    for (std::size_t slot = 0; slot < program.state_slots; ++slot)
      if (program.slots[slot].meta) step.target[slot] = program.slots[slot].initial;
    if (invariant(step.target, step.invariant)) steps.push_back(std::move(step));
  }
  // Where in the source a step is possible: its resets lead into the invariant of the target.
  Zone possible(const Step& step) const {
    std::vector<std::int64_t> value(n, -1);
    for (const ClockReset& reset : step.resets) value[reset.clock] = reset.value;
    Zone zone = step.guarded;
    for (Atom atom : step.invariant) {
      if (value[atom.left] >= 0) atom.raw -= 2 * value[std::exchange(atom.left, std::uint16_t{0})];
      if (value[atom.right] >= 0) atom.raw += 2 * value[std::exchange(atom.right, std::uint16_t{0})];
      zone.tighten(atom);
    }
    return zone;
  }
  std::pair<std::int32_t, std::int32_t> priority(const Step& step, State& state) {
    const Edge& first = program.edges[step.edges[0]];
    const std::int32_t used = first.internal() ? -1 : channel(first, state);
    std::int32_t process = program.processes[first.process].priority;
    for (const std::uint32_t number : step.edges)
      process = std::max(process, program.processes[program.edges[number].process].priority);
    return {used < 0 ? program.default_priority : program.channels[static_cast<std::size_t>(used)].priority, process};
  }
  // The parts of the guarded zone in which nothing of higher priority is possible.
  std::vector<Zone> unblocked(const Step& step, State& state) {
    std::vector<Zone> pieces{step.guarded};
    for (const Step& other : steps) {
      if (!program.has_priorities || priority(other, state) <= priority(step, state)) continue;
      const Zone blocker = possible(other);
      if (blocker.empty()) continue;
      std::vector<Zone> rest;
      for (const Zone& piece : pieces) piece.without(blocker.constraints(), rest);
      pieces = std::move(rest);
    }
    return pieces;
  }

  // ---- the check ----------------------------------------------------------------------------------------------------

  bool satisfies_goal(State& state, const Zone& zone) {
    for (const Goal& goal : program.goals)
      for (const Disjunct& disjunct : goal.disjuncts) {
        Constraints constraints;
        if (!holds(disjunct.condition, state, constraints)) continue;
        const Zone met = zone.within(constraints);
        if (!met.empty() && (disjunct.deadlock == DeadlockLiteral::absent || meets_deadlock(disjunct, state, met)))
          return true;
      }
    return false;
  }
  // Where clocks are stopped the past of a zone is none, and either answer may be given too often. `steps` are those of
  // the zone and of what it becomes by waiting.
  bool meets_deadlock(const Disjunct& disjunct, State& state, const Zone& met) {
    const std::vector<bool> stands = standing(state);
    const bool stopped = std::count(stands.begin(), stands.end(), true) > 1;
    const bool waits = !time_stands_still(state);
    if (disjunct.deadlock == DeadlockLiteral::required) return gets_stuck(state, met);
    return std::any_of(steps.begin(), steps.end(), [&](const Step& step) {
      Zone alive = possible(step);
      if (alive.empty() || (waits && stopped)) return !alive.empty();
      if (waits) alive.go_back();
      return !met.within(alive.constraints()).empty();
    });
  }
  // Whether from some valuation no step is possible, now or later.
  bool gets_stuck(State& state, const Zone& zone) {
    const std::vector<bool> stands = standing(state);
    const bool goes_back = !time_stands_still(state) && std::count(stands.begin(), stands.end(), true) == 1;
    std::vector<Zone> dead{zone};
    for (const Step& step : steps) {
      Zone alive = possible(step);
      if (alive.empty()) continue;
      if (goes_back) alive.go_back();
      std::vector<Zone> rest;
      for (const Zone& piece : dead) piece.without(alive.constraints(), rest);
      dead = std::move(rest);
    }
    return !dead.empty();
  }
  // By one zone of the set, as a rule, else by several together: of the rank 0, or ranked ones below a rank.
  bool covered(const State& state, const Zone& zone, std::int64_t below) const {
    if (zone.empty()) return true;
    const auto& index = numbers[below > 0];
    const auto found = index.find({state.begin(), state.begin() + program.state_slots});
    if (found == index.end()) return false;
    const Group& group = groups[found->second];
    const auto counts = [&](std::size_t number) { return below == 0 || group.ranks[number] < below; };
    for (std::size_t number = 0; number < group.zones.size(); ++number)
      if (const Constraints& held = group.zones[number];
          counts(number) && std::all_of(held.begin(), held.end(),
                                        [&](const Atom& atom) { return zone.at(atom.left, atom.right) <= atom.raw; }))
        return true;
    std::vector<Zone> rest{zone};
    for (std::size_t number = 0; number < group.zones.size(); ++number) {
      if (!counts(number)) continue;
      std::vector<Zone> outside;
      for (const Zone& piece : rest) piece.without(group.zones[number], outside);
      rest = std::move(outside);
    }
    return rest.empty();
  }
  // Whether nothing is asked of ranked elements of a discrete state, because it satisfies what each run must meet.
  bool is_met(State& state) {
    bool depends = false;
    for (const Disjunct& disjunct : program.goals[0].disjuncts) {
      Constraints constraints;
      if (!holds(disjunct.condition, state, constraints)) continue;
      if (constraints.empty() && disjunct.deadlock == DeadlockLiteral::absent) return true;
      depends = true;
    }
    if (depends) throw Objection{"the goal depends on clocks", {}, 0, {}};
    return false;
  }
  // From where the goal must be met, and what that becomes by waiting, there are ranked elements.
  void check_beginnings(State& state, const Zone& zone, const Constraints& limits) {
    if (is_met(state)) return;
    for (const Disjunct& disjunct : program.goals[1].disjuncts) {
      Constraints constraints;
      if (!holds(disjunct.condition, state, constraints)) continue;
      if (disjunct.deadlock != DeadlockLiteral::absent ||
          !covered(state, delayed(zone.within(constraints), state, limits), any_rank))
        throw Objection{"it is not shown that the goal is met from here", {}, 0, {}};
    }
  }
  // Time cannot pass for ever in ranked elements, and some step stays possible. `later` is what the zone becomes.
  void check_ends(State& state, const Zone& zone, const Zone& later) {
    const std::vector<bool> stands = standing(state);
    bool for_ever = !time_stands_still(state);
    for (std::size_t i = 0; i < n; ++i) for_ever &= stands[i] || later.at(i, 0) >= unbounded;
    if (for_ever) throw Objection{"time can pass for ever, and the goal is not met", {}, 0, {}};
    if (gets_stuck(state, zone))
      throw Objection{"nothing can happen any more in some state, and the goal is not met", {}, 0, {}};
  }
  bool check_initial() {
    State state;
    for (const Slot& slot : program.slots) state.push_back(slot.initial);
    Constraints limits;
    const bool ranked = claim == Claim::inevitable && program.goals.size() == 1;
    if (invariant(state, limits) && !(ranked && is_met(state)) &&
        !covered(state, delayed(Zone::filled(n, raw_zero).within(limits), state, limits), ranked ? any_rank : 0))
      objection = Objection{"the initial state is not in the set", {}, 0, {}};
    return !objection;
  }
  void check_zone(State& state, const Zone& zone, const Constraints& limits, std::int64_t rank) {
    if (rank > 0 && is_met(state)) return;
    // What is possible later counts for deadlock and for ends, in the zone or not.
    const Zone later = rank > 0 || asks_deadlock ? delayed(zone, state, limits) : zone;
    find_steps(state, later);
    if (rank > 0) check_ends(state, zone, later);
    if (claim == Claim::unreachable && satisfies_goal(state, zone))
      throw Objection{"some state of the zone is one that must not be reached", {}, 0, {}};
    if (claim == Claim::inevitable && rank == 0 && program.goals.size() > 1) check_beginnings(state, zone, limits);
    if (later.entries != zone.entries) find_steps(state, zone);
    for (Step& step : steps) {
      if (rank > 0 && is_met(step.target)) continue;
      for (Zone& piece : unblocked(step, state)) {
        for (const ClockReset& reset : step.resets) piece.reset(reset);
        piece = piece.within(step.invariant);
        if (!covered(step.target, delayed(std::move(piece), step.target, step.invariant), rank))
          throw Objection{"a successor is not in the set", {}, 0, step.edges};
      }
    }
  }
  void check_group(const Group& group) {
    State state = group.discrete;
    for (std::size_t slot = program.state_slots; slot < program.slots.size(); ++slot)
      state.push_back(program.slots[slot].initial);
    for (std::size_t number = 0; number < group.zones.size() && !objection; ++number) {
      Constraints limits;
      taking_part.clear();
      try {
        if (!invariant(state, limits)) return;
        const Zone zone = Zone::universe(n).within(group.zones[number]).within(limits);
        if (!zone.empty()) check_zone(state, zone, limits, group.ranks[number]);
      } catch (const Objection& found) {
        objection = found;
      } catch (const ModelFault&) {
        objection = Objection{"something in the model cannot be evaluated", {}, 0, taking_part};
      }
      if (objection) std::tie(objection->discrete, objection->zone) = std::tie(group.discrete, number);
    }
  }

  Program program;
  Claim claim;
  bool asks_deadlock = false;
  Machine machine;
  std::size_t n;  // clocks, the reference clock included
  std::vector<std::size_t> first_location;
  std::vector<std::vector<std::uint32_t>> leaving_location;  // the edges
  bool has_urgent_channels = false;
  std::vector<Group> groups;
  // Of the groups, by discrete state: of those of the rank 0, and of the ranked ones.
  std::array<std::unordered_map<State, std::size_t, Hash>, 2> numbers;
  std::size_t next = 0;
  std::vector<Step> steps;  // of the zone at hand
  bool committed = false;
  std::vector<std::uint32_t> taking_part;  // in the action under construction
  std::optional<Objection> objection;
};

ClosedSet::ClosedSet(Program program, Claim claim) : checker_(std::make_unique<Checker>(std::move(program), claim)) {}
ClosedSet::~ClosedSet() = default;

void ClosedSet::add(std::span<const std::int64_t> discrete, std::span<const std::int64_t> ranks,
                    std::span<const std::int64_t> counts, std::span<const std::int64_t> places,
                    std::span<const std::int64_t> bounds) {
  const Program& program = checker_->program;
  const std::size_t n = checker_->n;
  if (discrete.size() != program.state_slots) throw std::invalid_argument("a discrete state has the wrong length");
  for (std::size_t slot = 0; slot < discrete.size(); ++slot)
    if (discrete[slot] < program.slots[slot].low || discrete[slot] > program.slots[slot].high)
      throw std::invalid_argument("a discrete state has a value out of its range");
  Checker::Group group{{discrete.begin(), discrete.end()}, {}, {ranks.begin(), ranks.end()}};
  const auto unranked = static_cast<std::size_t>(std::count(ranks.begin(), ranks.end(), 0));
  if (ranks.size() != counts.size() || (unranked != 0 && unranked != ranks.size()) ||
      std::any_of(ranks.begin(), ranks.end(), [](std::int64_t rank) { return rank < 0; }))
    throw std::invalid_argument("ranks that cannot be");
  std::size_t at = 0;
  for (const std::int64_t count : counts) {
    if (count < 0 || static_cast<std::size_t>(count) > places.size() - at) throw std::invalid_argument("a bad count");
    Constraints& zone = group.zones.emplace_back();
    for (const std::size_t end = at + static_cast<std::size_t>(count); at < end; ++at) {
      if (places[at] < 0 || static_cast<std::size_t>(places[at]) >= n * n ||
          std::abs(bounds[at]) > 4 * largest_constant)
        throw std::invalid_argument("a constraint of clocks that do not exist, or one that is too large");
      const auto place = static_cast<std::size_t>(places[at]);
      zone.push_back({static_cast<std::uint16_t>(place / n), static_cast<std::uint16_t>(place % n), bounds[at]});
    }
  }
  if (!checker_->numbers[unranked < ranks.size()].emplace(group.discrete, checker_->groups.size()).second)
    throw std::invalid_argument("a discrete state occurs twice");
  checker_->groups.push_back(std::move(group));
}

bool ClosedSet::check(std::size_t states) {
  Checker& checker = *checker_;
  if (checker.next == 0 && !checker.check_initial()) return true;
  for (; states > 0 && checker.next < checker.groups.size() && !checker.objection; --states)
    checker.check_group(checker.groups[checker.next++]);
  return checker.objection || checker.next == checker.groups.size();
}

const std::optional<Objection>& ClosedSet::objection() const { return checker_->objection; }

}  // namespace tachk
