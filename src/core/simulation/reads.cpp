#include "simulation/reads.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace tachk {

void Reads::add(const Condition& condition) {
  for (const Test& test : condition.tests) add_range(test.slot, 1);
  add(condition.code);
  for (const FlowTest& test : condition.flow) {
    add(test.left);
    add(test.right);
  }
  for (const ComputedConstraint& constraint : condition.computed)
    for (const std::int32_t code :
         {constraint.bound_code, constraint.condition, constraint.left_code, constraint.right_code})
      add(code);
}

void Reads::add(std::int32_t code) {
  if (code == no_code) return;
  std::vector<std::int32_t> pending{code_.entry(code)};
  std::vector<std::int32_t> seen;
  while (!pending.empty()) {
    const std::int32_t number = pending.back();
    pending.pop_back();
    if (std::find(seen.begin(), seen.end(), number) != seen.end()) continue;
    seen.push_back(number);
    const Instruction& instruction = code_.instructions()[number];
    add_operands(instruction);
    const Operation operation = instruction.operation;
    const bool jumps = operation >= Operation::jump && operation <= Operation::jump_if_greater_equal;
    if (jumps || operation == Operation::call) pending.push_back(instruction.target);
    if (operation != Operation::end && operation != Operation::call_return && operation != Operation::jump)
      pending.push_back(number + 1);
  }
}

void Reads::add_all() {
  slots_ = SlotSet::all();
  reads_locations_ = true;
}

void Reads::add_range(std::int64_t first, std::int64_t count) {
  const std::int64_t last = std::min<std::int64_t>(first + count, program_.state_slots);
  reads_locations_ |= first < static_cast<std::int64_t>(program_.processes.size());
  for (std::int64_t slot = std::max<std::int64_t>(first, 0); slot < last; ++slot)
    slots_.add(static_cast<std::size_t>(slot));
}

void Reads::add_operands(const Instruction& instruction) {
  for (const Operand& operand : {instruction.left, instruction.right})
    if (operand.place == Place::memory) add_range(operand.index, 1);
  const bool known = instruction.left.place == Place::constants;
  const std::int64_t first = known ? code_.constants()[instruction.left.index] : 0;
  switch (instruction.operation) {
    case Operation::load_element:
      if (known)
        add_range(first + instruction.extra[3], std::int64_t{instruction.extra[1]} * std::max(instruction.extra[2], 1));
      else
        add_all();
      break;
    case Operation::load_at:
      if (known)
        add_range(first, 1);
      else
        add_all();
      break;
    case Operation::copy:
    case Operation::equal_cells:
    case Operation::floating:  // operands are numbers of slots
      add_all();
      break;
    default:
      break;
  }
}

}  // namespace tachk
