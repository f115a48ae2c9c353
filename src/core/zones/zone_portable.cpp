// The zone operations for any machine of this architecture.
#define TACHK_INSTRUCTION_SET portable
#define TACHK_INSTRUCTION_NAME "portable"

#include "zones/zone_kernel.hpp"

namespace tachk::zones {

#if defined(__x86_64__)
ZoneOperations operations_avx2(int dimension, Width width);
#endif

ZoneOperations select_operations(int dimension, Width width, bool vector) {
#if defined(__x86_64__)
  if (vector && __builtin_cpu_supports("avx2")) return operations_avx2(dimension, width);
#endif
  static_cast<void>(vector);  // elsewhere the portable code already uses the vector unit of the architecture
  return portable::operations(dimension, width);
}

}  // namespace tachk::zones
