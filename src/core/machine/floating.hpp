// Floating point operations of models. A double takes two slots: its high and its low half.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace tachk::machine {

// The numbers of src/tachk/model/floating.py; a test compares them.
enum class FloatingOperation : std::int32_t {
  add = 0,
  subtract = 1,
  multiply = 2,
  divide = 3,
  minimum = 4,
  maximum = 5,
  negate = 6,
  absolute = 7,
  square_root = 8,
  floor = 9,
  ceiling = 10,
  truncate = 11,
  round = 12,
  from_integer = 13,
  to_integer = 14,
  equal = 15,
  not_equal = 16,
  less = 17,
  less_equal = 18,
  greater = 19,
  greater_equal = 20,
  exponential = 21,
  logarithm = 22,
  decimal_logarithm = 23,
  binary_logarithm = 24,
  sine = 25,
  cosine = 26,
  tangent = 27,
  arc_sine = 28,
  arc_cosine = 29,
  arc_tangent = 30,
  random = 31,
  arc_tangent_2 = 32,
  power = 33,
  remainder = 34,
  hypotenuse = 35,
  random_normal = 36,
  random_poisson = 37,
  random_arcsine = 38,
  random_gamma = 39,
  random_beta = 40,
  random_weibull = 41,
  random_triangular = 42,
};

// The double in two slots.
inline double double_at(const std::int32_t* slots) {
  const std::uint64_t high = static_cast<std::uint32_t>(slots[0]);
  return std::bit_cast<double>(high << 32 | static_cast<std::uint32_t>(slots[1]));
}
inline void store_double(double number, std::int32_t* slots) {
  const auto bits = std::bit_cast<std::uint64_t>(number);
  slots[0] = static_cast<std::int32_t>(static_cast<std::uint32_t>(bits >> 32));
  slots[1] = static_cast<std::int32_t>(static_cast<std::uint32_t>(bits));
}

// Where random numbers come from.
class Dice {
 public:
  virtual double fraction() = 0;  // in [0, 1)

 protected:
  ~Dice() = default;
};

constexpr bool gives_double(FloatingOperation operation) {
  return operation <= FloatingOperation::from_integer || operation >= FloatingOperation::exponential;
}

constexpr bool draws(FloatingOperation operation) {
  return operation == FloatingOperation::random || operation >= FloatingOperation::random_normal;
}

// An operation on the doubles in the slots left and right, of which those with one argument take the left one;
// from_integer takes the number left. A double is stored in the slot target and the next, and the result is that slot.
// Nothing if the result is not finite, or does not fit an integer. Throws std::logic_error for a slot that is not
// there, and for a random number where there are no dice.
std::optional<std::int32_t> operate(FloatingOperation operation, std::int32_t left, std::int32_t right,
                                    std::int32_t target, std::int32_t* memory, std::size_t slots, Dice* dice = nullptr);

}  // namespace tachk::machine
