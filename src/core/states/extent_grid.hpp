// Extents of a few zones in half the memory: each sum as a byte, its place in a grid over the range of these zones. The
// grid is as fine as the range allows, so that little is lost; what is rounded is rounded in the same way everywhere,
// so that a zone which contains another one still is at least as large in each.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "zones/extent.hpp"

namespace tachk::states {

struct ExtentCode {
  std::uint8_t sums[zones::Extent::count];

  bool may_include(const ExtentCode& inner) const {
#ifdef __SSE2__
    const __m128i larger = _mm_subs_epu8(inner.lanes(), lanes());
    return _mm_movemask_epi8(_mm_cmpeq_epi8(larger, _mm_setzero_si128())) == 0xFFFF;
#else
    const Sums both = inner.all() < all() ? inner.all() : all();
    const auto larger = reinterpret_cast<Words>(both ^ inner.all());
    return (larger[0] | larger[1]) == 0;
#endif
  }

  // The componentwise maximum and minimum with another one.
  void raise_to(const ExtentCode& other) { put(other.all() > all() ? other.all() : all()); }
  void lower_to(const ExtentCode& other) { put(other.all() < all() ? other.all() : all()); }

 private:
  typedef std::uint8_t Sums __attribute__((vector_size(16)));
#ifdef __SSE2__
  __m128i lanes() const { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(sums)); }
#else
  typedef std::uint64_t Words __attribute__((vector_size(16)));
#endif
  void put(Sums values) { std::memcpy(sums, &values, sizeof values); }
  Sums all() const {
    Sums result;
    std::memcpy(&result, sums, sizeof result);
    return result;
  }
};

class ExtentGrid {
 public:
  class Change;

  ExtentGrid() = default;
  // The finest grid for what lies between two bounds.
  ExtentGrid(const zones::Extent& least, const zones::Extent& most) : ExtentGrid(least, most, {}) {}
  // The finest grid whose cells are made up of whole cells of another one, and none finer than those.
  ExtentGrid(const zones::Extent& least, const zones::Extent& most, const ExtentGrid& finest);

  // True if what lies between two bounds has cells.
  bool spans(const zones::Extent& least, const zones::Extent& most) const;
  // True if it is so by far in some component.
  bool is_finer_than(const ExtentGrid& other) const;

  // The cell of an extent within the grid.
  ExtentCode code(const zones::Extent& extent) const {
    ExtentCode result;
    for (int k = 0; k < zones::Extent::count; ++k) {
      const auto distance = static_cast<std::uint16_t>(extent.sums[k] - base_[k]);
      result.sums[k] = static_cast<std::uint8_t>(static_cast<std::uint16_t>(distance * factor_[k]) >> 8);
    }
    return result;
  }
  // Bounds of what lies in a cell.
  zones::Extent least(const ExtentCode& code) const;
  zones::Extent most(const ExtentCode& code) const;

 private:
  static constexpr int finest_factor = 256;
  int cell_width(int k) const { return finest_factor >> std::countr_zero(factor_[k]); }

  // Cells of component k are 256 / factor wide, and the first one begins at base, which is a multiple of that.
  std::int16_t base_[zones::Extent::count] = {};
  std::uint16_t factor_[zones::Extent::count] = {};  // 0: the grid has no cells
};

// From a grid to one that was made from it.
class ExtentGrid::Change {
 public:
  Change(const ExtentGrid& from, const ExtentGrid& to) {
    for (int k = 0; k < zones::Extent::count; ++k) {
      distance_[k] = static_cast<std::uint16_t>(from.base_[k] - to.base_[k]);
      width_[k] = static_cast<std::uint16_t>(from.cell_width(k));
      factor_[k] = to.factor_[k];
    }
  }

  // The cell that holds another one.
  ExtentCode operator()(const ExtentCode& code) const {
    ExtentCode result;
    for (int k = 0; k < zones::Extent::count; ++k) {
      const auto distance = static_cast<std::uint16_t>(code.sums[k] * width_[k] + distance_[k]);
      result.sums[k] = static_cast<std::uint8_t>(static_cast<std::uint16_t>(distance * factor_[k]) >> 8);
    }
    return result;
  }

 private:
  std::uint16_t distance_[zones::Extent::count];
  std::uint16_t width_[zones::Extent::count];
  std::uint16_t factor_[zones::Extent::count];
};

}  // namespace tachk::states
