// The zone graph without the states in which a predicate holds: steps end before it becomes true.
#pragma once

#include <cstdint>
#include <vector>

#include "liveness/avoidance.hpp"
#include "liveness/predicate.hpp"
#include "symbolic/zone_graph.hpp"

namespace tachk {

class Restriction final {
 public:
  Restriction(ZoneGraph& graph, const Goal& avoided)
      : graph_(graph),
        avoided_(avoided, graph.semantics(), graph.operations()),
        avoidance_(graph.semantics(), graph.operations()) {}

  Predicate& avoided() { return avoided_; }

  // Of a step, before time has passed: whether the predicate does not depend on clocks there and is false, so that the
  // step goes on as always. Else calls take(successor) for each part of what the step leads to. Throws ModelFault,
  // ConstantOverflow.
  template <class Take>
  bool lets_through(const Successor& entry, const std::vector<Atom>& invariant, Take&& take) {
    switch (avoided_.in(entry.slots, entry.zone)) {
      case Truth::never:
        return true;
      case Truth::always:
        return false;
      case Truth::by_clocks:
        break;
    }
    parts(entry, invariant, take);
    return false;
  }

  // Calls take(successor) for each part of what an entry becomes by delays that avoid the predicate, which has been
  // looked at in this discrete state. Throws ModelFault, ConstantOverflow.
  template <class Take>
  void parts(const Successor& entry, const std::vector<Atom>& invariant, Take&& take) {
    const Federation& pieces = avoidance_.after_delay(entry.slots, entry.zone, invariant, avoided_);
    for (std::size_t number = 0; number < pieces.size(); ++number) {
      ZoneBuffer piece(graph_.operations());
      piece.assign(pieces[number]);
      graph_.abstract(entry.slots, piece, [&](ConstZoneRef zone) { take(Successor{entry.edges, entry.slots, zone}); });
    }
  }

 private:
  ZoneGraph& graph_;
  Predicate avoided_;
  Avoidance avoidance_;
};

}  // namespace tachk
