#include "tachk/machine.hpp"

#include <algorithm>
#include <stdexcept>

namespace tachk {
namespace {

constexpr std::int32_t step_limit = 1 << 24;

// Arithmetic is modulo 2^32.
std::int64_t wrapped(std::int64_t value) { return static_cast<std::int32_t>(static_cast<std::uint32_t>(value)); }

std::int64_t power(std::int64_t base, std::int64_t exponent) {
  std::uint32_t result = 1;
  for (auto factor = static_cast<std::uint32_t>(base); exponent > 0; exponent >>= 1, factor *= factor)
    if ((exponent & 1) != 0) result *= factor;
  return static_cast<std::int32_t>(result);
}

}  // namespace

std::int64_t Machine::run(std::int32_t code, std::int32_t* memory, std::vector<ClockReset>* resets) {
  const std::int32_t* words = program_.code.data();
  const std::vector<Slot>& slots = program_.slots;
  std::int32_t pc = code;
  std::size_t top = 0;    // number of values on the stack
  std::size_t depth = 0;  // number of open calls
  std::int32_t steps = 0;

  const auto push = [&](std::int64_t value) {
    if (top == stack_.size()) stack_.resize(2 * stack_.size());
    stack_[top++] = value;
  };
  const auto pop = [&] { return stack_[--top]; };
  const auto fault = [&](FaultKind kind) -> void { throw ModelFault(kind, pc); };
  const auto slot_at = [&](std::int64_t address) {
    if (address < 0 || static_cast<std::size_t>(address) >= slots.size()) fault(FaultKind::index);
    return static_cast<std::size_t>(address);
  };
  const auto store = [&](std::size_t slot, std::int64_t value) {
    if (value < slots[slot].low || value > slots[slot].high) fault(FaultKind::range);
    memory[slot] = static_cast<std::int32_t>(value);
  };
  const auto arithmetic = [&](std::int64_t value) { stack_[top - 1] = wrapped(value); };

  while (true) {
    if (++steps > step_limit) fault(FaultKind::loop);
    const std::int32_t* operand = words + pc + 1;
    switch (static_cast<Opcode>(words[pc])) {
      case Opcode::end:
        return top > 0 ? stack_[top - 1] : 0;
      case Opcode::constant:
        push(operand[0]);
        pc += 2;
        continue;
      case Opcode::load:
        push(memory[operand[0]]);
        pc += 2;
        continue;
      case Opcode::load_indirect:
        stack_[top - 1] = memory[slot_at(stack_[top - 1])];
        break;
      case Opcode::store:
        store(static_cast<std::size_t>(operand[0]), pop());
        pc += 2;
        continue;
      case Opcode::store_indirect: {
        const std::int64_t value = pop();
        store(slot_at(pop()), value);
        break;
      }
      case Opcode::index: {
        const std::int64_t offset = pop() - operand[0];
        if (offset < 0 || offset >= operand[1]) fault(FaultKind::index);
        stack_[top - 1] += offset * operand[2];
        pc += 4;
        continue;
      }
      case Opcode::copy: {
        const std::size_t source = slot_at(pop());
        const std::size_t target = slot_at(pop());
        const auto count = static_cast<std::size_t>(operand[0]);
        if (source + count > slots.size() || target + count > slots.size()) fault(FaultKind::index);
        const std::vector<std::int32_t> values(memory + source, memory + source + count);
        for (std::size_t n = 0; n < count; ++n) store(target + n, values[n]);
        pc += 2;
        continue;
      }
      case Opcode::equal_cells: {
        const std::size_t b = slot_at(pop());
        const std::size_t a = slot_at(pop());
        const auto count = static_cast<std::size_t>(operand[0]);
        if (a + count > slots.size() || b + count > slots.size()) fault(FaultKind::index);
        push(std::equal(memory + a, memory + a + count, memory + b) ? 1 : 0);
        pc += 2;
        continue;
      }
      case Opcode::reset: {
        const std::int64_t value = pop();
        const std::int64_t clock = pop();
        if (value < 0) fault(FaultKind::negative_clock);
        if (value > largest_reset_) fault(FaultKind::bound);
        if (resets == nullptr || clock < 1 || clock > program_.numbered_clocks())
          throw std::logic_error("reset outside an update");
        const auto number = static_cast<std::uint16_t>(program_.renumbered(clock));
        if (number != 0) resets->push_back({number, static_cast<std::int32_t>(value)});
        break;
      }
      case Opcode::duplicate:
        push(stack_[top - 1]);
        break;
      case Opcode::pop:
        --top;
        break;
      case Opcode::swap:
        std::swap(stack_[top - 1], stack_[top - 2]);
        break;
      case Opcode::over:
        push(stack_[top - 2]);
        break;
      case Opcode::add: {
        const std::int64_t b = pop();
        arithmetic(stack_[top - 1] + b);
        break;
      }
      case Opcode::subtract: {
        const std::int64_t b = pop();
        arithmetic(stack_[top - 1] - b);
        break;
      }
      case Opcode::multiply: {
        const std::int64_t b = pop();
        arithmetic(stack_[top - 1] * b);
        break;
      }
      case Opcode::divide: {
        const std::int64_t b = pop();
        if (b == 0) fault(FaultKind::division);
        arithmetic(stack_[top - 1] / b);
        break;
      }
      case Opcode::modulo: {
        const std::int64_t b = pop();
        if (b == 0) fault(FaultKind::division);
        arithmetic(stack_[top - 1] % b);
        break;
      }
      case Opcode::power: {
        const std::int64_t exponent = pop();
        if (exponent < 0) fault(FaultKind::negative_exponent);
        stack_[top - 1] = power(stack_[top - 1], exponent);
        break;
      }
      case Opcode::bit_and: {
        const std::int64_t b = pop();
        stack_[top - 1] &= b;
        break;
      }
      case Opcode::bit_or: {
        const std::int64_t b = pop();
        stack_[top - 1] |= b;
        break;
      }
      case Opcode::bit_xor: {
        const std::int64_t b = pop();
        stack_[top - 1] ^= b;
        break;
      }
      case Opcode::shift_left: {
        const std::int64_t b = pop();
        if (b < 0 || b > 31) fault(FaultKind::shift);
        arithmetic(stack_[top - 1] * (std::int64_t{1} << b));
        break;
      }
      case Opcode::shift_right: {
        const std::int64_t b = pop();
        if (b < 0 || b > 31) fault(FaultKind::shift);
        stack_[top - 1] >>= b;
        break;
      }
      case Opcode::minimum: {
        const std::int64_t b = pop();
        stack_[top - 1] = std::min(stack_[top - 1], b);
        break;
      }
      case Opcode::maximum: {
        const std::int64_t b = pop();
        stack_[top - 1] = std::max(stack_[top - 1], b);
        break;
      }
      case Opcode::negate:
        arithmetic(-stack_[top - 1]);
        break;
      case Opcode::logical_not:
        stack_[top - 1] = stack_[top - 1] == 0;
        break;
      case Opcode::boolean:
        stack_[top - 1] = stack_[top - 1] != 0;
        break;
      case Opcode::equal: {
        const std::int64_t b = pop();
        stack_[top - 1] = stack_[top - 1] == b;
        break;
      }
      case Opcode::not_equal: {
        const std::int64_t b = pop();
        stack_[top - 1] = stack_[top - 1] != b;
        break;
      }
      case Opcode::less: {
        const std::int64_t b = pop();
        stack_[top - 1] = stack_[top - 1] < b;
        break;
      }
      case Opcode::less_equal: {
        const std::int64_t b = pop();
        stack_[top - 1] = stack_[top - 1] <= b;
        break;
      }
      case Opcode::greater: {
        const std::int64_t b = pop();
        stack_[top - 1] = stack_[top - 1] > b;
        break;
      }
      case Opcode::greater_equal: {
        const std::int64_t b = pop();
        stack_[top - 1] = stack_[top - 1] >= b;
        break;
      }
      case Opcode::jump:
        pc = operand[0];
        continue;
      case Opcode::jump_if_zero:
        pc = pop() == 0 ? operand[0] : pc + 2;
        continue;
      case Opcode::jump_if_nonzero:
        pc = pop() != 0 ? operand[0] : pc + 2;
        continue;
      case Opcode::call:
        if (depth == calls_.size()) calls_.resize(2 * calls_.size());
        calls_[depth++] = pc + 2;
        pc = operand[0];
        continue;
      case Opcode::call_return:
        pc = calls_[--depth];
        continue;
      case Opcode::assertion:
        if (pop() == 0) fault(FaultKind::assertion);
        break;
      case Opcode::check_range:
        if (stack_[top - 1] < operand[0] || stack_[top - 1] > operand[1]) fault(FaultKind::range);
        pc += 3;
        continue;
      default:
        throw std::logic_error("unknown instruction");
    }
    ++pc;
  }
}

}  // namespace tachk
