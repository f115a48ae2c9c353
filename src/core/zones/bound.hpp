// Bounds of difference constraints as integers: 2c for "< c", 2c + 1 for "<= c" (Dill 1989; Bengtsson, Yi 2004).
#pragma once

#include <cstdint>

namespace tachk::zones {

using Raw = std::int64_t;

inline constexpr Raw raw_zero = 1;  // "<= 0"

constexpr Raw raw_bound(Raw value, bool strict) { return 2 * value + (strict ? 0 : 1); }
constexpr Raw raw_value(Raw raw) { return raw >> 1; }
constexpr Raw raw_negated(Raw raw) { return 1 - raw; }  // not (x < c) is (-x <= -c), and the other way round

// Of two finite bounds.
constexpr Raw plus(Raw a, Raw b) { return a + b - ((a | b) & 1); }

// The constants of a bound type. A finite entry of a zone stays within (-legal, legal); adding two of them, or one to
// `beyond`, cannot overflow, and the latter never falls below `infinity`.
template <class T>
struct BoundLimits;

template <>
struct BoundLimits<std::int16_t> {
  static constexpr std::int16_t infinity = 1 << 14;
  static constexpr std::int16_t beyond = (1 << 14) + (1 << 13);
  static constexpr std::int16_t legal = 1 << 13;
  static constexpr Raw largest_constant = 800;
};

template <>
struct BoundLimits<std::int32_t> {
  static constexpr std::int32_t infinity = 1 << 30;
  static constexpr std::int32_t beyond = (1 << 30) + (1 << 29);
  static constexpr std::int32_t legal = 1 << 29;
  static constexpr Raw largest_constant = (1 << 26) - 1;
};

template <>
struct BoundLimits<std::int64_t> {
  static constexpr std::int64_t infinity = std::int64_t{1} << 62;
  static constexpr std::int64_t beyond = (std::int64_t{1} << 62) + (std::int64_t{1} << 61);
  static constexpr std::int64_t legal = std::int64_t{1} << 61;
  static constexpr Raw largest_constant = (std::int64_t{1} << 40) - 1;
};

// x_left - x_right < or <= c.
struct Atom {
  std::uint16_t left;
  std::uint16_t right;
  Raw raw;

  friend bool operator==(const Atom&, const Atom&) = default;
};

constexpr Atom negated(Atom atom) { return {atom.right, atom.left, raw_negated(atom.raw)}; }

// Sets a clock to the value of `source`, which may be the clock itself, and so much more; 0 is the reference clock.
struct ClockReset {
  std::uint16_t clock;
  std::int32_t value;
  std::uint16_t source = 0;
};

}  // namespace tachk::zones
