// The zone graph of a program: its symbolic states, each a discrete state and a zone, and the steps between them. A
// step takes an action somewhere in the zone and then lets time pass; the zone it leads to is abstracted, so that the
// graph is finite. This is all that a search needs to know of the program: which algorithm goes through the graph, and
// which states it keeps, is decided elsewhere.
#pragma once

#include <concepts>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "program/program.hpp"
#include "states/store.hpp"
#include "symbolic/abstraction.hpp"
#include "symbolic/active_clocks.hpp"
#include "symbolic/equivalent_processes.hpp"
#include "symbolic/representative.hpp"
#include "symbolic/successor.hpp"
#include "zones/federation.hpp"
#include "zones/patience.hpp"
#include "zones/zone.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk::symbolic {

// How states are represented.
struct ZoneGraphOptions {
  Extrapolation extrapolation = Extrapolation::lu;
  BoundScope bounds = BoundScope::local;
  zones::Width width = zones::Width::narrow;  // at least
  bool scale = true;
  bool vector = true;
  std::uint32_t pack_clocks = 16;  // zones of more clocks are stored without those that do not matter
};

// A symbolic state of one's own.
struct SymbolicState {
  std::vector<std::int32_t> slots;  // all slots, frame slots included
  zones::ZoneBuffer zone;
};

// A step to a symbolic state, valid during the call that passes it.
struct Successor {
  std::span<const std::uint32_t> edges;  // of the action; none for an initial state
  std::int32_t* slots;
  zones::ConstZoneRef zone;
};

// A run-time error in an action of the state that is being expanded. Where it is a ModelFault only, it is one of the
// state itself.
struct ActionFault : machine::ModelFault {
  ActionFault(const machine::ModelFault& fault, std::span<const std::uint32_t> action)
      : machine::ModelFault(fault), edges(action.begin(), action.end()) {}

  Edges edges;
};

// The receiver of the successors of a state. Where processes are interchangeable, actions that differ by a permutation
// that leaves the state as it is have successors that do, too: the graph reports one of them in full, of the others at
// most that they are possible. For each action it calls these functions of the receiver, in this order:
//   counts()                   optional, called first: whether the receiver needs `possible` for every action
//   admits(edges)              optional: whether the action is followed at all; if not, no other call is made for it
//   possible(guarded, effect)  the action breaks no integer part of an invariant; `guarded`: where its guard holds
//   expect(effect)             the zone of a successor is going to be computed
//   enters(entry, invariant)   optional: whether the step goes on from here, where no time has passed yet; if not, the
//                              receiver has dealt with it. Processes are not sorted yet, so that a receiver that takes
//                              parts of what it is given here is only for programs without interchangeable ones
//   wants(successor)           whether this successor is of interest; its zone is not abstracted yet, because most
//                              successors end here
//   take(successor)            the successor, abstracted
template <class R>
concept Receiver =
    requires(R& receiver, zones::ConstZoneRef guarded, const Effect& effect, const Successor& successor) {
      receiver.possible(guarded, effect);
      receiver.expect(effect);
      { receiver.wants(successor) } -> std::same_as<bool>;
      receiver.take(successor);
    };

class ZoneGraph final {
 public:
  ZoneGraph(program::Program program, const ZoneGraphOptions& options);
  ZoneGraph(const ZoneGraph&) = delete;
  ZoneGraph& operator=(const ZoneGraph&) = delete;

  const program::Program& program() const { return program_; }
  const zones::ZoneOperations& operations() const { return operations_; }
  // Those of each smaller dimension, if zones are stored without clocks that do not matter; else none.
  const std::vector<zones::ZoneOperations>& smaller_operations() const { return smaller_; }
  Semantics& semantics() { return semantics_; }
  // Where processes are interchangeable, successors have them sorted; this gives how that was done for the last one,
  // and whether it is done.
  Representatives& representatives() { return representatives_; }

  // The successors that no action leads to: the initial states. Throws ModelFault, ConstantOverflow.
  template <Receiver R>
  void start(R&& receiver);

