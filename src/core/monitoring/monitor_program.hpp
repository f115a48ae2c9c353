// A formula made ready for monitoring: the C++ form of tachk.recordings.traces.monitor_program.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tachk::monitoring {

// Instructions of an arithmetic program in postfix order, over doubles.
enum class ValueOperator : std::int32_t {
  constant = 0,
  column = 1,
  add = 2,
  subtract = 3,
  multiply = 4,
  divide = 5,
  modulo = 6,
  negate = 7,
  absolute = 8,
  minimum = 9,
  maximum = 10,
};

// How an atom compares its left with its right value. `truth`: the left value is not zero.
enum class Relation : std::int32_t {
  truth = 0,
  less = 1,
  less_equal = 2,
  greater = 3,
  greater_equal = 4,
  equal = 5,
  not_equal = 6,
};

enum class NodeKind : std::int32_t {
  always_false = 0,
  always_true = 1,
  atom = 2,
  logical_not = 3,
  logical_and = 4,
  logical_or = 5,
  rise = 6,
  fall = 7,
  change = 8,
  eventually = 9,
  always = 10,
  once = 11,
  historically = 12,
  until = 13,
  since = 14,
};

inline constexpr std::int64_t unbounded = -1;

struct ValueInstruction {
  ValueOperator operation = ValueOperator::constant;
  double number = 0;       // of `constant`
  std::size_t column = 0;  // of `column`
};

struct MonitorAtom {
  Relation relation = Relation::truth;
  std::vector<ValueInstruction> left;
  std::vector<ValueInstruction> right;  // empty for `truth`
};

struct MonitorNode {
  NodeKind kind = NodeKind::always_true;
  std::vector<std::size_t> operands;  // earlier nodes
  std::size_t atom = 0;               // of `atom` and `change`
  std::int64_t lower = 0;             // ticks
  std::int64_t upper = unbounded;     // ticks, or `unbounded`
  bool lower_closed = true;
  bool upper_closed = true;
};

// Operands before operators; the last node is the formula.
struct MonitorProgram {
  std::size_t columns = 0;
  std::vector<MonitorAtom> atoms;
  std::vector<MonitorNode> nodes;
};

// Throws std::invalid_argument unless every number in the program points at something, every arithmetic program leaves
// one value, and no sum of bounds leaves the range of cells.
void validate(const MonitorProgram& program);

}  // namespace tachk::monitoring
