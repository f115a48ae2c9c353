// References to zones and to rows of bounds, by which they are passed around: they do not own what they refer to, know
// neither its dimension nor the type of its entries, and cost no more than the pointer they are. Two types, so that the
// compiler tells a matrix from a row, and two more for what may only be read.
#pragma once

#include <cstddef>

namespace tachk {

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

// A bound for each clock: one row as long as those of the zones that it goes with, with entries of their type.
struct ConstBoundRow {
  const std::byte* bytes;
};

struct BoundRow {
  std::byte* bytes;

  operator ConstBoundRow() const { return {bytes}; }
};

}  // namespace tachk