  // The successors of a state, in the order of its actions. Throws ModelFault, ConstantOverflow.
  template <Receiver R>
  void expand(SymbolicState& source, R&& receiver);

  // Calls take(abstract) for each of the zones that together stand for a zone of a discrete state, which is used up.
  // Throws ConstantOverflow.
  template <class Take>
  void abstract(const std::int32_t* slots, zones::ZoneBuffer& zone, Take&& take) {
    abstraction_.apply(slots, zone, take);
  }

  // True if a zone may be dropped for one that simulates it where only what can be reached matters: the constants that
  // count are known, and time passes for all clocks alike.
  bool knows_simulation() const {
    return options_.extrapolation != Extrapolation::none && smaller_.empty() && !program_.has_stopwatches &&
           program_.diagonals.empty();
  }
  // The constants that count in a discrete state, until the next call.
  zones::ClockBounds bounds(const std::int32_t* slots) { return abstraction_.bounds(slots); }

  // Memory for a state.
  SymbolicState blank() const;
  SymbolicState copy(const Successor& successor) const;

  // The part of a zone that is worth storing, until the next call, and the zone from that part.
  states::ZoneView packed(const std::int32_t* slots, zones::ConstZoneRef zone) { return active_.packed(slots, zone); }
  void unpack(const std::int32_t* slots, zones::ConstZoneRef packed, zones::ZoneBuffer& zone) {
    active_.unpack(slots, packed, zone);
  }
  // Gives a state the zone of a stored one, whose slots it has.
  void unpack(const states::PassedList& states, std::uint32_t node, SymbolicState& state) {
    active_.unpack(state.slots.data(), states, node, state.zone);
  }

 private:
  // Sets `effect_` to what comes before the first action; false if an invariant excludes it.
  bool begin();
  // Goes from the guarded zone to `target_`, by the resets and the invariant of the effect; false if nothing is left.
  bool enter(zones::ConstZoneRef guarded, const Effect& effect);
  // Lets time pass in `target_`.
  void delay(Effect& effect);
  // Throws GivenUp; checks only now and then.
  void check_patience() {
    constexpr std::uint32_t seldom = 64;
    if (++actions_ % seldom == 0) zones::Patience::check();
  }
  template <Receiver R>
  void expand_by_priority(SymbolicState& source, R& receiver);
  template <Receiver R>
  void follow(std::span<const std::uint32_t> edges, zones::ConstZoneRef guarded, Effect& effect, R& receiver);
  template <Receiver R>
  void follow_sorted(std::span<const std::uint32_t> edges, Effect& effect, R& receiver);
  // The value of the body; names the action in a run-time error.
  template <class Body>
  static bool within(std::span<const std::uint32_t> edges, Body&& body);

  program::Program program_;
  ZoneGraphOptions options_;
  zones::ZoneOperations operations_;
  std::vector<zones::ZoneOperations> smaller_;
  Semantics semantics_;
  ActiveClocks active_;
  Abstraction abstraction_;
  Representatives representatives_;
  EquivalentProcesses equivalent_;
  Effect effect_;
  zones::ZoneBuffer target_;
  std::uint32_t actions_ = 0;  // that have been visited, for the next check of the time
};

// ---- the templates --------------------------------------------------------------------------------------------------

template <Receiver R>
void ZoneGraph::start(R&& receiver) {
  if (!begin()) return;
  zones::ZoneBuffer zero(operations_);
  operations_.make_zero(zero.get(), program_.dimension());
  follow({}, zero.get(), effect_, receiver);
}

template <Receiver R>
void ZoneGraph::expand(SymbolicState& source, R&& receiver) {
  if (program_.has_priorities) return expand_by_priority(source, receiver);
  std::int32_t* slots = source.slots.data();
  const bool sorts = representatives_.active();
  bool counts = true;
  if constexpr (requires { receiver.counts(); }) counts = receiver.counts();
  if (sorts) equivalent_.find(slots, source.zone.get());
  const auto visit = [&](const Action& action, zones::ConstZoneRef guarded) {
    check_patience();
    if constexpr (requires { receiver.admits(action.edges); })
      if (!receiver.admits(action.edges)) return;
    const bool repeats = sorts && equivalent_.repeats(action.edges);
    if (repeats && !counts) return;
    if (!within(action.edges, [&] { return semantics_.apply(action.edges, slots, effect_); })) return;
    receiver.possible(guarded, effect_);
    if (!repeats) follow(action.edges, guarded, effect_, receiver);
  };
  const auto skips = [&](std::size_t process) { return sorts && !counts && equivalent_.second(process); };
  semantics_.for_each_action(slots, source.zone.get(), visit, skips);
}

