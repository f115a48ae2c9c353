#include "machine/floating.hpp"

#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace tachk {
namespace {

using Integers = std::numeric_limits<std::int32_t>;

// What depends on the library of C.
double of_library(FloatingOperation operation, double left, double right) {
  switch (operation) {
    case FloatingOperation::exponential:
      return std::exp(left);
    case FloatingOperation::logarithm:
      return std::log(left);
    case FloatingOperation::decimal_logarithm:
      return std::log10(left);
    case FloatingOperation::binary_logarithm:
      return std::log2(left);
    case FloatingOperation::sine:
      return std::sin(left);
    case FloatingOperation::cosine:
      return std::cos(left);
    case FloatingOperation::tangent:
      return std::tan(left);
    case FloatingOperation::arc_sine:
      return std::asin(left);
    case FloatingOperation::arc_cosine:
      return std::acos(left);
    case FloatingOperation::arc_tangent:
      return std::atan(left);
    case FloatingOperation::arc_tangent_2:
      return std::atan2(left, right);
    case FloatingOperation::power:
      return std::pow(left, right);
    case FloatingOperation::remainder:
      return std::fmod(left, right);
    case FloatingOperation::hypotenuse:
      return std::hypot(left, right);
    default:
      throw std::logic_error("unknown floating point operation");
  }
}

double computed(FloatingOperation operation, double left, double right) {
  switch (operation) {
    case FloatingOperation::add:
      return left + right;
    case FloatingOperation::subtract:
      return left - right;
    case FloatingOperation::multiply:
      return left * right;
    case FloatingOperation::divide:
      return right == 0 ? std::numeric_limits<double>::infinity() : left / right;
    case FloatingOperation::minimum:
      return right < left ? right : left;
    case FloatingOperation::maximum:
      return right > left ? right : left;
    case FloatingOperation::negate:
      return -left;
    case FloatingOperation::absolute:
      return std::fabs(left);
    case FloatingOperation::square_root:
      return std::sqrt(left);
    case FloatingOperation::floor:
      return std::floor(left);
    case FloatingOperation::ceiling:
      return std::ceil(left);
    case FloatingOperation::truncate:
    case FloatingOperation::to_integer:
      return std::trunc(left);
    case FloatingOperation::round:
      return std::round(left);
    case FloatingOperation::equal:
      return left == right;
    case FloatingOperation::not_equal:
      return left != right;
    case FloatingOperation::less:
      return left < right;
    case FloatingOperation::less_equal:
      return left <= right;
    case FloatingOperation::greater:
      return left > right;
    case FloatingOperation::greater_equal:
      return left >= right;
    default:
      return of_library(operation, left, right);
  }
}

double drawn(FloatingOperation operation, double left, double right, Dice* dice) {
  if (dice == nullptr) throw std::logic_error("random numbers are drawn in simulations only");
  if (operation == FloatingOperation::random) return dice->fraction() * left;
  // Box and Muller, "A note on the generation of random normal deviates", 1958.
  constexpr double turn = 6.283185307179586476925;
  const double radius = std::sqrt(-2 * std::log(1 - dice->fraction()));
  return left + right * radius * std::cos(turn * dice->fraction());
}

}  // namespace

std::optional<std::int32_t> operate(FloatingOperation operation, std::int32_t left, std::int32_t right,
                                    std::int32_t target, std::int32_t* memory, std::size_t slots, Dice* dice) {
  const auto halves = [&](std::int32_t slot) {
    if (slot < 0 || static_cast<std::size_t>(slot) + 1 >= slots) throw std::logic_error("a double outside the memory");
    return memory + slot;
  };
  const auto number = [&](std::int32_t slot) {
    const std::int32_t* const cells = halves(slot);
    const auto high = static_cast<std::uint64_t>(static_cast<std::uint32_t>(cells[0]));
    return std::bit_cast<double>((high << 32) | static_cast<std::uint32_t>(cells[1]));
  };
  const bool exact = operation >= FloatingOperation::negate && operation <= FloatingOperation::to_integer;
  const bool unary = exact || (operation >= FloatingOperation::exponential && operation <= FloatingOperation::random);
  const auto result_of = [&] {
    if (operation == FloatingOperation::from_integer) return static_cast<double>(left);
    const double first = number(left);
    const double second = unary ? 0 : number(right);
    const bool draws = operation == FloatingOperation::random || operation == FloatingOperation::random_normal;
    return draws ? drawn(operation, first, second, dice) : computed(operation, first, second);
  };
  const double result = result_of();
  if (!std::isfinite(result)) return std::nullopt;
  if (!gives_double(operation)) {
    if (result < Integers::min() || result > Integers::max()) return std::nullopt;
    return static_cast<std::int32_t>(result);
  }
  const auto bits = std::bit_cast<std::uint64_t>(result);
  std::int32_t* const cells = halves(target);
  cells[0] = static_cast<std::int32_t>(static_cast<std::uint32_t>(bits >> 32));
  cells[1] = static_cast<std::int32_t>(static_cast<std::uint32_t>(bits));
  return target;
}

}  // namespace tachk
