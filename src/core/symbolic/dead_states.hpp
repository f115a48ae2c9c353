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

namespace tachk::symbolic {

class DeadStates final {
 public:
  // Has a transition relation of its own: it is used while the graph goes through the actions of another state.
  DeadStates(const program::Program& program, const zones::ZoneOperations& operations);

  // Looks at a zone of a discrete state and all that delays lead to from there. Throws ModelFault.
  void compute(std::int32_t* slots, zones::ConstZoneRef zone);

  const zones::Federation& dead() { return finder_.dead(); }
  const zones::Federation& live() const { return finder_.live(); }

 private:
  Semantics semantics_;
  zones::ZoneOperations operations_;
  int dimension_;
  DeadlockFinder finder_;
  Effect effect_;
  zones::ZoneBuffer later_;
  std::vector<zones::Atom> invariant_;
  std::vector<zones::Atom> atoms_;
};

}  // namespace tachk::symbolic