// An action may only fire in valuations in which no action of higher priority is possible.
template <Receiver R>
void ZoneGraph::expand_by_priority(SymbolicState& source, R& receiver) {
  struct Ranked {
    Edges edges;
    zones::ZoneBuffer guarded;
    std::vector<zones::Atom> possible;  // where the action is possible: guard and precondition of the target invariant
    Effect effect;
    std::pair<std::int32_t, std::int32_t> priority;
  };
  std::int32_t* slots = source.slots.data();
  std::vector<Ranked> actions;
  semantics_.for_each_action(slots, source.zone.get(), [&](const Action& action, zones::ConstZoneRef guarded) {
    check_patience();
    Ranked ranked{action.edges, zones::ZoneBuffer(operations_), action.guard, {}, {}};
    ranked.guarded.assign(guarded);
    if (!within(action.edges, [&] { return semantics_.apply(action.edges, slots, ranked.effect); })) return;
    if (!semantics_.weakest_precondition(ranked.effect, ranked.possible)) return;
    receiver.possible(guarded, ranked.effect);
    ranked.priority = semantics_.priority(action.edges, slots);
    actions.push_back(std::move(ranked));
  });
  for (Ranked& action : actions) {
    zones::Federation first(operations_, program_.dimension());  // where no action of higher priority is possible
    first.add(action.guarded.get());
    for (const Ranked& other : actions)
      if (other.priority > action.priority) first.subtract(other.possible);
    for (std::size_t piece = 0; piece < first.size(); ++piece) {
      check_patience();
      Effect effect = action.effect;
      follow(action.edges, first[piece], effect, receiver);
    }
  }
}

template <Receiver R>
void ZoneGraph::follow(std::span<const std::uint32_t> edges, zones::ConstZoneRef guarded, Effect& effect, R& receiver) {
  if (representatives_.active()) {
    if (enter(guarded, effect)) follow_sorted(edges, effect, receiver);
    return;
  }
  receiver.expect(effect);
  if (!enter(guarded, effect)) return;
  std::int32_t* slots = effect.slots.data();
  if constexpr (requires { receiver.enters(Successor{}, effect.invariant); })
    if (!receiver.enters(Successor{edges, slots, target_.get()}, effect.invariant)) return;
  within(edges, [&] { return delay(effect), true; });
  if (!receiver.wants(Successor{edges, slots, target_.get()})) return;
  abstraction_.apply(slots, target_, [&](zones::ConstZoneRef zone) { receiver.take(Successor{edges, slots, zone}); });
}

// There are no diagonals here, so that a state has one zone.
template <Receiver R>
void ZoneGraph::follow_sorted(std::span<const std::uint32_t> edges, Effect& effect, R& receiver) {
  std::int32_t* slots = effect.slots.data();
  if constexpr (requires { receiver.enters(Successor{}, effect.invariant); })
    if (!receiver.enters(Successor{edges, slots, target_.get()}, effect.invariant)) return;
  within(edges, [&] { return delay(effect), true; });
  abstraction_.apply(slots, target_, [](zones::ConstZoneRef) {});
  representatives_.sort(slots, target_);
  effect.written = program::SlotSet::all();
  receiver.expect(effect);
  const Successor successor{edges, slots, target_.get()};
  if (receiver.wants(successor)) receiver.take(successor);
}

template <class Body>
bool ZoneGraph::within(std::span<const std::uint32_t> edges, Body&& body) {
  try {
    return body();
  } catch (const machine::ModelFault& fault) {
    throw ActionFault(fault, edges);
  }
}

}  // namespace tachk::symbolic
