#include "csv/csv_times.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <stdexcept>

namespace tachk::csv {

namespace {

constexpr std::int64_t furthest_time = std::numeric_limits<std::int64_t>::max() / 2;

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

// Reads a time that a double prints as as the shortest decimal number of the double, and says whether that changed it.
bool CsvTimes::shorten(Decimal& time) {
  if (!options_.shortening || unprinted_) return false;
  drop_zeros(time, 0);
  if (!may_be_double(time)) return false;
  const auto shortest = shorter_if_double(time);
  if (!shortest) {
    unprinted_ = true;
    return false;
  }
  const bool is_shorter = !time.exact || shortest->mantissa != time.mantissa;
  time = *shortest;
  return is_shorter;
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
  const bool is_shorter = may_be_double(time) && shorten(time);
  const bool is_fine = -time.exponent > std::min<std::int64_t>(options_.usual_decimals, options_.most_decimals);
  const Decimal unrounded = time;
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
    if (!is_rounded && !is_shorter && !last_changed_) {
      if (tick < last_) return CsvTimeFault::decreasing;
    } else if (!same_number(unrounded, last_unrounded_)) {
      return value_of(unrounded) < value_of(last_unrounded_) ? CsvTimeFault::decreasing : CsvTimeFault::merged;
    }
  }
  ticks_.push_back(tick);
  last_ = tick;
  last_unrounded_ = unrounded;
  last_changed_ = is_rounded || is_shorter;
  rounded_ = rounded_ || is_rounded;
  shortened_ = shortened_ || is_shorter;
  any_ = true;
  return std::nullopt;
}

}  // namespace tachk::csv
