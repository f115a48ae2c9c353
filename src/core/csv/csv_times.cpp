#include "csv/csv_times.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <stdexcept>

namespace tachk::csv {

namespace {

constexpr std::int64_t furthest_time = std::numeric_limits<std::int64_t>::max() / 2;

// A number of at most fifteen digits is the only one of so many that is nearest to some binary number.
constexpr std::uint64_t sixteen_digits = 1'000'000'000'000'000;
constexpr std::uint64_t thirteen_digits = 1'000'000'000'000;

// Whether a number without zeros at its end was a binary one when it was written out, such as 0.30000000000000004, or
// 7.19999999999999, which is 7.2 but for errors of rounding.
bool was_binary(const Decimal& number) {
  if (!number.exact || number.mantissa >= sixteen_digits) return true;
  if (number.mantissa < thirteen_digits) return false;
  for (std::uint64_t tail = 10; tail <= 1000; tail *= 10) {
    const std::uint64_t before = number.mantissa / tail % 1'000'000;
    if (before == 0 || before == 999'999) return true;
  }
  return false;
}

void drop_zeros(Decimal& number, std::int64_t decimals) {
  for (; -number.exponent > decimals && number.mantissa % 10 == 0; ++number.exponent) number.mantissa /= 10;
}

bool same_number(Decimal a, Decimal b) {
  drop_zeros(a, 0);
  drop_zeros(b, 0);
  return a.mantissa == b.mantissa && a.exponent == b.exponent && a.negative == b.negative && a.exact == b.exact;
}

double value_of(const Decimal& number) {
  const double absolute = static_cast<double>(number.mantissa) * std::pow(10.0, static_cast<double>(number.exponent));
  return number.negative ? -absolute : absolute;
}

}  // namespace

CsvTimes::CsvTimes(CsvTimeOptions options) : options_(options) {
  if (options.decimals > options.most_decimals || options.most_decimals > 18)
    throw std::invalid_argument("CsvTimes: options out of range");
}

// Rounds a time, and says whether that changed it. Once the logger is seen to have printed a binary floating point
// number, all times are rounded to `options_.usual_decimals`; where the caller asks for rounding, those with more
// decimals than it asks for are.
bool CsvTimes::round(Decimal& time) {
  drop_zeros(time, 0);
  std::int64_t wanted = options_.most_decimals;
  if (!options_.rounding) {
    wanted = options_.usual_decimals;
    options_.binary = options_.binary || (-time.exponent > wanted && was_binary(time));
    if (!options_.binary) return false;
  }
  if (-time.exponent <= wanted) return false;
  std::uint64_t rest = 0;
  for (; -time.exponent > wanted; ++time.exponent) {
    rest = time.mantissa % 10;
    time.mantissa /= 10;
  }
  if (rest >= 5) ++time.mantissa;
  time.exact = true;
  drop_zeros(time, 0);
  return true;
}

// Counts all times so far in units of so many decimals, if these are more than now. False where they do not fit.
bool CsvTimes::refine(std::int64_t decimals) {
  for (; options_.decimals < decimals; ++options_.decimals) {
    if (any_ && std::abs(last_) > furthest_time / 10) return false;
    if (!ticks_.empty() && std::abs(ticks_.front()) > furthest_time / 10) return false;
    last_ *= 10;
    for (std::int64_t& each : ticks_) each *= 10;
  }
  return true;
}

std::optional<CsvTimeFault> CsvTimes::put(Decimal time) {
  if (time.large) return CsvTimeFault::too_large;
  const Decimal written = time;
  const bool is_fine = -time.exponent > std::min<std::int64_t>(options_.usual_decimals, options_.most_decimals);
  const bool is_rounded = is_fine && round(time);
  std::uint64_t mantissa = time.mantissa;
  std::int64_t decimals = mantissa == 0 ? 0 : -time.exponent;
  for (; decimals > options_.decimals && mantissa % 10 == 0; --decimals) mantissa /= 10;
  if (!time.exact || decimals > options_.most_decimals) return CsvTimeFault::too_fine;
  if (!refine(decimals)) return CsvTimeFault::too_large;
  for (; decimals < options_.decimals && mantissa != 0; ++decimals)
    if (__builtin_mul_overflow(mantissa, std::uint64_t{10}, &mantissa)) return CsvTimeFault::too_large;
  if (mantissa > static_cast<std::uint64_t>(furthest_time)) return CsvTimeFault::too_large;
  const auto tick = time.negative ? -static_cast<std::int64_t>(mantissa) : static_cast<std::int64_t>(mantissa);
  if (any_ && tick <= last_) {
    if (!is_rounded && !last_rounded_) {
      if (tick < last_) return CsvTimeFault::decreasing;
    } else if (!same_number(written, last_written_)) {
      return value_of(written) < value_of(last_written_) ? CsvTimeFault::decreasing : CsvTimeFault::merged;
    }
  }
  ticks_.push_back(tick);
  last_ = tick;
  last_written_ = written;
  last_rounded_ = is_rounded;
  rounded_ = rounded_ || is_rounded;
  any_ = true;
  return std::nullopt;
}

}  // namespace tachk::csv
