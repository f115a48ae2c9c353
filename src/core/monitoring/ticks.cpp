#include "monitoring/ticks.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "decimals/decimal.hpp"

namespace tachk::monitoring {

using decimals::Decimal;
using decimals::shortest_decimal;

namespace {

constexpr std::array<double, 19> powers = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8, 1e9,
                                           1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18};
constexpr int most_exact_decimals = 15;
constexpr double most_digits = 9007199254740992.0;  // 2^53: products beyond are not exact
constexpr double furthest = 4611686018427387904.0;  // 2^62
constexpr double furthest_of_all = 1e36;            // fits into 128 bits

constexpr double exact_below = 2251799813685248.0;  // 2^51: fifteen digits

// A sum with it has no room for a fraction: the nearest whole number of one below 2^51.
constexpr double rounder = 6755399441055744.0;  // 1.5 * 2^52

double nearest(double number) { return (number + rounder) - rounder; }

constexpr std::array<std::int64_t, 19> whole_powers = [] {
  std::array<std::int64_t, 19> result{1};
  for (std::size_t n = 1; n < result.size(); ++n) result[n] = 10 * result[n - 1];
  return result;
}();

std::int64_t power_of_ten(int exponent) { return whole_powers[static_cast<std::size_t>(exponent)]; }

struct Counting {
  bool exact;
  bool rising;
  bool strictly;
};

// Counts a block in units of 1 / power from the tick `first` on, and looks whether that is exact for all of it and no
// time lies before the one above, of which the first is `before`. Without jumps inside and with masks as wide as the
// numbers, so that the compiler uses vectors.
//
// A time is the number that prints as whole / power if that quotient is nearest to it. Where products can be had
// without rounding, a division is saved: the two differ by at most half a unit in the last place of the time, which is
// never exactly so (whole / power would have more binary digits than whole itself).
template <bool Fused>
[[gnu::always_inline]] inline Counting count_block_as(const double* times, std::size_t count, double before,
                                                      double power, std::int64_t first, std::int64_t* ticks) {
  const std::int64_t offset = std::bit_cast<std::int64_t>(rounder) + first;
  constexpr std::uint64_t all = ~std::uint64_t{0};
  constexpr std::uint64_t exponent = 0x7ff0'0000'0000'0000;
  const double half_unit = power * 0x1p-53;  // for each unit of the highest binary digit
  std::uint64_t inexact = 0;
  std::uint64_t staying = before < times[0] ? 0 : all;
  for (std::size_t n = 0; n < count; ++n) {
    const double time = times[n];
    const double shifted = Fused ? __builtin_fma(time, power, rounder) : time * power + rounder;
    const double whole = shifted - rounder;
    if constexpr (Fused) {
      const double highest = std::bit_cast<double>(std::bit_cast<std::uint64_t>(time) & exponent);
      inexact |= std::fabs(__builtin_fma(time, power, -whole)) <= highest * half_unit ? 0 : all;
    } else {
      inexact |= whole / power == time ? 0 : all;
    }
    ticks[n] = std::bit_cast<std::int64_t>(shifted) - offset;
  }
  for (std::size_t n = 1; n < count; ++n) staying |= times[n - 1] < times[n] ? 0 : all;
  if (staying == 0) return {inexact == 0, true, true};
  std::uint64_t falling = before <= times[0] ? 0 : all;
  for (std::size_t n = 1; n < count; ++n) falling |= times[n - 1] <= times[n] ? 0 : all;  // not a number falls
  return {inexact == 0, falling == 0, false};
}

// A number that is not finite has all bits of its exponent set. Integers can be joined in any order, so vectors are
// used.
[[gnu::always_inline]] inline bool all_finite_as(const double* values, std::size_t count) {
  constexpr std::uint64_t exponent = 0x7ff0'0000'0000'0000;
  constexpr std::size_t block = 1024;
  for (std::size_t first = 0; first < count; first += block) {
    const std::size_t end = std::min(first + block, count);
    std::uint64_t infinite = 0;
    for (std::size_t n = first; n < end; ++n)
      infinite |= (std::bit_cast<std::uint64_t>(values[n]) & exponent) + (exponent & -exponent);
    if (infinite >> 63) return false;
  }
  return true;
}

// Products that do not fit are wrong, but defined.
[[gnu::always_inline]] inline bool scale_as(const std::int64_t* times, std::size_t count, std::int64_t factor,
                                            std::int64_t start, std::int64_t* ticks) {
  const auto parts = static_cast<std::uint64_t>(factor);
  const auto first = static_cast<std::uint64_t>(times[0]);
  const auto from = static_cast<std::uint64_t>(start);
  std::uint64_t falling = 0;
  ticks[0] = start;
  for (std::size_t n = 1; n < count; ++n) {
    falling |= times[n - 1] <= times[n] ? 0 : ~std::uint64_t{0};
    ticks[n] = static_cast<std::int64_t>((static_cast<std::uint64_t>(times[n]) - first) * parts + from);
  }
  return falling == 0;
}

// Functions in two forms, for the vectors that every machine has and for wider ones.
struct Loops {
  Counting (*count_block)(const double*, std::size_t, double, double, std::int64_t, std::int64_t*);
  bool (*all_finite)(const double*, std::size_t);
  bool (*scale)(const std::int64_t*, std::size_t, std::int64_t, std::int64_t, std::int64_t*);
};

#if defined(__x86_64__)
[[gnu::target("avx2,fma")]] Counting count_block_wide(const double* times, std::size_t count, double before,
                                                      double power, std::int64_t first, std::int64_t* ticks) {
  return count_block_as<true>(times, count, before, power, first, ticks);
}

[[gnu::target("avx2")]] bool all_finite_wide(const double* values, std::size_t count) {
  return all_finite_as(values, count);
}

[[gnu::target("avx2")]] bool scale_wide(const std::int64_t* times, std::size_t count, std::int64_t factor,
                                        std::int64_t start, std::int64_t* ticks) {
  return scale_as(times, count, factor, start, ticks);
}

constexpr Loops wide = {count_block_wide, all_finite_wide, scale_wide};
#endif

Counting count_block_plain(const double* times, std::size_t count, double before, double power, std::int64_t first,
                           std::int64_t* ticks) {
  return count_block_as<false>(times, count, before, power, first, ticks);
}

bool all_finite_plain(const double* values, std::size_t count) { return all_finite_as(values, count); }

bool scale_plain(const std::int64_t* times, std::size_t count, std::int64_t factor, std::int64_t start,
                 std::int64_t* ticks) {
  return scale_as(times, count, factor, start, ticks);
}

constexpr Loops plain_loops = {count_block_plain, all_finite_plain, scale_plain};

const Loops& loops() {
#if defined(__x86_64__)
  static const bool has_wide = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (has_wide) return wide;
#endif
  return plain_loops;
}

CountedTimes faulty(CountedTimes::Fault fault, std::size_t row) { return {0, 0, fault, row, false}; }

// Why times are not counted that are not all finite and rising.
CountedTimes disordered(std::span<const double> times) {
  for (std::size_t n = 0; n < times.size(); ++n)
    if (!std::isfinite(times[n])) return faulty(CountedTimes::Fault::not_finite, n);
  for (std::size_t n = 1;; ++n)
    if (times[n] < times[n - 1]) return faulty(CountedTimes::Fault::backwards, n);
}

// A decimal number in units of 10^-decimals, rounded half away from zero; it has to fit.
int128 counted_in(const Decimal& number, int decimals) {
  std::int64_t shift = number.exponent + decimals;
  int128 whole = static_cast<int128>(number.mantissa);
  for (; shift > 0 && whole != 0; --shift) whole *= 10;
  int128 rest = 0;
  for (; shift < 0 && (whole != 0 || rest != 0); ++shift) {
    rest = whole % 10;
    whole /= 10;
  }
  if (rest >= 5) ++whole;
  return number.negative ? -whole : whole;
}

// How many decimals the longest of the times needs.
int needed_decimals(std::span<const double> times) {
  std::int64_t needed = 0;
  for (const double time : times)
    if (time != 0) needed = std::max(needed, -shortest_decimal(time).exponent);
  return static_cast<int>(std::min<std::int64_t>(needed, most_decimals + 1));
}

CountedTimes rounded(std::span<const double> times, int usual, std::int64_t* ticks) {
  for (std::size_t n = 0; n < times.size(); ++n)
    if (!std::isfinite(times[n]) || (n > 0 && times[n] < times[n - 1])) return disordered(times);
  const double largest = std::max(std::fabs(times.front()), std::fabs(times.back()));
  if (largest >= furthest) return faulty(CountedTimes::Fault::too_large, largest > times.back() ? 0 : times.size() - 1);
  CountedTimes result;
  result.rounded = true;
  const auto fits = [&](int decimals, double limit) {
    return decimals <= most_decimals && largest * powers[static_cast<std::size_t>(decimals)] < limit;
  };
  int decimals = usual;
  if (!fits(decimals, exact_below)) {  // seconds since 1970 have few decimals, all of which can be counted
    const int needed = needed_decimals(times);
    result.rounded = needed > decimals;
    decimals = std::min(decimals, needed);
  }
  while (decimals > 0 && !fits(decimals, furthest)) --decimals, result.rounded = true;
  std::size_t merged = 0;
  const auto count = [&] {
    const double power = powers[static_cast<std::size_t>(decimals)];
    const bool exact = fits(decimals, exact_below);
    const auto tick = [&](double time) {
      if (exact) return static_cast<std::int64_t>(std::nearbyint(time * power));
      return static_cast<std::int64_t>(counted_in(shortest_decimal(time), decimals));
    };
    result.first = tick(times[0]);
    for (std::size_t n = 0; n < times.size(); ++n) ticks[n] = tick(times[n]) - result.first;
    for (merged = 1; merged < times.size(); ++merged)
      if (ticks[merged] == ticks[merged - 1] && times[merged] != times[merged - 1]) return false;
    return true;
  };
  if (!count()) {
    result.rounded = true;
    do {
      if (!fits(decimals + 1, furthest)) return faulty(CountedTimes::Fault::merged, merged);
      ++decimals;
    } while (!count());
    // Three more digits, so that gaps are right to a thousandth at least, as far as products are exact.
    const int enough = decimals;
    while (decimals < enough + 3 && fits(decimals + 1, most_digits)) ++decimals;
    if (decimals > enough) count();
  }
  result.decimals = decimals;
  return result;
}

}  // namespace

