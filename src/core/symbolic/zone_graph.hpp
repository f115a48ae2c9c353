// The zone graph of a program: its symbolic states, each a discrete state and a zone, and the steps between them. A
// step takes an action somewhere in the zone and then lets time pass; the zone it leads to is abstracted, so that the
// graph is finite. This is all that a search needs to know of the program: which algorithm goes through the graph, and
// which states it keeps, is decided elsewhere.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "program/program.hpp"
#include "states/store.hpp"
#include "symbolic/abstraction.hpp"
#include "symbolic/active_clocks.hpp"
#include "symbolic/equivalent_processes.hpp"
#include "symbolic/receiver.hpp"
#include "symbolic/representative.hpp"
#include "symbolic/successor.hpp"
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

// A run-time error in an action of the state that is being expanded. Where it is a ModelFault only, it is one of the
// state itself.
struct ActionFault : machine::ModelFault {
  ActionFault(const machine::ModelFault& fault, std::span<const std::uint32_t> action)
      : machine::ModelFault(fault), edges(action.begin(), action.end()) {}

  Edges edges;
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

  // Lets other states be the initial ones: those that a path leads to. Not where processes are interchangeable.
  void begin_at(std::optional<std::vector<SymbolicState>> states) { beginnings_ = std::move(states); }
  const std::optional<std::vector<SymbolicState>>& beginnings() const { return beginnings_; }
  // The successors that no action leads to: the initial states. Throws ModelFault, ConstantOverflow.
  template <class R>
  void start(R&& receiver) {
    ReceiverReference<std::remove_reference_t<R>> reference(receiver);
    start_for(reference);
  }

  // The successors of a state, in the order of its actions. Throws ModelFault, ConstantOverflow.
  template <class R>
  void expand(SymbolicState& source, R&& receiver) {
    ReceiverReference<std::remove_reference_t<R>> reference(receiver);
    expand_for(source, reference);
  }

  // Calls take(abstract) for each of the zones that together stand for a zone of a discrete state, which is used up.
  // Throws ConstantOverflow.
  template <class Take>
  void abstract(const std::int32_t* slots, zones::ZoneBuffer& zone, Take&& take) {
    abstraction_.apply(slots, zone, take);
  }

  // Calls take(successor) for an abstract successor, with its processes sorted where they are interchangeable.
  template <class Take>
  void sorted(const Successor& successor, Take&& take) {
    if (!representatives_.active()) return take(successor);
    sorted_slots_.assign(successor.slots, successor.slots + program_.slots.size());
    zones::ZoneBuffer zone(operations_);
    zone.assign(successor.zone);
    representatives_.sort(sorted_slots_.data(), zone);
    take(Successor{successor.edges, sorted_slots_.data(), zone.get()});
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
  void start_for(ReceiverOfSuccessors& receiver);
  void expand_for(SymbolicState& source, ReceiverOfSuccessors& receiver);
  void expand_by_priority(SymbolicState& source, ReceiverOfSuccessors& receiver);
  void follow(std::span<const std::uint32_t> edges, zones::ConstZoneRef guarded, Effect& effect,
              ReceiverOfSuccessors& receiver);
  void follow_sorted(std::span<const std::uint32_t> edges, Effect& effect, ReceiverOfSuccessors& receiver);
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
  std::optional<std::vector<SymbolicState>> beginnings_;  // instead of those of the program
  Effect effect_;
  zones::ZoneBuffer target_;
  std::vector<std::int32_t> sorted_slots_;
  std::uint32_t actions_ = 0;  // that have been visited, for the next check of the time
};

}  // namespace tachk::symbolic
