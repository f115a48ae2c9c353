#include "states/extent_grid.hpp"

#include <algorithm>

namespace tachk::states {

using zones::Extent;

ExtentGrid::ExtentGrid(const Extent& least, const Extent& most, const ExtentGrid& finest) {
  for (int k = 0; k < Extent::count; ++k) {
    int width = finest.factor_[k] == 0 ? 1 : finest.cell_width(k);
    const int low = least.sums[k];
    const int high = most.sums[k];
    const auto reach = [&] { return 256 * width - 1; };  // from the beginning of the first cell to the end of the last
    // Room is left on both sides for what comes later.
    const auto first = [&] { return std::max(low - (reach() - (high - low)) / 2, INT16_MIN) & -width; };
    while (reach() < high - low || high - first() > reach()) width *= 2;
    base_[k] = static_cast<std::int16_t>(first());
    factor_[k] = static_cast<std::uint16_t>(finest_factor / width);
  }
}

bool ExtentGrid::spans(const Extent& least, const Extent& most) const {
  bool inside = true;
  for (int k = 0; k < Extent::count; ++k)
    inside &= factor_[k] != 0 && least.sums[k] >= base_[k] && (most.sums[k] - base_[k]) * factor_[k] <= UINT16_MAX;
  return inside;
}

bool ExtentGrid::is_finer_than(const ExtentGrid& other) const {
  for (int k = 0; k < Extent::count; ++k)
    if (factor_[k] >= 4 * other.factor_[k]) return true;
  return false;
}

Extent ExtentGrid::least(const ExtentCode& code) const {
  Extent result;
  for (int k = 0; k < Extent::count; ++k)
    result.sums[k] = static_cast<std::int16_t>(base_[k] + code.sums[k] * cell_width(k));
  return result;
}

Extent ExtentGrid::most(const ExtentCode& code) const {
  Extent result = least(code);
  for (int k = 0; k < Extent::count; ++k)
    result.sums[k] = static_cast<std::int16_t>(std::min(result.sums[k] + cell_width(k) - 1, INT16_MAX));
  return result;
}

}  // namespace tachk::states
