// A predicate on states, looked at one discrete state at a time: mostly it is true or false there whatever the clocks
// say, and else it is a union of zones.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "program/program.hpp"
#include "symbolic/dead_states.hpp"
#include "symbolic/successor.hpp"
#include "zones/zone.hpp"

namespace tachk::liveness {

enum class TruthInZone { never, always, by_clocks };

class Predicate final {
 public:
  Predicate(const program::Goal& goal, symbolic::Semantics& semantics, const zones::ZoneOperations& operations);

  // True if the predicate holds in a discrete state. Where it asks for deadlock it is a matter of clocks, and only what
  // it says of a zone and of all that delays lead to from there is right. Throws ModelFault.
  TruthInZone in(std::int32_t* slots, zones::ConstZoneRef zone);

  // By clocks: the zones of the state looked at last in whose union it holds.
  std::size_t size() const { return count_; }
  const std::vector<zones::Atom>& operator[](std::size_t number) const { return zones_[number]; }

 private:
  std::vector<zones::Atom>& add_zone();
  void add_deadlock(const program::Disjunct& disjunct, std::int32_t* slots, zones::ConstZoneRef zone);

  const program::Goal& goal_;
  symbolic::Semantics& semantics_;
  zones::ZoneOperations operations_;
  std::optional<symbolic::DeadStates> dead_;
  std::vector<std::vector<zones::Atom>> zones_;  // the first count_ are in use
  std::size_t count_ = 0;
};

}  // namespace tachk::liveness
