// Which clocks matter in a discrete state, and zones without the others. A clock without bounds in all current
// locations is free in every extrapolated zone: its row says nothing, its column repeats that of the reference clock.
#pragma once

#include <cstdint>
#include <vector>

#include "program/program.hpp"
#include "states/store.hpp"
#include "symbolic/successor.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk::symbolic {

class ActiveClocks {
 public:
  // `smaller`: the operations for each smaller dimension; empty if zones are kept whole.
  ActiveClocks(const program::Program& program, const Semantics& semantics, const zones::ZoneOperations& operations,
               const std::vector<zones::ZoneOperations>& smaller);

  // The part of a zone that matters, until the next call.
  states::ZoneView packed(const std::int32_t* slots, zones::ConstZoneRef zone) {
    return lengths_.empty() ? states::ZoneView{zone, program_.dimension()} : pack(slots, zone);
  }
  // The zone, extrapolated as it was, from the part that matters.
  void unpack(const std::int32_t* slots, zones::ConstZoneRef packed, zones::ZoneBuffer& zone) {
    if (lengths_.empty())
      zone.assign(packed);
    else
      scatter(slots, packed, zone);
  }
  // The same of a stored state.
  void unpack(const std::int32_t* slots, const states::PassedList& states, std::uint32_t node,
              zones::ZoneBuffer& zone) {
    if (lengths_.empty())
      states.copy_zone(node, zone);
    else
      scatter(slots, states.zone(node, packed_).data, zone);
  }

 private:
  states::ZoneView pack(const std::int32_t* slots, zones::ConstZoneRef zone);
  void scatter(const std::int32_t* slots, zones::ConstZoneRef packed, zones::ZoneBuffer& zone);
  void collect(const std::int32_t* slots);

  const program::Program& program_;
  const Semantics& semantics_;
  zones::ZoneOperations operations_;
  std::vector<int> lengths_;  // of the rows of zones, by dimension; empty if all are kept whole
  std::size_t words_;
  std::vector<std::uint64_t> masks_;   // of the locations, `words_` each
  std::vector<std::uint64_t> mask_;    // of the state collected last
  std::vector<std::uint16_t> clocks_;  // its members, the reference clock first
  zones::ZoneBuffer packed_;
};

}  // namespace tachk::symbolic
