// Zones in reduced form, in records of differing lengths whose memory is used again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "states/memory.hpp"
#include "zones/zone.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk::states::rows {

class ReducedZones {
 public:
  ReducedZones(const zones::ZoneOperations& operations, int dimension);

  // The number of the record of one more zone.
  std::uint32_t add(zones::ConstZoneRef zone);
  void remove(std::uint32_t number);

  bool equals(std::uint32_t number, zones::ConstZoneRef zone) const;
  // As of ZonesOfDimension.
  bool covers(std::uint32_t number, zones::ConstZoneRef inner, const zones::ClockBounds* bounds) const;
  bool is_covered(std::uint32_t number, zones::ConstZoneRef outer, const zones::ClockBounds* bounds) const;
  zones::ConstZoneRef read(std::uint32_t number, zones::ZoneRef buffer) const {
    operations_.reductions.restore(buffer, units_[number], dimension_);
    return buffer;
  }

  struct Size {
    std::size_t bytes;
    std::uint32_t rows;  // with constraints
  };
  // Of the record of a zone.
  Size size_of(zones::ConstZoneRef zone);
  std::size_t bytes() const;

 private:
  static constexpr std::size_t unit_bytes = 4;

  // Writes the record to `record_`, and returns of how many units it is.
  std::size_t reduce(zones::ConstZoneRef zone);
  zones::ConstZoneRef restored(std::uint32_t number) const { return read(number, zone_.get()); }
  // The number of the first one of so many units one behind the other.
  std::uint32_t take(std::size_t count);

  zones::ZoneOperations operations_;
  int dimension_;
  RecordPool units_;
  std::vector<std::vector<std::uint32_t>> free_;  // records, by how many units they are of
  std::vector<std::byte> record_;
  mutable zones::ZoneBuffer zone_;
};

}  // namespace tachk::states::rows
