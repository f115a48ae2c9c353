#include "liveness/predicate.hpp"

#include <algorithm>

namespace tachk::liveness {

using program::DeadlockLiteral;
using program::Disjunct;
using zones::Atom;

Predicate::Predicate(const program::Goal& goal, symbolic::Semantics& semantics, const zones::ZoneOperations& operations)
    : goal_(goal), semantics_(semantics), operations_(operations) {
  const bool has_deadlock = std::any_of(goal.disjuncts.begin(), goal.disjuncts.end(), [](const Disjunct& disjunct) {
    return disjunct.deadlock != DeadlockLiteral::absent;
  });
  if (has_deadlock) dead_.emplace(semantics.program(), operations);
}

std::vector<Atom>& Predicate::add_zone() {
  if (count_ == zones_.size()) zones_.emplace_back();
  zones_[count_].clear();
  return zones_[count_++];
}

TruthInZone Predicate::in(std::int32_t* slots, zones::ConstZoneRef zone) {
  count_ = 0;
  for (const Disjunct& disjunct : goal_.disjuncts) {
    if (!semantics_.holds(disjunct.condition, slots)) continue;
    if (disjunct.deadlock != DeadlockLiteral::absent) {
      add_deadlock(disjunct, slots, zone);
      continue;
    }
    std::vector<Atom>& atoms = add_zone();
    semantics_.resolve(disjunct.condition, slots, atoms);
    if (atoms.empty()) {
      count_ = 0;
      return TruthInZone::always;
    }
  }
  return count_ == 0 ? TruthInZone::never : TruthInZone::by_clocks;
}

// Each part of what is dead or live, with all its constraints.
void Predicate::add_deadlock(const Disjunct& disjunct, std::int32_t* slots, zones::ConstZoneRef zone) {
  dead_->compute(slots, zone);
  const zones::Federation& parts = disjunct.deadlock == DeadlockLiteral::required ? dead_->dead() : dead_->live();
  const int dimension = semantics_.program().dimension();
  for (std::size_t part = 0; part < parts.size(); ++part) {
    std::vector<Atom>& atoms = add_zone();
    semantics_.resolve(disjunct.condition, slots, atoms);
    for (int i = 0; i < dimension; ++i)
      for (int j = 0; j < dimension; ++j) {
        const zones::Raw raw = operations_.entry(parts[part], dimension, i, j);
        if (i != j && raw != zones::unbounded_entry)
          atoms.push_back({static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j), raw});
      }
    // A zone without a constraint would be no zone by clocks: clocks are never negative.
    if (atoms.empty()) atoms.push_back({0, 0, zones::raw_zero});
  }
}

}  // namespace tachk::liveness
