#include "monitoring/monitor_program.hpp"

#include <stdexcept>

#include "monitoring/monitor_cells.hpp"

namespace tachk::monitoring {
namespace {

void require(bool condition, const char* message) {
  if (!condition) throw std::invalid_argument(message);
}

void check_code(const std::vector<ValueInstruction>& code, std::size_t columns) {
  std::size_t depth = 0;
  for (const ValueInstruction& instruction : code) {
    switch (instruction.operation) {
      case ValueOperator::constant:
        ++depth;
        break;
      case ValueOperator::column:
        require(instruction.column < columns, "an atom reads a column that is not there");
        ++depth;
        break;
      case ValueOperator::negate:
      case ValueOperator::absolute:
        require(depth >= 1, "an arithmetic program takes more values than it has");
        break;
      default:
        require(depth >= 2, "an arithmetic program takes more values than it has");
        --depth;
        break;
    }
  }
  require(depth == 1, "an arithmetic program must leave one value");
}

std::size_t fewest_operands(NodeKind kind) {
  switch (kind) {
    case NodeKind::always_false:
    case NodeKind::always_true:
    case NodeKind::atom:
    case NodeKind::change:
      return 0;
    case NodeKind::logical_and:
    case NodeKind::logical_or:
    case NodeKind::until:
    case NodeKind::since:
      return 2;
    default:
      return 1;
  }
}

}  // namespace

void validate(const MonitorProgram& program) {
  require(!program.nodes.empty(), "a monitor needs a formula");
  for (const MonitorAtom& atom : program.atoms) {
    check_code(atom.left, program.columns);
    if (atom.relation == Relation::truth) {
      require(atom.right.empty(), "a truth value has no right side");
    } else {
      check_code(atom.right, program.columns);
    }
  }
  std::int64_t reach = 0;
  for (std::size_t number = 0; number < program.nodes.size(); ++number) {
    const MonitorNode& node = program.nodes[number];
    const std::size_t fewest = fewest_operands(node.kind);
    const bool any_number = node.kind == NodeKind::logical_and || node.kind == NodeKind::logical_or;
    require(any_number ? node.operands.size() >= fewest : node.operands.size() == fewest,
            "an operator has the wrong number of operands");
    for (const std::size_t operand : node.operands) require(operand < number, "an operand comes after its operator");
    if (node.kind == NodeKind::atom || node.kind == NodeKind::change)
      require(node.atom < program.atoms.size(), "a node names an atom that is not there");
    require(node.lower >= 0 && (node.upper >= 0 || node.upper == unbounded), "a bound is negative");
    const std::int64_t bound = node.upper > node.lower ? node.upper : node.lower;
    require(bound < largest_tick - reach, "the bounds are too large");
    reach += bound;
  }
}

}  // namespace tachk::monitoring
