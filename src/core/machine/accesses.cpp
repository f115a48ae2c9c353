#include "machine/accesses.hpp"

#include <algorithm>
#include <set>

namespace tachk {
namespace {

// Slots behind the state belong to functions, which do not keep them.
void mark(std::vector<bool>& slots, std::int64_t first, std::int64_t count) {
  const auto size = static_cast<std::int64_t>(slots.size());
  const std::int64_t last = std::min(first + count, size);
  for (std::int64_t slot = std::max<std::int64_t>(first, 0); slot < last; ++slot)
    slots[static_cast<std::size_t>(slot)] = true;
}

void mark_all(std::vector<bool>& members) { std::fill(members.begin(), members.end(), true); }

}  // namespace

Touched::Touched(const Program& program)
    : read(program.state_slots), written(program.state_slots), clocks(static_cast<std::size_t>(program.dimension())) {}

Touched Accesses::edge(const Edge& edge) {
  Touched touched(program_);
  add(edge.guard, touched);
  add(edge.channel_code, touched);
  for (const Update::Store& store : edge.update.stores) touched.written[store.slot] = true;
  for (const ClockReset& reset : edge.update.resets) touched.clocks[reset.clock] = true;
  add(edge.update.code, touched);
  touched.read[edge.process] = true;
  touched.written[edge.process] = true;
  return touched;
}

void Accesses::add(const Condition& condition, Touched& touched) {
  for (const Test& test : condition.tests) mark(touched.read, test.slot, 1);
  add(condition.code, touched);
  for (const Atom& atom : condition.atoms) touched.clocks[atom.left] = touched.clocks[atom.right] = true;
  for (const ComputedConstraint& constraint : condition.computed) {
    for (const std::int32_t code :
         {constraint.bound_code, constraint.condition, constraint.left_code, constraint.right_code})
      add(code, touched);
    if (constraint.left_code != no_code || constraint.right_code != no_code) mark_all(touched.clocks);
    touched.clocks[static_cast<std::size_t>(constraint.left)] = true;
    touched.clocks[static_cast<std::size_t>(constraint.right)] = true;
  }
  touched.clocks[0] = false;
}

// The numbers of slots that code computes begin with that of a variable, a constant, to which `address` adds what an
// index is worth. So a slot whose number is in a register lies within an array that some `address` is about, unless
// constants are moved to registers, too.
void Accesses::add(std::int32_t code, Touched& touched) {
  if (code == no_code) return;
  const std::vector<Instruction> instructions = reachable(code_.entry(code));
  std::vector<bool> computed(touched.read.size());
  for (const Instruction& instruction : instructions) {
    const bool constant = instruction.left.place == Place::constants;
    if (instruction.operation == Operation::address && constant)
      mark(computed, value(instruction.left), std::int64_t{instruction.extra[1]} * std::max(instruction.extra[2], 1));
    else if (instruction.operation == Operation::address && instruction.left.place == Place::memory)
      mark_all(computed);
    else if (instruction.operation == Operation::move && constant)
      mark_all(computed);
  }
  for (const Instruction& instruction : instructions) add(instruction, computed, touched);
  touched.clocks[0] = false;
}

std::vector<Instruction> Accesses::reachable(std::int32_t entry) const {
  std::vector<Instruction> found;
  std::vector<std::int32_t> open{entry};
  std::set<std::int32_t> seen;
  while (!open.empty()) {
    const std::int32_t number = open.back();
    open.pop_back();
    if (!seen.insert(number).second) continue;
    const Instruction& instruction = found.emplace_back(code_.instructions()[number]);
    const Operation operation = instruction.operation;
    const bool jumps = operation >= Operation::jump && operation <= Operation::jump_if_greater_equal;
    if (jumps || operation == Operation::call) open.push_back(instruction.target);
    if (operation != Operation::end && operation != Operation::call_return && operation != Operation::jump)
      open.push_back(number + 1);
  }
  return found;
}

void Accesses::add(const Instruction& instruction, const std::vector<bool>& computed, Touched& touched) const {
  const auto mark_from = [&](std::vector<bool>& slots, const Operand& first, std::int64_t count) {
    if (first.place == Place::constants)
      mark(slots, value(first), count);
    else if (first.place == Place::registers)
      for (std::size_t slot = 0; slot < slots.size(); ++slot) slots[slot] = slots[slot] || computed[slot];
    else
      mark_all(slots);
  };
  for (const Operand& operand : {instruction.left, instruction.right})
    if (operand.place == Place::memory) mark(touched.read, operand.index, 1);
  const std::int32_t* extra = instruction.extra;
  switch (instruction.operation) {
    case Operation::store:
      mark(touched.written, instruction.target, 1);
      break;
    case Operation::store_at:
      mark_from(touched.written, instruction.left, 1);
      break;
    case Operation::load_at:
      mark_from(touched.read, instruction.left, 1);
      break;
    case Operation::load_element:
      mark_from(touched.read, instruction.left, std::int64_t{extra[1]} * std::max(extra[2], 1) + extra[3]);
      break;
    case Operation::copy:
      mark_from(touched.written, instruction.left, extra[0]);
      mark_from(touched.read, instruction.right, extra[0]);
      break;
    case Operation::equal_cells:
      mark_from(touched.read, instruction.left, extra[0]);
      mark_from(touched.read, instruction.right, extra[0]);
      break;
    case Operation::floating:  // operands are numbers of slots, the result goes to others
      mark_all(touched.read);
      mark_all(touched.written);
      break;
    case Operation::reset:
      if (const auto clock = clock_of(instruction.left))
        touched.clocks.at(static_cast<std::size_t>(program_.renumbered(*clock))) = true;
      else
        mark_all(touched.clocks);
      break;
    default:
      break;
  }
}

// The number of a clock as the code knows it: a constant, or what a slot always holds.
std::optional<std::int64_t> Accesses::clock_of(const Operand& operand) const {
  if (operand.place == Place::constants) return value(operand);
  if (operand.place != Place::memory) return std::nullopt;
  const Slot& slot = program_.slots[static_cast<std::size_t>(operand.index)];
  return slot.low == slot.high ? std::optional<std::int64_t>(slot.initial) : std::nullopt;
}

}  // namespace tachk
