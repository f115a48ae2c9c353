#include "reachability/measures.hpp"

namespace tachk::reachability {

using program::Measure;
using zones::ConstZoneRef;

MeasureWatch::MeasureWatch(const program::Program& program, symbolic::Semantics& semantics,
                           const zones::ZoneOperations& operations)
    : program_(program),
      semantics_(semantics),
      operations_(operations),
      best_(program.measures.size()),
      scratch_(operations) {}

void MeasureWatch::check(std::uint32_t node, std::int32_t* slots, ConstZoneRef zone) {
  for (std::size_t number = 0; number < best_.size(); ++number) {
    const Measure& measure = program_.measures[number];
    for (const program::Disjunct& disjunct : measure.where.disjuncts) {
      const ConstZoneRef found = part(disjunct.condition, slots, zone);
      if (!found) continue;
      const zones::Raw further = rank(measure, slots, found);
      Best& best = best_[number];
      if (best.node == states::no_node || further > best.rank) best = {further, node};
    }
  }
}

ConstZoneRef MeasureWatch::part(const program::Condition& condition, std::int32_t* slots, ConstZoneRef zone) {
  if (!semantics_.holds(condition, slots)) return {};
  atoms_.clear();
  semantics_.resolve(condition, slots, atoms_);
  if (atoms_.empty()) return zone;
  scratch_.assign(zone);
  const bool some = operations_.intersect(scratch_.get(), program_.dimension(), atoms_.data(), atoms_.size());
  return some ? ConstZoneRef(scratch_.get()) : ConstZoneRef{};
}

// A bound on a clock ranks as in zones: <= c is larger than < c. The least value of a clock is bounded from above by
// what bounds its negative.
zones::Raw MeasureWatch::rank(const Measure& measure, std::int32_t* slots, ConstZoneRef zone) {
  if (measure.clock == 0) {
    const std::int64_t value = semantics_.value(measure.code, slots);
    return measure.largest ? value : -value;
  }
  const int dimension = program_.dimension();
  return measure.largest ? operations_.entry(zone, dimension, measure.clock, 0)
                         : operations_.entry(zone, dimension, 0, measure.clock);
}

std::optional<Extreme> MeasureWatch::extreme(std::size_t number) const {
  const Best& best = best_[number];
  if (best.node == states::no_node) return std::nullopt;
  const Measure& measure = program_.measures[number];
  const zones::Raw sign = measure.largest ? 1 : -1;
  if (measure.clock == 0) return Extreme{sign * best.rank, false, best.node};
  if (best.rank == zones::unbounded_entry) return Extreme{zones::unbounded_entry, false, best.node};
  return Extreme{sign * zones::raw_value(best.rank) * program_.time_unit, (best.rank & 1) == 0, best.node};
}

}  // namespace tachk::reachability