bool all_finite(const double* values, std::size_t count) { return loops().all_finite(values, count); }

bool scaled(const std::int64_t* times, std::size_t count, std::int64_t factor, std::int64_t start,
            std::int64_t* ticks) {
  return loops().scale(times, count, factor, start, ticks);
}

CountedAs counted_as(std::span<const double> times, double before, int decimals, std::int64_t first,
                     std::int64_t factor, std::int64_t* ticks) {
  if (decimals < 0 || decimals > most_exact_decimals) return CountedAs::wrong;
  const double power = powers[static_cast<std::size_t>(decimals)];
  // Of times that rise.
  const double largest = std::max(std::fabs(times.front()), std::fabs(times.back()));
  if (!(largest * power < exact_below)) return CountedAs::wrong;
  const Counting done = loops().count_block(times.data(), times.size(), before, power, first, ticks);
  if (!done.exact || !done.rising) return CountedAs::wrong;
  // Different times that are whole in these units are different ticks, as long as the last one fits.
  std::int64_t product = 0;
  const bool fits = factor == 1 || (factor > 0 && !__builtin_mul_overflow(ticks[0], factor, &product) &&
                                    !__builtin_mul_overflow(ticks[times.size() - 1], factor, &product));
  if (factor != 1)
    for (std::int64_t& tick : std::span(ticks, times.size()))
      tick = static_cast<std::int64_t>(static_cast<std::uint64_t>(tick) * static_cast<std::uint64_t>(factor));
  return done.strictly && fits ? CountedAs::rising_strictly : CountedAs::rising;
}

