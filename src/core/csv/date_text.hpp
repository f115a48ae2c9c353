// A date and time of ISO 8601 within a line of text, such as 2026-03-01T12:00:00.25+01:00; without a zone it is
// universal time. The line ends with a line break, so no length is needed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace tachk::csv {

struct DateText {
  static constexpr std::int64_t most_decimals = 18;

  const char* p;
  bool right = true;         // what stands there is a date
  bool too_fine = false;     // the fraction has more digits than can be kept
  std::int64_t seconds = 0;  // since 1970, without their fraction
  std::int64_t fraction = 0;
  std::int64_t decimals = 0;  // of the fraction

  // Leaves `p` behind the date. A comma begins a fraction where it separates no cells.
  void scan(char separator) {
    const std::int64_t year = digits(4);
    sign('-');
    const std::int64_t month = digits(2);
    sign('-');
    const std::int64_t day = digits(2);
    right = right && month >= 1 && month <= 12 && day >= 1 && day <= days_of(year, month);
    if (!right) return;
    seconds = 86400 * days_since_1970(year, month, day);
    if (*p == 'T' || *p == 't' || (*p == ' ' && is_digit(p[1]))) scan_clock(separator);
  }
  // The next character is this one.
  void sign(char wanted) {
    right = right && *p == wanted;
    if (right) ++p;
  }

 private:
  static bool is_digit(char c) { return static_cast<unsigned char>(c - '0') < 10; }

  static std::int64_t days_of(std::int64_t year, std::int64_t month) {
    constexpr std::array<std::int64_t, 12> days = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    const bool leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    return days[static_cast<std::size_t>(month - 1)] + (leap && month == 2 ? 1 : 0);
  }

  // In the proleptic Gregorian calendar: years begin with March, so that the day too many is the last one of a year,
  // and 400 years have 146,097 days (Hinnant, days_from_civil). 1970-01-01 is the day 719,468 from 0000-03-01.
  static std::int64_t days_since_1970(std::int64_t year, std::int64_t month, std::int64_t day) {
    const std::int64_t shifted = month <= 2 ? year + 399 : year + 400;
    const std::int64_t of_era = shifted % 400;
    const std::int64_t of_year = (153 * (month > 2 ? month - 3 : month + 9) + 2) / 5 + day - 1;
    return (shifted / 400 - 1) * 146097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719468;
  }

  std::int64_t digits(int count) {
    std::int64_t number = 0;
    for (int n = 0; n < count; ++n) {
      right = right && is_digit(*p);
      if (right) number = 10 * number + (*p++ - '0');
    }
    return number;
  }

  void scan_clock(char separator) {
    ++p;
    const std::int64_t hour = digits(2);
    std::int64_t minute = 0;
    std::int64_t second = 0;
    if (right && *p == ':') {
      ++p;
      minute = digits(2);
      if (right && *p == ':') {
        ++p;
        second = digits(2);
        if (right && (*p == '.' || (*p == ',' && separator != ',')) && is_digit(p[1])) scan_fraction();
      }
    }
    right = right && hour < 24 && minute < 60 && second < 60;
    seconds += 3600 * hour + 60 * minute + second;
    if (right && (*p == 'Z' || *p == 'z')) {
      ++p;
    } else if (right && (*p == '+' || *p == '-')) {
      scan_zone();
    }
  }

  void scan_fraction() {
    for (++p; is_digit(*p); ++p) {
      if (decimals == most_decimals) {
        too_fine = too_fine || *p != '0';
        continue;
      }
      fraction = 10 * fraction + (*p - '0');
      ++decimals;
    }
    for (; decimals > 0 && fraction % 10 == 0; --decimals) fraction /= 10;
  }

  void scan_zone() {
    const std::int64_t way = *p++ == '+' ? -1 : 1;
    const std::int64_t hours = digits(2);
    std::int64_t minutes = 0;
    if (right && *p == ':') {
      ++p;
      minutes = digits(2);
    } else if (right && is_digit(*p)) {
      minutes = digits(2);
    }
    right = right && hours < 24 && minutes < 60;
    seconds += way * (3600 * hours + 60 * minutes);
  }
};

}  // namespace tachk::csv
