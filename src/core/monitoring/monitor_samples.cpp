#include "monitoring/monitor_samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tachk::monitoring {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::size_t operands_of(ValueOperator operation) {
  switch (operation) {
    case ValueOperator::constant:
    case ValueOperator::column:
      return 0;
    case ValueOperator::negate:
    case ValueOperator::absolute:
      return 1;
    default:
      return 2;
  }
}

std::size_t depth_of(const std::vector<ValueInstruction>& code) {
  std::size_t depth = 0;
  std::size_t deepest = 0;
  for (const ValueInstruction& instruction : code) {
    depth += 1 - operands_of(instruction.operation);
    deepest = std::max(deepest, depth);
  }
  return deepest;
}

bool is_constant(const std::vector<ValueInstruction>& code) {
  return code.size() == 1 && code[0].operation == ValueOperator::constant;
}

// out[n] = operation(left[n], right(n)), with a right side that is one number for the whole block where possible.
template <class Result, class Operation>
void combine(const double* left, const double* right, bool right_constant, std::size_t count, Result* out,
             Operation operation) {
  if (right_constant) {
    const double number = right[0];
    for (std::size_t n = 0; n < count; ++n) out[n] = static_cast<Result>(operation(left[n], number));
  } else {
    for (std::size_t n = 0; n < count; ++n) out[n] = static_cast<Result>(operation(left[n], right[n]));
  }
}

template <class Operation>
void fold_into(double* left, const double* right, std::size_t count, Operation operation) {
  for (std::size_t n = 0; n < count; ++n) left[n] = operation(left[n], right[n]);
}

}  // namespace

AtomEvaluator::AtomEvaluator(const MonitorProgram& program) : program_(&program) {
  std::size_t depth = 0;
  for (const MonitorAtom& atom : program.atoms) depth = std::max(depth, depth_of(atom.left) + depth_of(atom.right));
  stack_.assign(depth, Block(block));
}

const double* AtomEvaluator::value(const std::vector<ValueInstruction>& code, std::size_t base, const Samples& samples,
                                   std::size_t first, std::size_t count) {
  if (code.size() == 1 && code[0].operation == ValueOperator::column &&
      samples.columns[code[0].column].numbers != nullptr)
    return samples.columns[code[0].column].numbers + first;
  std::size_t top = base;  // one beyond the topmost block
  for (const ValueInstruction& instruction : code) {
    const std::size_t taken = operands_of(instruction.operation);
    top = top + 1 - taken;
    double* left = stack_[top - 1].data();
    const double* right = taken == 2 ? stack_[top].data() : nullptr;
    switch (instruction.operation) {
      case ValueOperator::constant:
        std::fill_n(left, count, instruction.number);
        break;
      case ValueOperator::column: {
        const Column& column = samples.columns[instruction.column];
        if (column.numbers != nullptr) {
          std::copy_n(column.numbers + first, count, left);
        } else {
          for (std::size_t n = 0; n < count; ++n) left[n] = column.flags[first + n] != 0 ? 1.0 : 0.0;
        }
        break;
      }
      case ValueOperator::add:
        fold_into(left, right, count, [](double l, double r) { return l + r; });
        break;
      case ValueOperator::subtract:
        fold_into(left, right, count, [](double l, double r) { return l - r; });
        break;
      case ValueOperator::multiply:
        fold_into(left, right, count, [](double l, double r) { return l * r; });
        break;
      case ValueOperator::divide:
        fold_into(left, right, count, [](double l, double r) { return l / r; });
        break;
      case ValueOperator::modulo:
        fold_into(left, right, count, [](double l, double r) { return std::fmod(l, r); });
        break;
      case ValueOperator::negate:
        for (std::size_t n = 0; n < count; ++n) left[n] = -left[n];
        break;
      case ValueOperator::absolute:
        for (std::size_t n = 0; n < count; ++n) left[n] = std::fabs(left[n]);
        break;
      case ValueOperator::minimum:
        fold_into(left, right, count, [](double l, double r) { return std::min(l, r); });
        break;
      case ValueOperator::maximum:
        fold_into(left, right, count, [](double l, double r) { return std::max(l, r); });
        break;
    }
  }
  return stack_[base].data();
}

void AtomEvaluator::truth(std::size_t atom, const Samples& samples, std::size_t first, std::size_t count,
                          std::uint8_t* out) {
  const MonitorAtom& what = program_->atoms[atom];
  if (what.relation == Relation::truth) {
    if (what.left.size() == 1 && what.left[0].operation == ValueOperator::column) {
      const Column& column = samples.columns[what.left[0].column];
      if (column.flags != nullptr) {
        for (std::size_t n = 0; n < count; ++n) out[n] = column.flags[first + n] != 0;
        return;
      }
    }
    const double* left = value(what.left, 0, samples, first, count);
    for (std::size_t n = 0; n < count; ++n) out[n] = left[n] != 0.0;
    return;
  }
  const bool constant = is_constant(what.right);
  const double* left = value(what.left, 0, samples, first, count);
  const double* right =
      constant ? &what.right[0].number : value(what.right, depth_of(what.left), samples, first, count);
  switch (what.relation) {
    case Relation::less:
      return combine(left, right, constant, count, out, [](double l, double r) { return l < r; });
    case Relation::less_equal:
      return combine(left, right, constant, count, out, [](double l, double r) { return l <= r; });
    case Relation::greater:
      return combine(left, right, constant, count, out, [](double l, double r) { return l > r; });
    case Relation::greater_equal:
      return combine(left, right, constant, count, out, [](double l, double r) { return l >= r; });
    case Relation::equal:
      return combine(left, right, constant, count, out, [](double l, double r) { return l == r; });
    default:
      return combine(left, right, constant, count, out, [](double l, double r) { return l != r; });
  }
}

void AtomEvaluator::robustness(std::size_t atom, const Samples& samples, std::size_t first, std::size_t count,
                               double* out) {
  const MonitorAtom& what = program_->atoms[atom];
  if (what.relation == Relation::truth) {
    const double* left = value(what.left, 0, samples, first, count);
    for (std::size_t n = 0; n < count; ++n) out[n] = left[n] != 0.0 ? infinity : -infinity;
    return;
  }
  const bool constant = is_constant(what.right);
  const double* left = value(what.left, 0, samples, first, count);
  const double* right =
      constant ? &what.right[0].number : value(what.right, depth_of(what.left), samples, first, count);
  switch (what.relation) {
    case Relation::less:
    case Relation::less_equal:
      combine(left, right, constant, count, out, [](double l, double r) { return r - l; });
      break;
    case Relation::greater:
    case Relation::greater_equal:
      combine(left, right, constant, count, out, [](double l, double r) { return l - r; });
      break;
    case Relation::equal:
      combine(left, right, constant, count, out, [](double l, double r) { return -std::fabs(l - r); });
      break;
    default:
      combine(left, right, constant, count, out, [](double l, double r) { return std::fabs(l - r); });
      break;
  }
  bool all_numbers = true;
  for (std::size_t n = 0; n < count; ++n) all_numbers &= out[n] == out[n];
  if (all_numbers) return;
  std::vector<std::uint8_t> holds(count);
  truth(atom, samples, first, count, holds.data());
  for (std::size_t n = 0; n < count; ++n)
    if (std::isnan(out[n])) out[n] = holds[n] != 0 ? infinity : -infinity;
}

void AtomEvaluator::left_value(std::size_t atom, const Samples& samples, std::size_t first, std::size_t count,
                               double* out) {
  std::copy_n(value(program_->atoms[atom].left, 0, samples, first, count), count, out);
}

}  // namespace tachk::monitoring