std::size_t first_backwards(const std::int64_t* times, std::size_t count) {
  constexpr std::size_t block = 1024;
  for (std::size_t first = 1; first < count; first += block) {
    const std::size_t end = std::min(first + block, count);
    std::uint64_t falls = 0;  // its highest bit: whether a time is less than the one before, also where that overflows
    for (std::size_t n = first; n < end; ++n) {
      const auto x = static_cast<std::uint64_t>(times[n]);
      const auto y = static_cast<std::uint64_t>(times[n - 1]);
      falls |= (x & ~y) | (~(x ^ y) & (x - y));
    }
    if ((falls >> 63) == 0) continue;
    for (std::size_t n = first; n < end; ++n)
      if (times[n] < times[n - 1]) return n;
  }
  return count;
}

TickScale::TickScale(int decimals, std::int64_t parts) : decimals_(decimals), parts_(parts) {
  if (decimals < 0 || decimals > most_decimals || parts < 1 ||
      __builtin_mul_overflow(power_of_ten(decimals), parts, &ticks_))
    throw std::invalid_argument("a scale has 0 to 18 decimals, and its ticks fit into 64 bits");
}

std::optional<int128> TickScale::tick(double time) {
  const double size = std::fabs(time);
  const auto exactly = [&](int decimals) -> std::optional<int128> {
    const double power = powers[static_cast<std::size_t>(decimals)];
    if (size * power >= exact_below) return std::nullopt;
    const double whole = nearest(time * power);
    if (whole / power != time) return std::nullopt;
    last_ = decimals;
    return int128{static_cast<std::int64_t>(whole)} * power_of_ten(decimals_ - decimals) * parts_;
  };
  const int most = std::min(decimals_, most_exact_decimals);
  if (last_ <= most)
    if (const auto found = exactly(last_)) return found;
  for (int decimals = 0; decimals <= most; ++decimals)
    if (const auto found = exactly(decimals)) return found;
  const double product = time * static_cast<double>(ticks_);
  if (!(std::fabs(product) < furthest_of_all)) return std::nullopt;
  if (std::fabs(product) >= exact_below && parts_ == 1) return counted_in(shortest_decimal(time), decimals_);
  return static_cast<int128>(std::nearbyint(product));
}

