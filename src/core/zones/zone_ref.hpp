// References to zones and to rows of bounds, by which they are passed around: they do not own what they refer to, know
// neither its dimension nor the type of its entries, and cost no more than the pointer they are. Two types, so that the
// compiler distinguishes a matrix from a row, and two more for what may only be read.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tachk::zones {

// A zone that may be read; by default none.
struct ConstZoneRef {
  const std::byte* bytes = nullptr;

  explicit operator bool() const { return bytes != nullptr; }
};

// A zone.
struct ZoneRef {
  std::byte* bytes;

  operator ConstZoneRef() const { return {bytes}; }
};

// A zone whose rows lie apart, each in a place of its own: row i is the one with the number `numbers[i]` in blocks of
// 2^shift rows.
struct ZoneRows {
  const std::byte* const* blocks;
  const std::uint32_t* numbers;
  unsigned shift;

  const std::byte* row(int i, std::size_t row_bytes) const {
    const std::uint32_t number = numbers[i];
    return blocks[number >> shift] + (number & ((std::uint32_t{1} << shift) - 1)) * row_bytes;
  }
};

// A bound for each clock: one row as long as those of the zones that it goes with, with entries of their type.
struct ConstBoundRow {
  const std::byte* bytes;
};

struct BoundRow {
  std::byte* bytes;

  operator ConstBoundRow() const { return {bytes}; }
};

}  // namespace tachk::zones
