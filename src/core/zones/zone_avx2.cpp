// The zone operations for x86-64 machines with AVX2; the only translation unit compiled with -mavx2.
#if defined(__x86_64__)

#define TACHK_INSTRUCTION_SET avx2
#define TACHK_INSTRUCTION_NAME "avx2"

#include "zones/zone_kernel.hpp"

namespace tachk::zones {

ZoneOperations operations_avx2(int dimension, Width width);

ZoneOperations operations_avx2(int dimension, Width width) { return avx2::operations(dimension, width); }

}  // namespace tachk::zones

#endif
