#include "zones/extent.hpp"

#include <algorithm>

#include "zones/zone.hpp"

namespace tachk::zones {

ExtentScale choose_scale(const ZoneOperations& operations, int dimension, Raw largest_entry) {
  const std::int64_t width = static_cast<std::int64_t>(operations.row_bytes) / operations.stride;
  const std::int64_t rows = (dimension + 7) / 8;
  ExtentScale scale{largest_entry, 0, 0};
  const auto largest = [&] { return std::int64_t{scale.limit >> scale.entry_shift} + 1; };
  const std::int64_t addends = rows * operations.stride / operations.lanes;  // in one lane of a vector
  const std::int64_t bits = std::min<std::int64_t>(8 * width - 1, 56);
  while (largest() >= (std::int64_t{1} << bits) / addends) ++scale.entry_shift;
  const std::int64_t entries = rows * operations.stride * 8 / std::min(operations.lanes, 8);  // in a sum, at most
  while ((largest() * entries) >> scale.sum_shift >= 1 << 15) ++scale.sum_shift;
  return scale;
}

}  // namespace tachk::zones
