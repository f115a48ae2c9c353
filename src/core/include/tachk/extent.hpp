// Extents: a zone summed up in 32 bytes, to be compared before the zone itself.
#pragma once

#include <cstdint>

#include "tachk/bound.hpp"

namespace tachk {

// Sums of the entries of a zone: the first half over rows, row i in sum i mod 8, the second half over columns. A zone
// that contains another one is at least as large in each; comparing these first spares most comparisons of zones.
struct Extent {
  static constexpr int count = 16;
  std::int16_t sums[count];

  bool may_include(const Extent& inner) const {
    std::int16_t exceeded = 0;
    for (int k = 0; k < count; ++k) exceeded |= static_cast<std::int16_t>(inner.sums[k] > sums[k]);
    return exceeded == 0;
  }

  // The componentwise maximum and minimum with another one.
  void raise_to(const Extent& other) {
    for (int k = 0; k < count; ++k) sums[k] = other.sums[k] > sums[k] ? other.sums[k] : sums[k];
  }
  void lower_to(const Extent& other) {
    for (int k = 0; k < count; ++k) sums[k] = other.sums[k] < sums[k] ? other.sums[k] : sums[k];
  }

  friend bool operator==(const Extent&, const Extent&) = default;
};

// How entries are summed up.
struct ExtentScale {
  Raw limit;        // entries are cut off at +- this
  int entry_shift;  // of each entry, so that sums do not overflow
  int sum_shift;    // of the sums, so that they fit into 16 bits
};

}  // namespace tachk
