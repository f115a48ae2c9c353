// Zones: canonical, non-empty difference bound matrices in flat memory, and the operations on them.
//
// A zone of dimension n (n - 1 clocks and the reference clock 0) is n rows of `stride` entries; entry (i, j) bounds
// x_i - x_j. Rows are padded to whole vectors; the padding always holds `infinity`, so that equal zones are equal
// bytes. The operations are compiled once for each instruction set and reached through a table chosen at run time; one
// call does as much as possible, so the indirection does not matter.
#pragma once

#include <cstddef>
#include <cstdint>

#include "zones/bound.hpp"
#include "zones/extent.hpp"
#include "zones/zone_ref.hpp"

namespace tachk::zones {

// The constants with which clocks are compared in a discrete state: L(x) and U(x) as `extrapolate_lu_plus` takes them.
struct ClockBounds {
  ConstBoundRow lower;
  ConstBoundRow upper;
};

// The operations on a zone whose rows lie apart: the same as on others.
struct ZoneRowOperations {
  bool (*equal)(ZoneRows zone, ConstZoneRef other, int dimension);
  bool (*include)(ZoneRows outer, ConstZoneRef inner, int dimension);
  bool (*lie_in)(ZoneRows inner, ConstZoneRef outer, int dimension);
  bool (*simulate)(ZoneRows outer, ConstZoneRef inner, int dimension, const ClockBounds& bounds);
  bool (*are_simulated)(ZoneRows inner, ConstZoneRef outer, int dimension, const ClockBounds& bounds);
  // Puts the rows one behind the other.
  void (*assemble)(ZoneRef target, ZoneRows zone, int dimension);
};

// Zones in reduced form: records of the constraints from which the others follow, of differing lengths.
struct ZoneReductions {
  std::size_t most_bytes;  // of a record; 0: there is no such form of zones of so many clocks
  // Writes the record of a zone, and returns how many bytes it has. Equal zones have equal records.
  std::size_t (*reduce)(std::byte* target, ConstZoneRef zone, int dimension);
  void (*restore)(ZoneRef target, const std::byte* record, int dimension);
  bool (*include)(const std::byte* outer, ConstZoneRef inner, int dimension);
  // False only if the zone itself does not: exact answers need what follows from the record.
  bool (*may_lie_in)(const std::byte* inner, ConstZoneRef outer, int dimension);
  bool (*may_simulate)(const std::byte* outer, ConstZoneRef inner, int dimension, const ClockBounds& bounds);
  bool (*may_be_simulated)(const std::byte* inner, ConstZoneRef outer, int dimension, const ClockBounds& bounds);
};

struct ZoneOperations {
  const char* name;
  int stride;         // entries in a row
  int lanes;          // entries in a vector
  std::size_t bytes;  // of a whole zone
  std::size_t row_bytes;
  Raw largest_constant;  // that may occur in an atom, a reset or a bound
  Raw legal;             // all finite entries lie below this and above its negation

