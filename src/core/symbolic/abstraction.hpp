// Abstractions of zones, without which the zone graph of most programs is infinite.
//
// A clock that has passed every constant it will be compared with may have any larger value as well: extrapolation
// widens a zone by such values. The constants that count are those of the locations where the processes are.
//
// Diagonal constraints (x - y < c) make the usual extrapolations unsound (Bouyer 2004): with diagonals every zone is
// split along them, the pieces are extrapolated by Extra_M and cut back (Bengtsson, Yi 2003).
#pragma once

#include <cstdint>
#include <exception>
#include <vector>

#include "program/program.hpp"
#include "symbolic/successor.hpp"
#include "zones/zone.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk::symbolic {

enum class Extrapolation { none, max, lu };

// Where the constants come from: the locations of a state, or the whole program.
enum class BoundScope { local, global };

class Abstraction final {
 public:
  Abstraction(const program::Program& program, const Semantics& semantics, const zones::ZoneOperations& operations,
              Extrapolation kind, BoundScope scope);

  // The constants that count in a discrete state, until the next call.
  zones::ClockBounds bounds(const std::int32_t* slots) {
    collect_bounds(slots);
    return {lower_.get(), upper_.get()};
  }

  // Calls take(abstract) for each of the zones that together stand for the zone of a discrete state; there is one
  // unless the program has diagonals. The zone is used up. Throws ConstantOverflow.
  template <class Take>
  void apply(const std::int32_t* slots, zones::ZoneBuffer& zone, Take&& take) {
    if (kind_ == Extrapolation::none) {
      check_magnitude(zone.get());
      take(zones::ConstZoneRef(zone.get()));
      return;
    }
    collect_bounds(slots);
    if (!program_.diagonals.empty()) {
      for (const zones::ZoneBuffer& piece : split(zone)) take(piece.get());
      return;
    }
    operations_.extrapolate_lu_plus(zone.get(), program_.dimension(), lower_.get(), upper_.get());
    take(zones::ConstZoneRef(zone.get()));
  }

 private:
  // Of the locations, each row in a buffer of its own, and a last row without any bound.
  struct Bounds {
    std::vector<zones::BoundRowBuffer> lower;
    std::vector<zones::BoundRowBuffer> upper;
    std::vector<bool> present;
  };

  void add_bounds(const program::Location& location, BoundScope scope);
  // Those of a discrete state, into `lower_` and `upper_`.
  void collect_bounds(const std::int32_t* slots);
  void check_magnitude(zones::ConstZoneRef zone) const;
  std::vector<zones::ZoneBuffer> split(const zones::ZoneBuffer& zone) const;
  void split_along(std::size_t diagonal, const zones::ZoneBuffer& zone, std::vector<zones::Atom>& sides,
                   std::vector<zones::ZoneBuffer>& pieces) const;

  const program::Program& program_;
  const Semantics& semantics_;
  zones::ZoneOperations operations_;
  Extrapolation kind_;
  Bounds bounds_;
  zones::BoundRowBuffer lower_;
  zones::BoundRowBuffer upper_;
  std::vector<zones::ConstBoundRow> lower_rows_;
  std::vector<zones::ConstBoundRow> upper_rows_;
};

}  // namespace tachk::symbolic
