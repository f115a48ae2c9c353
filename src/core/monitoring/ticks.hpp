// Times in floating point as whole numbers of ticks. A floating-point number is taken for the decimal number that it
// prints as, if that has at most fifteen digits; such a number is the only one of so few decimals that prints like
// this.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace tachk::monitoring {

__extension__ typedef __int128 int128;

inline constexpr int most_decimals = 18;

// How many ticks make a unit of time: 10^decimals times `parts`.
class TickScale {
 public:
  // Throws std::invalid_argument for decimals below 0 or above `most_decimals`, and for ticks that do not fit.
  TickScale(int decimals, std::int64_t parts);

  std::int64_t ticks_per_unit() const { return ticks_; }
  // The tick of a finite time: of the decimal number that it prints as, else the nearest. None if it is too large.
  std::optional<int128> tick(double time);

 private:
  int decimals_;
  std::int64_t parts_;
  std::int64_t ticks_;
  int last_ = 0;  // the decimals of the time before, tried first
};

// The times of a whole trace, in units of 10^-decimals, from the first one on.
struct CountedTimes {
  enum class Fault { none, not_finite, too_large, merged, backwards };
  std::int64_t first = 0;
  int decimals = 0;
  Fault fault = Fault::none;
  std::size_t row = 0;  // of the fault
  bool rounded = false;
};

// In the fewest decimals in which all times are whole. Where there are none, as many as keep different neighbours
// different, at least `usual`; then rounded to the nearest. Writes as many ticks as there are times.
CountedTimes counted(std::span<const double> times, int usual, std::int64_t* ticks);

// Writes the ticks of times that are whole in units of 10^-decimals, counted from the unit `first` on, each unit
// `factor` ticks. The ticks are `wrong` where one is not, or too large for that, or lies before the one above, of which
// the first is `before`. There is a time.
enum class CountedAs { wrong, rising, rising_strictly };
CountedAs counted_as(std::span<const double> times, double before, int decimals, std::int64_t first,
                     std::int64_t factor, std::int64_t* ticks);

// The first row with an earlier time than the row before; `count` if there is none.
std::size_t first_backwards(const std::int64_t* times, std::size_t count);

// Writes the ticks of whole times of which each is `factor` ticks, the first at `start`. Returns whether no time lies
// before the one above. There is a time; ticks that do not fit into 64 bits are wrong.
bool scaled(const std::int64_t* times, std::size_t count, std::int64_t factor, std::int64_t start, std::int64_t* ticks);

bool all_finite(const double* values, std::size_t count);

}  // namespace tachk::monitoring
