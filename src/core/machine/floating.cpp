#include "machine/floating.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "machine/distributions.hpp"

namespace tachk::machine {
namespace {

using Integers = std::numeric_limits<std::int32_t>;

// Functions that depend on the library of C.
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

}  // namespace

std::optional<std::int32_t> operate(FloatingOperation operation, std::int32_t left, std::int32_t right,
                                    std::int32_t target, std::int32_t* memory, std::size_t slots, Dice* dice) {
  const auto halves = [&](std::int32_t slot) {
    if (slot < 0 || static_cast<std::size_t>(slot) + 1 >= slots) throw std::logic_error("a double outside the memory");
    return memory + slot;
  };
  const auto number = [&](std::int32_t slot) { return double_at(halves(slot)); };
  const bool exact = operation >= FloatingOperation::negate && operation <= FloatingOperation::to_integer;
  const bool unary = exact || (operation >= FloatingOperation::exponential && operation <= FloatingOperation::random) ||
                     operation == FloatingOperation::random_poisson ||
                     operation == FloatingOperation::random_triangular;
  const auto result_of = [&] {
    if (operation == FloatingOperation::from_integer) return static_cast<double>(left);
    const double first = number(left);
    const double second = unary ? 0 : number(right);
    if (!draws(operation)) return computed(operation, first, second);
    if (dice == nullptr) throw std::logic_error("random numbers are drawn in simulations only");
    return drawn(operation, first, second, *dice);
  };
  const double result = result_of();
  if (!std::isfinite(result)) return std::nullopt;
  if (!gives_double(operation)) {
    if (result < Integers::min() || result > Integers::max()) return std::nullopt;
    return static_cast<std::int32_t>(result);
  }
  store_double(result, halves(target));
  return target;
}

}  // namespace tachk::machine
