// The column of exact decimal times: counted in units of the finest decimal among them.
//
// Programs that add 0.1 again and again write 0.30000000000000004: as soon as a time was a binary number, all are taken
// for that, and rounded. Programs that print 1764000000.1 with 17 digits write 1764000000.0999999: what a double prints
// as is read as the shortest decimal number of that double, unless some time cannot have been printed from one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "decimals/decimal.hpp"

namespace tachk::csv {

using decimals::Decimal;

struct CsvTimeOptions {
  std::uint32_t decimals = 0;        // the times are counted in units of 10^-decimals at least
  std::uint32_t most_decimals = 18;  // a finer time is a fault
  std::uint32_t usual_decimals = 9;  // times that were binary numbers are rounded to them
  bool binary = false;               // all times were binary numbers, which shows in some of them only
  bool rounding = false;             // times finer than `most_decimals` are rounded to these
  bool shortening = true;            // times as doubles are printed are read as their shortest decimal numbers
};

enum class CsvTimeFault {
  none,
  decreasing,
  too_large,  // it does not fit into 64 bits of ticks
  too_fine,   // it has more decimals than allowed
  merged,     // rounded, it is the same as that of the row above, which is another one
};

class CsvTimes {
 public:
  explicit CsvTimes(CsvTimeOptions options);

  CsvTimeFault put(const Decimal& time) { return put_plain(time) ? CsvTimeFault::none : put_other(time); }
  std::uint32_t decimals() const { return options_.decimals; }
  // True if some time was rounded.
  bool rounded() const { return rounded_; }
  // True if some time was read as the shorter decimal number of a double.
  bool shortened() const { return shortened_; }
  // True if some time has as many digits, and is not what a double prints as.
  bool unprinted() const { return unprinted_; }

  std::size_t size() const { return ticks_.size(); }
  void reserve(std::size_t rows) { ticks_.reserve(rows); }
  void resize(std::size_t rows) { ticks_.resize(rows); }
  std::vector<std::int64_t> take() { return std::exchange(ticks_, {}); }

 private:
  static constexpr std::int64_t furthest = std::numeric_limits<std::int64_t>::max() / 2;

  // The usual case, without a copy of the number: a short time behind the one before, counted in units that are known.
  bool put_plain(const Decimal& time) {
    const std::int64_t places = -time.exponent;
    if (!time.exact || places < 0 || places > options_.decimals || places > options_.usual_decimals) return false;
    if (time.mantissa > static_cast<std::uint64_t>(furthest) || decimals::may_be_double(time)) return false;
    auto tick = static_cast<std::int64_t>(time.mantissa);
    if (places != options_.decimals) tick = scaled(tick, options_.decimals - places);
    if (tick < 0) return false;
    if (time.negative) tick = -tick;
    if (any_ && tick < last_ + (last_changed_ ? 1 : 0)) return false;
    ticks_.push_back(tick);
    last_ = tick;
    last_changed_ = false;
    any_ = true;
    return true;
  }
  CsvTimeFault put_other(Decimal time);
  static std::int64_t scaled(std::int64_t tick, std::int64_t decimals);
  Decimal last_unrounded() const;
  bool shorten(Decimal& time);
  bool round(Decimal& time);
  bool refine(std::int64_t decimals);

  CsvTimeOptions options_;
  bool any_ = false;
  bool rounded_ = false;
  bool shortened_ = false;
  bool unprinted_ = false;
  std::int64_t last_ = 0;
  bool last_changed_ = false;  // rounded or shortened
  Decimal last_before_;        // the last one before it was changed, if it was
  std::vector<std::int64_t> ticks_;
};

}  // namespace tachk::csv
