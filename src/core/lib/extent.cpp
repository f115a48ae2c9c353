#include "tachk/extent.hpp"

#include "tachk/zone.hpp"

namespace tachk {

ExtentScale choose_scale(const ZoneOperations& operations, int dimension, Raw largest_entry) {
  const std::int64_t width = static_cast<std::int64_t>(operations.bytes) / operations.stride / dimension;
  const std::int64_t rows = (dimension + 7) / 8;
  ExtentScale scale{largest_entry, 0, 0};
  const auto largest = [&] { return std::int64_t{scale.limit >> scale.entry_shift} + 1; };
  const std::int64_t addends = rows * operations.stride * width / 32;  // in one lane of a vector
  while (largest() * addends >= std::int64_t{1} << (8 * width - 1)) ++scale.entry_shift;
  while ((largest() * rows * operations.stride) >> scale.sum_shift >= 1 << 15) ++scale.sum_shift;
  return scale;
}

}  // namespace tachk
