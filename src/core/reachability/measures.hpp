// The extreme values of what is measured, over all states that a search stores. A state that is dropped for one that
// contains it has no value beyond those of that one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "program/program.hpp"
#include "reachability/observers.hpp"
#include "states/store.hpp"
#include "symbolic/successor.hpp"
#include "zones/zone.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk::reachability {

// The extreme value, and the node in which it was met first. A clock without limit has `unbounded_entry` as its value.
struct Extreme {
  zones::Raw value;
  bool strict;  // approached and not taken
  std::uint32_t node;
};

class MeasureWatch final {
 public:
  MeasureWatch(const program::Program& program, symbolic::Semantics& semantics,
               const zones::ZoneOperations& operations);

  // Looks at a new state. Throws FaultReport: the error is of that state, not of the action that leads there.
  void on_store(std::uint32_t node, const symbolic::Successor& successor) {
    try {
      check(node, successor.slots, successor.zone);
    } catch (const machine::ModelFault& fault) {
      throw FaultReport{fault.kind, fault.position, node, {}};
    }
  }

  // Looks at a new state. Throws ModelFault.
  void check(std::uint32_t node, std::int32_t* slots, zones::ConstZoneRef zone);

  // None where no state has been measured. Times are those of the model, whatever the unit of the program.
  std::optional<Extreme> extreme(std::size_t measure) const;

 private:
  // The part of the zone in which the disjunct holds; none if that is empty.
  zones::ConstZoneRef part(const program::Condition& condition, std::int32_t* slots, zones::ConstZoneRef zone);
  // A number that is larger the further out the value lies, among all values of one measure.
  zones::Raw rank(const program::Measure& measure, std::int32_t* slots, zones::ConstZoneRef zone);

  struct Best {
    zones::Raw rank;
    std::uint32_t node = states::no_node;
  };

  const program::Program& program_;
  symbolic::Semantics& semantics_;
  zones::ZoneOperations operations_;
  std::vector<Best> best_;  // of each measure
  std::vector<zones::Atom> atoms_;
  zones::ZoneBuffer scratch_;
};

}  // namespace tachk::reachability
