// What a record of a zone in reduced form begins with. Behind it there are the places of the constraints and their
// bounds: first the differences of clocks that are constant, then the other constraints.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace tachk::zones {

struct ReducedHeader {
  std::uint16_t constraints;
  std::uint8_t equalities;
  std::uint8_t sizes;  // bytes of a place, and sixteen times those of a bound

  static constexpr std::uint8_t sizes_of(std::size_t place_bytes, std::size_t bound_bytes) {
    return static_cast<std::uint8_t>(place_bytes + 16 * bound_bytes);
  }
  std::size_t place_bytes() const { return sizes & 15; }
  std::size_t bound_bytes() const { return sizes >> 4; }
  std::size_t count() const { return std::size_t{equalities} + constraints; }
  // Of the whole record.
  std::size_t record_bytes() const { return sizeof(ReducedHeader) + count() * (place_bytes() + bound_bytes()); }

  static ReducedHeader of(const std::byte* record) {
    ReducedHeader header;
    std::memcpy(&header, record, sizeof header);
    return header;
  }
  // In how many rows of the zone there are constraints. Places come row by row, equalities first.
  static std::uint32_t rows_of(const std::byte* record) {
    const ReducedHeader header = of(record);
    std::uint32_t rows = 0;
    std::uint16_t last = UINT16_MAX;
    for (std::size_t n = header.equalities; n < header.count(); ++n) {
      std::uint16_t place = 0;
      std::memcpy(&place, record + sizeof header + n * header.place_bytes(), header.place_bytes());
      place = static_cast<std::uint16_t>(place / columns_of(header.place_bytes()));
      rows += place != last ? 1 : 0;
      last = place;
    }
    return rows;
  }
  // A place is a row times this and a column.
  static constexpr int columns_of(std::size_t place_bytes) { return place_bytes == 1 ? 16 : 64; }
};

}  // namespace tachk::zones
