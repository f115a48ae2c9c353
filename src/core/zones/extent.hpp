// Extents: a zone summed up in 32 bytes, to be compared before the zone itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "zones/bound.hpp"

namespace tachk::zones {

// Sums of the entries of a zone: the first half over rows, row i in sum i mod 8, the second half over columns. A zone
// that contains another one is at least as large in each; comparing these first spares most comparisons of zones.
struct Extent {
  static constexpr int count = 16;
  std::int16_t sums[count];

  bool may_include(const Extent& inner) const {
    const Words larger = reinterpret_cast<Words>((inner.part(0) > part(0)) | (inner.part(1) > part(1)));
    return (larger[0] | larger[1]) == 0;
  }

  // The componentwise maximum and minimum with another one.
  void raise_to(const Extent& other) {
    for (int p = 0; p < 2; ++p) put(p, other.part(p) > part(p) ? other.part(p) : part(p));
  }
  void lower_to(const Extent& other) {
    for (int p = 0; p < 2; ++p) put(p, other.part(p) < part(p) ? other.part(p) : part(p));
  }

  // The nearest one within two bounds.
  Extent nearest(const Extent& least, const Extent& most) const {
    Extent result = *this;
    result.lower_to(most);
    result.raise_to(least);
    return result;
  }

  // How far it lies outside of two bounds, summed over the components.
  std::uint32_t distance(const Extent& least, const Extent& most) const {
    Quads sum{};
    for (int p = 0; p < 2; ++p) {
      const Part nearest = least.part(p) > part(p) ? least.part(p) : part(p) > most.part(p) ? most.part(p) : part(p);
      const auto here = reinterpret_cast<Naturals>(part(p));
      const auto there = reinterpret_cast<Naturals>(nearest);
      const auto difference = reinterpret_cast<Quads>(part(p) > nearest ? here - there : there - here);
      sum += (difference & 0xFFFF) + (difference >> 16);
    }
    return sum[0] + sum[1] + sum[2] + sum[3];
  }

  // Of no zone: may include any, or may be included in any.
  static Extent above_all() { return all(INT16_MAX); }
  static Extent below_all() { return all(INT16_MIN); }

  friend bool operator==(const Extent&, const Extent&) = default;

 private:
  // A block that every 64-bit machine compares at once. Copied, since extents lie wherever 16-bit numbers may.
  typedef std::int16_t Part __attribute__((vector_size(16)));
  typedef std::uint16_t Naturals __attribute__((vector_size(16)));
  typedef std::uint32_t Quads __attribute__((vector_size(16)));
  typedef std::uint64_t Words __attribute__((vector_size(16)));
  Part part(std::ptrdiff_t p) const {
    Part result;
    std::memcpy(&result, sums + p * (count / 2), sizeof result);
    return result;
  }
  static Extent all(std::int16_t value) {
    Extent result;
    for (std::int16_t& sum : result.sums) sum = value;
    return result;
  }
  void put(std::ptrdiff_t p, Part part) { std::memcpy(sums + p * (count / 2), &part, sizeof part); }
};

// How entries are summed up.
struct ExtentScale {
  Raw limit;        // entries are cut off at +- this
  int entry_shift;  // of each entry, so that sums do not overflow
  int sum_shift;    // of the sums, so that they fit into 16 bits
};

}  // namespace tachk::zones
