// Decimal numbers as they are written, and those that floating-point numbers print as.
#pragma once

#include <cstdint>
#include <optional>

namespace tachk::decimals {

// A decimal number as mantissa * 10^exponent. `exact` is false where the mantissa has more digits than fit, `large`
// says that some of them stand before the point.
struct Decimal {
  std::uint64_t mantissa = 0;
  std::int64_t exponent = 0;
  bool negative = false;
  bool exact = true;
  bool large = false;
};

// Makes the mantissa shorter by the zeros at its end, as long as more than so many decimals are left.
void drop_zeros(Decimal& number, std::int64_t decimals);

// True if a number without zeros at its end was a binary one when it was written out, such as 0.30000000000000004, or
// 7.19999999999999, which is 7.2 but for errors of rounding.
bool was_binary(const Decimal& number);

// The decimal number of fewest digits that is nearer to this finite number than to any other of 64 bits.
Decimal shortest_decimal(double value);

// True if a number without zeros at its end has so many digits that there may be a shorter one for the same double: all
// numbers of so many decimals with a smaller mantissa belong to different doubles.
inline bool may_be_double(const Decimal& number) {
  return number.exponent < 0 && (!number.exact || number.mantissa >= std::uint64_t{1} << 52);
}

// The shortest decimal number of a double, if this is how the double is written with more digits (`%.17g`, `%.18e`,
// `%.9f`), correctly rounded.
std::optional<Decimal> shorter_if_double(const Decimal& written);

}  // namespace tachk::decimals
