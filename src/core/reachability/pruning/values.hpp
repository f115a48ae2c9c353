// The values of one variable from which it can still come to satisfy tests, whatever everybody else does: above all of
// a variable that is only raised. As for pairs of locations and intervals, of a value outside it is known that it
// cannot.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "machine/edge_effects.hpp"
#include "program/program.hpp"

namespace tachk::reachability::pruning {

struct ValueSet {
  std::uint32_t slot;
  std::int32_t low;
  std::vector<bool> members;  // from the lowest value on

  bool holds(const std::int32_t* slots) const { return members[static_cast<std::size_t>(slots[slot] - low)]; }
};

// None if the variable may leave it never, or if it has too many values, or if some edge sets it to anything.
// `effects`: of each edge.
std::optional<ValueSet> values_before(const program::Program& program, const std::vector<machine::EdgeEffects>& effects,
                                      std::uint32_t slot, const std::vector<program::Test>& tests);

}  // namespace tachk::reachability::pruning
