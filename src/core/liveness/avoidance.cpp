#include "liveness/avoidance.hpp"

#include <utility>

namespace tachk::liveness {

using symbolic::Delay;
using zones::Atom;
using zones::ConstZoneRef;

Avoidance::Avoidance(symbolic::Semantics& semantics, const zones::ZoneOperations& operations)
    : semantics_(semantics),
      operations_(operations),
      dimension_(semantics.program().dimension()),
      later_(operations),
      met_(operations),
      scratch_(operations),
      result_(operations, dimension_),
      part_(operations, dimension_),
      other_(operations, dimension_) {}

const zones::Federation& Avoidance::after_delay(std::int32_t* slots, ConstZoneRef entry,
                                                const std::vector<Atom>& invariant, const Predicate& avoided) {
  const Delay delay = symbolic::delay_in(semantics_, slots);
  result_.clear();
  if (delay != Delay::free) {
    result_.add(entry);
    for (std::size_t zone = 0; zone < avoided.size(); ++zone) result_.subtract(avoided[zone]);
    if (delay == Delay::none) return result_;
    // With clocks that stand still: what lies ahead of the part outside, without the predicate.
    const std::uint8_t* stopped = semantics_.stopped_clocks(slots);
    part_.clear();
    for (std::size_t piece = 0; piece < result_.size(); ++piece) {
      scratch_.assign(result_[piece]);
      operations_.up_within(scratch_.get(), dimension_, stopped, invariant.data(), invariant.size());
      part_.add(scratch_.get());
    }
    std::swap(result_, part_);
    for (std::size_t zone = 0; zone < avoided.size(); ++zone) result_.subtract(avoided[zone]);
    return result_;
  }
  later_.assign(entry);
  operations_.up_within(later_.get(), dimension_, nullptr, invariant.data(), invariant.size());
  result_.add(later_.get());
  // A delay that avoids each zone, from points that differ perhaps: the latest of these points does for all zones.
  for (std::size_t zone = 0; zone < avoided.size() && !result_.empty(); ++zone) {
    met_.assign(later_.get());
    const std::vector<Atom>& atoms = avoided[zone];
    if (!operations_.intersect(met_.get(), dimension_, atoms.data(), atoms.size())) continue;
    avoid_one(entry, invariant, atoms);
    meet();
  }
  return result_;
}

// Either the end has not met the zone, and nothing before it has; or the beginning lies behind the zone, but not in it.
void Avoidance::avoid_one(ConstZoneRef entry, const std::vector<Atom>& invariant, const std::vector<Atom>& met) {
  operations_.up(met_.get(), dimension_, nullptr);
  zones::tighter_constraints(operations_, dimension_, met_.get(), later_.get(), atoms_);
  part_.clear();
  part_.add(later_.get());
  part_.subtract(atoms_);
  other_.clear();
  scratch_.assign(entry);
  if (!operations_.intersect(scratch_.get(), dimension_, atoms_.data(), atoms_.size())) return;
  other_.add(scratch_.get());
  other_.subtract(met);
  for (std::size_t piece = 0; piece < other_.size(); ++piece) {
    scratch_.assign(other_[piece]);
    operations_.up_within(scratch_.get(), dimension_, nullptr, invariant.data(), invariant.size());
    part_.add(scratch_.get());
  }
}

void Avoidance::meet() {
  other_.clear();
  for (std::size_t one = 0; one < part_.size(); ++one) {
    zones::tighter_constraints(operations_, dimension_, part_[one], later_.get(), atoms_);
    for (std::size_t piece = 0; piece < result_.size(); ++piece) {
      scratch_.assign(result_[piece]);
      if (operations_.intersect(scratch_.get(), dimension_, atoms_.data(), atoms_.size())) other_.add(scratch_.get());
    }
  }
  std::swap(result_, other_);
}

const zones::Federation& Avoidance::never_met(ConstZoneRef zone, const std::vector<Atom>& invariant, Delay delay,
                                              const Predicate& avoided) {
  result_.clear();
  scratch_.assign(zone);
  if (!operations_.intersect(scratch_.get(), dimension_, invariant.data(), invariant.size())) return result_;
  result_.add(scratch_.get());
  if (delay != Delay::free) return result_;
  later_.assign(scratch_.get());
  operations_.up_within(later_.get(), dimension_, nullptr, invariant.data(), invariant.size());
  for (std::size_t number = 0; number < avoided.size(); ++number) {
    met_.assign(later_.get());
    const std::vector<Atom>& atoms = avoided[number];
    if (!operations_.intersect(met_.get(), dimension_, atoms.data(), atoms.size())) continue;
    operations_.down(met_.get(), dimension_);
    zones::tighter_constraints(operations_, dimension_, met_.get(), scratch_.get(), atoms_);
    result_.subtract(atoms_);
  }
  return result_;
}

}  // namespace tachk::liveness
