// The extreme values of what is measured, over all states that a search stores. A state that is dropped for one that
// contains it has no value beyond those of that one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "program/program.hpp"
#include "states/store.hpp"
#include "symbolic/successor.hpp"
#include "zones/zone.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk {

// The extreme value, and the node in which it was met first. A clock without limit has `unbounded_entry` as its value.
struct Extreme {
  Raw value;
  bool strict;  // approached and not taken
  std::uint32_t node;
};

class MeasureWatch final {
 public:
  MeasureWatch(const Program& program, Semantics& semantics, const ZoneOperations& operations);

  // Looks at a new state. Throws ModelFault.
  void check(std::uint32_t node, std::int32_t* slots, ConstZoneRef zone);

  // None where no state has been measured. Times are those of the model, whatever the unit of the program.
  std::optional<Extreme> extreme(std::size_t measure) const;

 private:
  // The part of the zone in which the disjunct holds; none if that is empty.
  ConstZoneRef part(const Condition& condition, std::int32_t* slots, ConstZoneRef zone);
  // A number that is larger the further out the value lies, among all values of one measure.
  Raw rank(const Measure& measure, std::int32_t* slots, ConstZoneRef zone);

  struct Best {
    Raw rank;
    std::uint32_t node = no_node;
  };

  const Program& program_;
  Semantics& semantics_;
  ZoneOperations operations_;
  std::vector<Best> best_;  // of each measure
  std::vector<Atom> atoms_;
  ZoneBuffer scratch_;
};

}  // namespace tachk
