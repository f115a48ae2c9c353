#include "decimals/decimal.hpp"

#include <array>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace tachk::decimals {

namespace {

constexpr int digits_of_long_forms = 40;  // more than a mantissa has, so that rounding shows in none that is compared

using Text = std::array<char, 64>;

double double_of(const Decimal& number) {
  const std::string text = std::to_string(number.mantissa) + "e" + std::to_string(number.exponent);
#if defined(__cpp_lib_to_chars)
  double value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
#else
  return std::strtod(text.c_str(), nullptr);
#endif
}

// A positive number with so many digits behind its first one, as d.ddde+dd.
void print(Text& text, double value, int digits) {
#if defined(__cpp_lib_to_chars)
  *std::to_chars(text.data(), text.data() + text.size() - 1, value, std::chars_format::scientific, digits).ptr = '\0';
#else
  std::snprintf(text.data(), text.size(), "%.*e", digits, value);
#endif
}

void print_shortest(Text& text, double value) {
#if defined(__cpp_lib_to_chars)
  *std::to_chars(text.data(), text.data() + text.size() - 1, value, std::chars_format::scientific).ptr = '\0';
#else
  for (int digits = 0; digits <= 16; ++digits) {
    print(text, value, digits);
    if (std::strtod(text.data(), nullptr) == value) return;
  }
#endif
}

// Reads at most so many digits of d.ddde+dd; what stands between the first two digits depends on the locale.
Decimal read(const Text& text, int digits) {
  Decimal number;
  const char* p = text.data();
  int read = 0;
  int behind = -1;
  for (; *p != 'e' && *p != '\0'; ++p) {
    if (*p < '0' || *p > '9') continue;
    if (read < digits) {
      number.mantissa = 10 * number.mantissa + static_cast<std::uint64_t>(*p - '0');
      ++read;
      ++behind;
    }
  }
  if (*p == 'e') number.exponent = std::strtol(p + 1, nullptr, 10);
  number.exponent -= behind;
  return number;
}

int digits_of(std::uint64_t mantissa) {
  int digits = 1;
  for (; mantissa >= 10; mantissa /= 10) ++digits;
  return digits;
}

// A number of at most fifteen digits is the only one of so many that is nearest to some binary number.
constexpr std::uint64_t sixteen_digits = 1'000'000'000'000'000;
constexpr std::uint64_t thirteen_digits = 1'000'000'000'000;

bool same_digits(const Decimal& a, const Decimal& b) { return a.mantissa == b.mantissa && a.exponent == b.exponent; }

}  // namespace

void drop_zeros(Decimal& number, std::int64_t decimals) {
  for (; -number.exponent > decimals && number.mantissa % 10 == 0; ++number.exponent) number.mantissa /= 10;
}

bool was_binary(const Decimal& number) {
  if (!number.exact || number.mantissa >= sixteen_digits) return true;
  if (number.mantissa < thirteen_digits) return false;
  for (std::uint64_t tail = 10; tail <= 1000; tail *= 10) {
    const std::uint64_t before = number.mantissa / tail % 1'000'000;
    if (before == 0 || before == 999'999) return true;
  }
  return false;
}

Decimal shortest_decimal(double value) {
  const bool negative = value < 0;
  Text text{};
  print_shortest(text, negative ? -value : value);
  Decimal number = read(text, 17);
  number.negative = negative;
  return number;
}

std::optional<Decimal> shorter_if_double(const Decimal& written) {
  const double value = double_of(written);
  Decimal shortest = shortest_decimal(value);
  shortest.negative = written.negative;
  if (written.exact && same_digits(written, shortest)) return shortest;
  const int digits = digits_of(written.mantissa);
  Text text{};
  print(text, value, written.exact ? digits - 1 : digits_of_long_forms);
  if (!same_digits(written, read(text, digits))) return std::nullopt;
  return shortest;
}

}  // namespace tachk::decimals
