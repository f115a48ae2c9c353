#include "csv/csv_times.hpp"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

namespace tachk::csv {

namespace {

bool same_number(Decimal a, Decimal b) {
  drop_zeros(a, 0);
  drop_zeros(b, 0);
  return a.mantissa == b.mantissa && a.exponent == b.exponent && a.negative == b.negative && a.exact == b.exact;
}

bool is_smaller(Decimal a, Decimal b) {
  // A time that does not fit in the finer unit is larger than the other, which fits.
  for (; a.exponent > b.exponent && a.mantissa != 0; --a.exponent)
    if (__builtin_mul_overflow(a.mantissa, std::uint64_t{10}, &a.mantissa)) return false;
  for (; b.exponent > a.exponent && b.mantissa != 0; --b.exponent)
    if (__builtin_mul_overflow(b.mantissa, std::uint64_t{10}, &b.mantissa)) return true;
  return a.mantissa < b.mantissa;
}

bool is_before(const Decimal& a, const Decimal& b) {
  if (a.negative != b.negative) return a.negative;
  return a.negative ? is_smaller(b, a) : is_smaller(a, b);
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
    if (any_ && std::abs(last_) > furthest / 10) return false;
    if (!ticks_.empty() && std::abs(ticks_.front()) > furthest / 10) return false;
    last_ *= 10;
    for (std::int64_t& each : ticks_) each *= 10;
  }
  return true;
}

// As many units finer by so many decimals, or -1 where they do not fit.
std::int64_t CsvTimes::scaled(std::int64_t tick, std::int64_t decimals) {
  for (; decimals > 0; --decimals)
    if (__builtin_mul_overflow(tick, std::int64_t{10}, &tick)) return -1;
  return tick <= furthest ? tick : -1;
}

// The last time before it was rounded.
Decimal CsvTimes::last_unrounded() const {
  if (last_changed_) return last_before_;
  return {static_cast<std::uint64_t>(std::abs(last_)), -static_cast<std::int64_t>(options_.decimals), last_ < 0};
}

CsvTimeFault CsvTimes::put_other(Decimal time) {
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
  if (mantissa > static_cast<std::uint64_t>(furthest)) return CsvTimeFault::too_large;
  const auto tick = time.negative ? -static_cast<std::int64_t>(mantissa) : static_cast<std::int64_t>(mantissa);
  if (any_ && tick <= last_) {
    if (!is_rounded && !is_shorter && !last_changed_) {
      if (tick < last_) return CsvTimeFault::decreasing;
    } else if (const Decimal before = last_unrounded(); !same_number(unrounded, before)) {
      return is_before(unrounded, before) ? CsvTimeFault::decreasing : CsvTimeFault::merged;
    }
  }
  ticks_.push_back(tick);
  last_ = tick;
  last_changed_ = is_rounded || is_shorter;
  if (last_changed_) last_before_ = unrounded;
  rounded_ = rounded_ || is_rounded;
  shortened_ = shortened_ || is_shorter;
  any_ = true;
  return CsvTimeFault::none;
}

}  // namespace tachk::csv
