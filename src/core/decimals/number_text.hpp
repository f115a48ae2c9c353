// Numbers as text: read as decimal numbers, and as the nearest ones of 64 bits.
#pragma once

#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string>
#include <system_error>

#include "decimals/decimal.hpp"

namespace tachk::decimals {

inline constexpr std::uint64_t exact_mantissa = std::uint64_t{1} << 53;
inline constexpr std::uint64_t room_for_a_digit = (std::numeric_limits<std::uint64_t>::max() - 9) / 10;

inline constexpr std::array<double, 23> powers_of_ten = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                         1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                         1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

inline bool is_digit(char c) { return static_cast<unsigned char>(c - '0') < 10; }

// As std::from_chars, which some standard libraries do not have for floating-point numbers.
inline std::from_chars_result read_number(const char* first, const char* last, double& value) {
#if defined(__cpp_lib_to_chars)
  return std::from_chars(first, last, value);
#else
  const std::string text(first, last);
  char* stopped = nullptr;
  const double read = std::strtod(text.c_str(), &stopped);
  const bool is_other_form = text.empty() || text[0] == '+' || text[0] == ' ' || text[0] == '\t' || text[0] == '\r' ||
                             text.find_first_of("xX") < text.size();
  if (stopped == text.c_str() || is_other_form) return {first, std::errc::invalid_argument};
  value = read;
  return {first + (stopped - text.c_str()), std::errc{}};
#endif
}

// The place behind the number, or `p` if there is none. The text ends with a line break, so no length is needed.
inline const char* scan_decimal(const char* p, char point, Decimal& number) {
  const char* const start = p;
  if (*p == '-' || *p == '+') number.negative = *p++ == '-';
  const char* const first = p;
  std::uint64_t mantissa = 0;
  for (; is_digit(*p); ++p) {
    if (mantissa > room_for_a_digit) {
      number.exact = false;
      number.large = true;
      continue;
    }
    mantissa = 10 * mantissa + static_cast<std::uint64_t>(*p - '0');
  }
  auto digits = p - first;
  if (*p == point) {
    const char* const fraction = ++p;
    for (; is_digit(*p); ++p) {
      if (mantissa > room_for_a_digit) {
        if (*p != '0') number.exact = false;
        continue;
      }
      mantissa = 10 * mantissa + static_cast<std::uint64_t>(*p - '0');
      --number.exponent;
    }
    digits += p - fraction;
  }
  if (digits == 0) return start;
  if (*p == 'e' || *p == 'E') {
    const char* q = p + 1;
    const bool negative = *q == '-';
    if (*q == '-' || *q == '+') ++q;
    if (is_digit(*q)) {
      std::int64_t exponent = 0;
      for (; is_digit(*q); ++q)
        if (exponent < 100000) exponent = 10 * exponent + (*q - '0');
      number.exponent += negative ? -exponent : exponent;
      p = q;
    }
  }
  number.mantissa = mantissa;
  return p;
}

// Gives the double of a number with few digits: exact operands and one correctly rounded division (Clinger 1990). False
// where that is not enough.
inline bool is_divided(const Decimal& number, double& value) {
  if (!number.exact || number.mantissa > exact_mantissa || number.exponent > 0 || number.exponent < -22) return false;
  value = static_cast<double>(number.mantissa);
  if (number.exponent < 0) value /= powers_of_ten[static_cast<std::size_t>(-number.exponent)];
  if (number.negative) value = -value;
  return true;
}

}  // namespace tachk::decimals
