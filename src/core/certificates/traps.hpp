// Traps: sets of states that no run leaves. That none leaves them, whoever gives them has to have proved.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "certificates/zones.hpp"

namespace tachk::certificates {

// Outside of it are the states in which a slot has one of some values and the clocks satisfy one of the constraints
// that are listed for this value.
struct IndexedTrap {
  std::uint32_t slot;
  std::int32_t low;                               // the lowest value of the slot
  std::vector<std::vector<Constraints>> outside;  // of each value from that one on
};

// States that need not be covered: those that lie in one of the traps of each clause. Without clauses there are none.
class Traps final {
 public:
  using Clause = std::vector<std::size_t>;
  using Slots = std::vector<std::int32_t>;

  Traps(std::vector<IndexedTrap> traps, std::vector<Clause> clauses)
      : traps_(std::move(traps)), clauses_(std::move(clauses)) {}

  bool none() const { return clauses_.empty(); }
  // True if all states of a zone are such ones. Most lie in a single trap, so that this is looked at first.
  bool have(const Slots& slots, const Zone& zone) const {
    return !none() && std::all_of(clauses_.begin(), clauses_.end(), [&](const Clause& clause) {
      return std::any_of(clause.begin(), clause.end(),
                         [&](std::size_t trap) { return !leaves(slots, zone, {trap}, 0); }) ||
             !leaves(slots, zone, clause, 0);
    });
  }

 private:
  // True if a zone has a state outside of all traps of a clause from a place on.
  bool leaves(const Slots& slots, const Zone& zone, const Clause& clause, std::size_t place) const {
    if (place == clause.size()) return true;
    const IndexedTrap& trap = traps_[clause[place]];
    const auto& parts = trap.outside[static_cast<std::size_t>(std::int64_t{slots[trap.slot]} - trap.low)];
    return std::any_of(parts.begin(), parts.end(), [&](const Constraints& part) {
      const Zone outside = zone.within(part);
      return !outside.empty() && leaves(slots, outside, clause, place + 1);
    });
  }

  std::vector<IndexedTrap> traps_;
  std::vector<Clause> clauses_;
};

}  // namespace tachk::certificates
