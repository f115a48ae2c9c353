// The column of exact decimal times: counted in units of the finest decimal among them.
//
// Programs that add 0.1 again and again write 0.30000000000000004: as soon as a time was a binary number, all are taken
// for that, and rounded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace tachk::csv {

// A decimal number as mantissa * 10^exponent. `exact` is false where the mantissa has more digits than fit, `large`
// says that some of them stand before the point.
struct Decimal {
  std::uint64_t mantissa = 0;
  std::int64_t exponent = 0;
  bool negative = false;
  bool exact = true;
  bool large = false;
};

struct CsvTimeOptions {
  std::uint32_t decimals = 0;        // the times are counted in units of 10^-decimals at least
  std::uint32_t most_decimals = 18;  // a finer time is a fault
  std::uint32_t usual_decimals = 9;  // times that were binary numbers are rounded to them
  bool binary = false;               // all times were binary numbers, which shows in some of them only
  bool rounding = false;             // times finer than `most_decimals` are rounded to these
};

enum class CsvTimeFault {
  decreasing,
  too_large,  // it does not fit into 64 bits of ticks
  too_fine,   // it has more decimals than allowed
  merged,     // rounded, it is the same as that of the row above, which is another one
};

class CsvTimes {
 public:
  explicit CsvTimes(CsvTimeOptions options);

  std::optional<CsvTimeFault> put(Decimal time);
  std::uint32_t decimals() const { return options_.decimals; }
  // Whether some time was rounded.
  bool rounded() const { return rounded_; }

  std::size_t size() const { return ticks_.size(); }
  void reserve(std::size_t rows) { ticks_.reserve(rows); }
  void resize(std::size_t rows) { ticks_.resize(rows); }
  std::vector<std::int64_t> take() { return std::exchange(ticks_, {}); }

 private:
  bool round(Decimal& time);
  bool refine(std::int64_t decimals);

  CsvTimeOptions options_;
  bool any_ = false;
  bool rounded_ = false;
  std::int64_t last_ = 0;
  Decimal last_written_;  // the same as it stands in its row
  bool last_rounded_ = false;
  std::vector<std::int64_t> ticks_;
};

}  // namespace tachk::csv
