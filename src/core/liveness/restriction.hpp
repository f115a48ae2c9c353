// The zone graph without the states in which a predicate holds: steps end before it becomes true.
#pragma once

#include <cstdint>
#include <vector>

#include "liveness/avoidance.hpp"
#include "liveness/predicate.hpp"
#include "symbolic/zone_graph.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk::liveness {

class Restriction final {
 public:
  Restriction(symbolic::ZoneGraph& graph, const program::Goal& avoided)
      : graph_(graph),
        avoided_(avoided, graph.semantics(), graph.operations()),
        avoidance_(graph.semantics(), graph.operations()) {}

  Predicate& avoided() { return avoided_; }

  // Of a step, before time has passed: whether the predicate does not depend on clocks there and is false, so that the
  // step goes on as always. Else calls take(successor) for each part of what the step leads to, with its processes
  // sorted, so that its slots may be others than those of the entry. Throws ModelFault, ConstantOverflow.
  template <class Take>
  bool lets_through(const symbolic::Successor& entry, const std::vector<zones::Atom>& invariant, Take&& take) {
    switch (avoided_.in(entry.slots, entry.zone)) {
      case TruthInZone::never:
        return true;
      case TruthInZone::always:
        return false;
      case TruthInZone::by_clocks:
        break;
    }
    parts(entry, invariant, take);
    return false;
  }

  // Calls take(successor) for each part of what an entry becomes by delays that avoid the predicate, which has been
  // looked at in this discrete state. The processes of each part are sorted by itself: permutations keep the predicate,
  // so that a part without runs stays one. Throws ModelFault, ConstantOverflow.
  template <class Take>
  void parts(const symbolic::Successor& entry, const std::vector<zones::Atom>& invariant, Take&& take) {
    const zones::Federation& pieces = avoidance_.after_delay(entry.slots, entry.zone, invariant, avoided_);
    for (std::size_t number = 0; number < pieces.size(); ++number) {
      zones::ZoneBuffer piece(graph_.operations());
      piece.assign(pieces[number]);
      graph_.abstract(entry.slots, piece, [&](zones::ConstZoneRef zone) {
        graph_.sorted(symbolic::Successor{entry.edges, entry.slots, zone}, take);
      });
    }
  }

  // Calls take(successor) for each part of a reached state in which the predicate does not hold, with the delays that
  // avoid it. Throws ModelFault, ConstantOverflow.
  template <class Take>
  void remaining(symbolic::SymbolicState& state, Take&& take) {
    std::int32_t* slots = state.slots.data();
    const symbolic::Successor whole{{}, slots, state.zone.get()};
    switch (avoided_.in(slots, state.zone.get())) {
      case TruthInZone::always:
        return;
      case TruthInZone::never:
        return take(whole);
      case TruthInZone::by_clocks:
        break;
    }
    std::vector<zones::Atom> invariant;
    graph_.semantics().invariant(slots, invariant);
    parts(whole, invariant, take);
  }

  // Calls take(successor) for each part of a reached state in which `begins` holds and the predicate does not, with the
  // delays that avoid the predicate. Throws ModelFault, ConstantOverflow.
  template <class Take>
  void beginnings(Predicate& begins, symbolic::SymbolicState& state, Take&& take) {
    std::int32_t* slots = state.slots.data();
    const TruthInZone begun = begins.in(slots, state.zone.get());
    if (begun == TruthInZone::never) return;
    const TruthInZone avoided = avoided_.in(slots, state.zone.get());
    if (avoided == TruthInZone::always) return;
    if (begun == TruthInZone::always && avoided == TruthInZone::never)
      return take(symbolic::Successor{{}, slots, state.zone.get()});
    const int dimension = graph_.program().dimension();
    std::vector<zones::Atom> invariant;
    graph_.semantics().invariant(slots, invariant);
    const std::size_t count = begun == TruthInZone::always ? 1 : begins.size();
    for (std::size_t number = 0; number < count; ++number) {
      zones::ZoneBuffer entry(state.zone);
      std::vector<zones::Atom> atoms(invariant);
      if (begun == TruthInZone::by_clocks) atoms.insert(atoms.end(), begins[number].begin(), begins[number].end());
      if (!graph_.operations().intersect(entry.get(), dimension, atoms.data(), atoms.size())) continue;
      parts(symbolic::Successor{{}, slots, entry.get()}, invariant, take);
    }
  }

 private:
  symbolic::ZoneGraph& graph_;
  Predicate avoided_;
  Avoidance avoidance_;
};

}  // namespace tachk::liveness
