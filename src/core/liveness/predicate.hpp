// A predicate on states, looked at one discrete state at a time: mostly it is true or false there whatever the clocks
// say, and else it is a union of zones.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "program/program.hpp"
#include "symbolic/successor.hpp"

namespace tachk {

enum class Truth { never, always, by_clocks };

class Predicate final {
 public:
  // The disjuncts of a goal, none of which asks for deadlock.
  Predicate(const Goal& goal, Semantics& semantics) : goal_(goal), semantics_(semantics) {}

  // Whether the predicate holds in a discrete state. Throws ModelFault.
  Truth in(std::int32_t* slots);

  // By clocks: the zones of the state looked at last in whose union it holds.
  std::size_t size() const { return count_; }
  const std::vector<Atom>& operator[](std::size_t number) const { return zones_[number]; }

 private:
  const Goal& goal_;
  Semantics& semantics_;
  std::vector<std::vector<Atom>> zones_;  // the first count_ are in use
  std::size_t count_ = 0;
};

}  // namespace tachk
