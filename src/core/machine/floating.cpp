#include "machine/floating.hpp"

#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace tachk {
namespace {

using Integers = std::numeric_limits<std::int32_t>;

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
    case FloatingOperation::from_integer:
      break;
  }
  throw std::logic_error("unknown floating point operation");
}

}  // namespace

std::optional<std::int32_t> operate(FloatingOperation operation, std::int32_t left, std::int32_t right,
                                    std::int32_t target, std::int32_t* memory, std::size_t slots) {
  const auto halves = [&](std::int32_t slot) {
    if (slot < 0 || static_cast<std::size_t>(slot) + 1 >= slots) throw std::logic_error("a double outside the memory");
    return memory + slot;
  };
  const auto number = [&](std::int32_t slot) {
    const std::int32_t* const cells = halves(slot);
    const auto high = static_cast<std::uint64_t>(static_cast<std::uint32_t>(cells[0]));
    return std::bit_cast<double>((high << 32) | static_cast<std::uint32_t>(cells[1]));
  };
  const bool unary = operation >= FloatingOperation::negate && operation <= FloatingOperation::to_integer;
  const double result = operation == FloatingOperation::from_integer
                            ? static_cast<double>(left)
                            : computed(operation, number(left), unary ? 0 : number(right));
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