  // All clocks are zero.
  void (*make_zero)(ZoneRef zone, int dimension);
  // Makes it the zone with these entries, row by row without padding, which are canonical and not empty; an entry of
  // `unbounded_int32` is infinite.
  void (*assign)(ZoneRef zone, int dimension, const std::int32_t* entries);
  // The zone and the atoms; false, and an unusable zone, if that is empty.
  bool (*intersect)(ZoneRef zone, int dimension, const Atom* atoms, std::size_t count);
  // True if each atom by itself leaves something of the zone; cheap, and necessary for `intersect`.
  bool (*meets_each)(ConstZoneRef zone, int dimension, const Atom* atoms, std::size_t count);
  // Sets clocks, in order. What copies add up to must be at most `largest_constant`.
  void (*reset)(ZoneRef zone, int dimension, const ClockReset* resets, std::size_t count);
  // All clocks run for any time, except where `stopped` (may be null) is nonzero. With stopped clocks the result is the
  // smallest zone that contains the reached valuations.
  void (*up)(ZoneRef zone, int dimension, const std::uint8_t* stopped);
  // `up` within the atoms, which must hold of some valuation of the zone: what `up` and then `intersect` give.
  void (*up_within)(ZoneRef zone, int dimension, const std::uint8_t* stopped, const Atom* atoms, std::size_t count);
  // All valuations from which the zone is reached by letting time pass.
  void (*down)(ZoneRef zone, int dimension);
  // True if `outer` contains `inner`.
  bool (*includes)(ConstZoneRef outer, ConstZoneRef inner, int dimension);
  // True if each valuation of `inner` is simulated by one of `outer`: exactly, if `inner` lies in the abstraction
  // aLU of `outer` (F. Herbreteau, B. Srivathsan, I. Walukiewicz, "Better abstractions for timed automata", LICS 2012).
  // Bounds as for `extrapolate_lu_plus`.
  bool (*simulates)(ConstZoneRef outer, ConstZoneRef inner, int dimension, const ClockBounds& bounds);
  // Makes a zone the smallest one that contains both.
  void (*hull)(ZoneRef zone, ConstZoneRef other, int dimension);
  // Makes a zone its union with the other one, if that is a zone and larger; false, and nothing changed, if it is not.
  bool (*convex_union)(ZoneRef zone, ConstZoneRef other, int dimension);
  // Extra+LU (Behrmann, Bouyer, Larsen, Pelanek 2006, definition 7), closed again. `lower[i]` and `upper[i]` hold
  // L(x_i) and U(x_i), -1 for minus infinity, in the entry type of the zone; `stride` entries, entry 0 and the padding
  // are `no_bound`.
  void (*extrapolate_lu_plus)(ZoneRef zone, int dimension, ConstBoundRow lower, ConstBoundRow upper);
  // Extra_M of the same paper with M(x_i) in `bound[i]`, closed again.
  void (*extrapolate_max)(ZoneRef zone, int dimension, ConstBoundRow bound);
  // target[i] = the largest rows[k][i] over all rows of bounds; count > 0.
  void (*maximise_bounds)(BoundRow target, const ConstBoundRow* rows, std::size_t count, int dimension);
  std::uint64_t (*hash)(ConstZoneRef zone, int dimension);
  // The largest absolute value of a finite entry.
  Raw (*largest_entry)(ConstZoneRef zone, int dimension);
  Extent (*extent)(ConstZoneRef zone, int dimension, const ExtentScale& scale);
  // Reads entry (i, j); infinity is reported as `unbounded_entry`.
  Raw (*entry)(ConstZoneRef zone, int dimension, int i, int j);
  // Writes the constraints of a zone that are tighter than those of another one, upper bounds of clocks first; how many
  // there are. `atoms` has room for dimension * dimension.
  std::size_t (*tighter)(ConstZoneRef zone, ConstZoneRef other, int dimension, Atom* atoms);
  // The part of a zone that `count` clocks, in ascending order and 0 first, have in common, as a zone of that
  // dimension.
  void (*gather)(ZoneRef target, ConstZoneRef zone, int dimension, const std::uint16_t* clocks, int count, int length);
  // The largest zone with this part.
  void (*scatter)(ZoneRef target, ConstZoneRef part, int dimension, const std::uint16_t* clocks, int count, int length);
  // The zone with its clocks renamed: clock i of the target is clock sources[i] of the zone.
  void (*rename)(ZoneRef target, ConstZoneRef zone, int dimension, const std::uint16_t* sources);
  // True if the zone with its clocks renamed is the same. `moved`: the clocks i for which sources[i] is another one.
  bool (*stays)(ConstZoneRef zone, int dimension, const std::uint16_t* sources, const std::uint16_t* moved,
                std::size_t count);
  // Of each clock the sum of its row and that of its column, as far as entries count: those are cut off far out. A
  // clock that is never larger than another one has a row sum that is not larger either.
  void (*sum_up)(ConstZoneRef zone, int dimension, std::int64_t* rows, std::int64_t* columns);
  // Writes one value into a row of bounds.
  void (*set_bound)(BoundRow row, int clock, Raw value);
  ZoneRowOperations rows;
  ZoneReductions reductions;
};

inline constexpr Raw not_compared = -1;  // the bound of a clock that nothing compares: minus infinity
inline constexpr Raw no_bound = 4095;    // larger than any lower bound that clock 0 or the padding can have

inline constexpr Raw unbounded_entry = INT64_MAX;
inline constexpr std::int32_t unbounded_int32 = BoundLimits<std::int32_t>::infinity;

// Of the entries, in bits.
enum class Width { narrow = 16, wide = 32, widest = 64 };

// For zones with finite entries up to this one, whose extents tell as much as they can; those of others tell less.
ExtentScale choose_scale(const ZoneOperations& operations, int dimension, Raw largest_entry);

// The operations for a dimension. `vector` asks for the widest instruction set of this machine instead of portable
// code.
ZoneOperations select_operations(int dimension, Width width, bool vector);

}  // namespace tachk::zones
