#include "symbolic/abstraction.hpp"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <utility>

namespace tachk::symbolic {

using zones::Atom;
using zones::Raw;
using zones::ZoneBuffer;

Abstraction::Abstraction(const program::Program& program, const Semantics& semantics,
                         const zones::ZoneOperations& operations, Extrapolation kind, BoundScope scope)
    : program_(program),
      semantics_(semantics),
      operations_(operations),
      kind_(kind),
      lower_(operations, program.dimension()),
      upper_(operations, program.dimension()) {
  for (const program::Process& process : program.processes)
    for (const program::Location& location : process.locations) add_bounds(location, scope);
  bounds_.lower.emplace_back(operations, program.dimension());
  bounds_.upper.emplace_back(operations, program.dimension());
}

void Abstraction::add_bounds(const program::Location& location, BoundScope scope) {
  const bool separate = kind_ == Extrapolation::lu && program_.diagonals.empty();
  const auto clocks = static_cast<std::size_t>(program_.dimension());
  std::vector<Raw> lower(clocks, zones::not_compared);
  std::vector<Raw> upper(clocks, zones::not_compared);
  if (scope == BoundScope::local) {
    for (const program::ClockBound& bound : location.lower)
      lower[bound.clock] = std::max(lower[bound.clock], bound.value);
    for (const program::ClockBound& bound : location.upper)
      upper[bound.clock] = std::max(upper[bound.clock], bound.value);
  } else {
    lower = program_.maximum_constants;
    upper = program_.maximum_constants;
  }
  zones::BoundRow lower_row = bounds_.lower.emplace_back(operations_, program_.dimension()).get();
  zones::BoundRow upper_row = bounds_.upper.emplace_back(operations_, program_.dimension()).get();
  bool present = false;
  for (std::size_t clock = 1; clock < clocks; ++clock) {
    const Raw both = std::max(lower[clock], upper[clock]);
    operations_.set_bound(lower_row, static_cast<int>(clock), separate ? lower[clock] : both);
    operations_.set_bound(upper_row, static_cast<int>(clock), separate ? upper[clock] : both);
    present |= both >= 0;
  }
  bounds_.present.push_back(present);
}

void Abstraction::collect_bounds(const std::int32_t* slots) {
  lower_rows_.assign(1, bounds_.lower.back().get());
  upper_rows_.assign(1, bounds_.upper.back().get());
  for (std::size_t p = 0; p < program_.processes.size(); ++p) {
    const std::size_t number = semantics_.location_number(p, slots[p]);
    if (!bounds_.present[number]) continue;
    lower_rows_.push_back(bounds_.lower[number].get());
    upper_rows_.push_back(bounds_.upper[number].get());
  }
  operations_.maximise_bounds(lower_.get(), lower_rows_.data(), lower_rows_.size(), program_.dimension());
  operations_.maximise_bounds(upper_.get(), upper_rows_.data(), upper_rows_.size(), program_.dimension());
}

void Abstraction::check_magnitude(zones::ConstZoneRef zone) const {
  const int dimension = program_.dimension();
  for (int i = 0; i < dimension; ++i)
    for (int j = 0; j < dimension; ++j) {
      const Raw raw = operations_.entry(zone, dimension, i, j);
      if (raw != zones::unbounded_entry && std::abs(raw) > operations_.legal / 4) throw ConstantOverflow{};
    }
}

std::vector<ZoneBuffer> Abstraction::split(const ZoneBuffer& zone) const {
  std::vector<ZoneBuffer> pieces;
  std::vector<Atom> sides;
  split_along(0, zone, sides, pieces);
  return pieces;
}

// `sides`: for each diagonal seen so far the side on which the zone lies.
void Abstraction::split_along(std::size_t diagonal, const ZoneBuffer& zone, std::vector<Atom>& sides,
                              std::vector<ZoneBuffer>& pieces) const {
  const int dimension = program_.dimension();
  if (diagonal == program_.diagonals.size()) {
    const zones::ZoneRef piece = pieces.emplace_back(zone).get();
    operations_.extrapolate_max(piece, dimension, upper_.get());
    if (!operations_.intersect(piece, dimension, sides.data(), sides.size()))
      throw std::logic_error("extrapolation lost a zone");
    return;
  }
  const Atom inside = program_.diagonals[diagonal];
  for (const Atom side : {inside, zones::negated(inside)}) {
    ZoneBuffer piece(zone);
    if (!operations_.intersect(piece.get(), dimension, &side, 1)) continue;
    sides.push_back(side);
    split_along(diagonal + 1, piece, sides, pieces);
    sides.pop_back();
  }
}

}  // namespace tachk::symbolic