CountedTimes counted(std::span<const double> times, int usual, std::int64_t* ticks) {
  constexpr std::size_t block = 1024;
  const auto count_block = loops().count_block;
  CountedTimes result;
  if (times.empty()) return result;
  if (!std::isfinite(times.front()) || !std::isfinite(times.back())) return disordered(times);
  // Of times that rise.
  const double largest = std::max(std::fabs(times.front()), std::fabs(times.back()));
  int decimals = 0;
  for (std::size_t first = 0; first < times.size(); first += block) {
    const std::size_t count = std::min(block, times.size() - first);
    const double* const part = times.data() + first;
    for (const int before = decimals;; ++decimals) {
      if (decimals > most_exact_decimals) return rounded(times, usual, ticks);
      const double power = powers[static_cast<std::size_t>(decimals)];
      if (largest * power >= exact_below) return rounded(times, usual, ticks);
      const auto start = static_cast<std::int64_t>(nearest(times[0] * power));
      const Counting done = count_block(part, count, times[first - (first > 0)], power, start, ticks + first);
      if (!done.rising) return disordered(times);
      if (!done.exact) continue;
      result.first = start;
      if (decimals > before) {  // what was counted before is exact in these units too
        const std::int64_t factor = power_of_ten(decimals - before);
        for (std::size_t n = 0; n < first; ++n) ticks[n] *= factor;
      }
      break;
    }
  }
  const auto is_long = [&](double time) {
    const Decimal number = shortest_decimal(time);
    return -number.exponent > usual && was_binary(number);
  };
  if (decimals > usual && std::any_of(times.begin(), times.end(), is_long)) return rounded(times, usual, ticks);
  result.decimals = decimals;
  return result;
}

}  // namespace tachk::monitoring
