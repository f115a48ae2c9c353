// Where `deadlock` holds in one discrete state: what a predicate that speaks of it needs, before the state is expanded.
#pragma once

#include <cstdint>
#include <vector>

#include "program/program.hpp"
#include "symbolic/deadlock.hpp"
#include "symbolic/successor.hpp"
#include "zones/federation.hpp"
#include "zones/zone.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk {

class DeadStates final {
 public:
  // Has a transition relation of its own: it is asked while the graph goes through the actions of another state.
  DeadStates(const Program& program, const ZoneOperations& operations);

  // Looks at a zone of a discrete state and all that delays lead to from there. Throws ModelFault.
  void look(std::int32_t* slots, ConstZoneRef zone);

  const Federation& dead() const { return finder_.dead(); }
  const Federation& live() const { return finder_.live(); }

 private:
  Semantics semantics_;
  ZoneOperations operations_;
  int dimension_;
  DeadlockFinder finder_;
  Effect effect_;
  ZoneBuffer later_;
  std::vector<Atom> invariant_;
  std::vector<Atom> atoms_;
};

}  // namespace tachk
