#include "machine/machine.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "machine/floating.hpp"

namespace tachk::machine {
namespace {

constexpr std::int32_t step_limit = 1 << 24;

// Arithmetic is modulo 2^32.
std::int32_t wrapped(std::int64_t value) { return static_cast<std::int32_t>(static_cast<std::uint32_t>(value)); }

std::int32_t power(std::int32_t base, std::int32_t exponent) {
  std::uint32_t result = 1;
  for (auto factor = static_cast<std::uint32_t>(base); exponent > 0; exponent >>= 1, factor *= factor)
    if ((exponent & 1) != 0) result *= factor;
  return static_cast<std::int32_t>(result);
}

}  // namespace

std::int64_t Machine::in_units(std::int64_t time) const {
  if (program_.time_unit == 1) return time;
  if (time % program_.time_unit != 0) throw std::logic_error("a computed time is not a multiple of the time unit");
  return time / program_.time_unit;
}

std::int64_t Machine::run(std::int32_t position, std::int32_t* memory, std::vector<zones::ClockReset>* resets) {
  const std::int32_t entry = code_.entry(position);
  if (registers_.size() < code_.registers()) registers_.resize(code_.registers());
  const Instruction* const instructions = code_.instructions();
  const Instruction* instruction = instructions + entry;
  const std::vector<program::Slot>& slots = program_.slots;
  const std::int32_t* bases[] = {memory, registers_.data(), code_.constants()};  // by Place
  std::int32_t* registers = registers_.data();
  calls_.clear();
  std::int32_t steps = 0;

  const auto value = [&](Operand operand) { return bases[static_cast<std::size_t>(operand.place)][operand.index]; };
  const auto left = [&] { return value(instruction->left); };
  const auto right = [&] { return value(instruction->right); };
  const auto wide_left = [&] { return std::int64_t{left()}; };
  const auto wide_right = [&] { return std::int64_t{right()}; };
  const auto give = [&](std::int32_t result) {
    registers[instruction->target] = result;
    ++instruction;
  };
  const auto fault = [&](FaultKind kind) -> void { throw ModelFault(kind, instruction->position); };
  const auto slot_at = [&](std::int64_t address) {
    if (address < 0 || static_cast<std::size_t>(address) >= slots.size()) fault(FaultKind::index);
    return static_cast<std::size_t>(address);
  };
  const auto store = [&](std::size_t slot, std::int32_t stored) {
    if (stored < slots[slot].low || stored > slots[slot].high) fault(FaultKind::range);
    memory[slot] = stored;
    written_.add(slot);
  };
  const auto address = [&] {
    const std::int64_t offset = wide_right() - instruction->extra[0];
    if (offset < 0 || offset >= instruction->extra[1]) fault(FaultKind::index);
    return wide_left() + offset * instruction->extra[2] + instruction->extra[3];
  };
  const auto slots_at = [&](std::int64_t address_of_first) {
    const std::size_t first = slot_at(address_of_first);
    if (first + static_cast<std::size_t>(instruction->extra[0]) > slots.size()) fault(FaultKind::index);
    return first;
  };
  const auto clock_to_set = [&](std::int32_t clock) {
    if (resets == nullptr || clock < 1 || clock > program_.numbered_clocks())
      throw std::logic_error("a clock is set outside an update");
    return static_cast<std::uint16_t>(program_.renumbered(clock));
  };
  const auto in_range = [&](std::int32_t number) {
    return number >= instruction->extra[0] && number <= instruction->extra[1];
  };
  const auto distance = [&] {
    const std::int32_t bits = right();
    if (bits < 0 || bits > 31) fault(FaultKind::shift);
    return bits;
  };
  const auto count_steps = [&] {
    steps += instruction->extra[1];
    if (steps > step_limit) fault(FaultKind::loop);
  };
  const auto jump = [&](bool taken) {
    count_steps();
    instruction = taken ? instructions + instruction->target : instruction + 1;
  };

  while (true) {
    switch (instruction->operation) {
      case Operation::move:
        give(left());
        break;
      case Operation::store: {
        const std::int32_t stored = left();
        if (!in_range(stored)) fault(FaultKind::range);
        memory[instruction->target] = stored;
        written_.add(static_cast<std::size_t>(instruction->target));
        ++instruction;
        break;
      }
      case Operation::store_at:
        store(slot_at(left()), right());
        ++instruction;
        break;
      case Operation::load_at:
        give(memory[slot_at(left())]);
        break;
      case Operation::address:
        give(wrapped(address()));
        break;
      case Operation::load_element:
        give(memory[slot_at(address())]);
        break;
      case Operation::table: {
        const std::int64_t offset = wide_right() - instruction->extra[1];
        if (offset < 0 || offset >= instruction->extra[2]) fault(FaultKind::index);
        give(program_.code[static_cast<std::size_t>(instruction->extra[0] + offset)]);
        break;
      }
      case Operation::copy: {
        const std::size_t source = slots_at(right());
        const std::size_t target = slots_at(left());
        copied_.assign(memory + source, memory + source + instruction->extra[0]);
        for (std::size_t n = 0; n < copied_.size(); ++n) store(target + n, copied_[n]);
        ++instruction;
        break;
      }
      case Operation::equal_slots: {
        const std::int32_t* first = memory + slots_at(left());
        give(std::equal(first, first + instruction->extra[0], memory + slots_at(right())));
        break;
      }
      case Operation::reset:
      case Operation::advance_clock: {
        const std::int32_t time = right();
        const std::uint16_t number = clock_to_set(left());
        if (time < 0) fault(FaultKind::negative_clock);
        if (number != 0) {
          const std::int64_t units = in_units(time);
          if (units > largest_reset_) fault(FaultKind::bound);
          const std::uint16_t source = instruction->operation == Operation::reset ? 0 : number;
          resets->push_back({number, static_cast<std::int32_t>(units), source});
        }
        ++instruction;
        break;
      }
      case Operation::copy_clock: {
        const std::uint16_t source = clock_to_set(right());
        const std::uint16_t number = clock_to_set(left());
        if (number != 0 && number != source) resets->push_back({number, 0, source});
        ++instruction;
        break;
      }
      case Operation::add:
        give(wrapped(wide_left() + wide_right()));
        break;
      case Operation::subtract:
        give(wrapped(wide_left() - wide_right()));
        break;
      case Operation::multiply:
        give(wrapped(wide_left() * wide_right()));
        break;
      case Operation::divide:
        if (right() == 0) fault(FaultKind::division);
        give(right() == -1 ? wrapped(-wide_left()) : left() / right());
        break;
      case Operation::modulo:
        if (right() == 0) fault(FaultKind::division);
        give(right() == -1 ? 0 : left() % right());
        break;
      case Operation::power:
        if (right() < 0) fault(FaultKind::negative_exponent);
        give(power(left(), right()));
        break;
      case Operation::bit_and:
        give(left() & right());
        break;
      case Operation::bit_or:
        give(left() | right());
        break;
      case Operation::bit_xor:
        give(left() ^ right());
        break;
      case Operation::shift_left:
        give(wrapped(wide_left() * (std::int64_t{1} << distance())));
        break;
      case Operation::shift_right:
        give(left() >> distance());
        break;
      case Operation::minimum:
        give(std::min(left(), right()));
        break;
      case Operation::maximum:
        give(std::max(left(), right()));
        break;
      case Operation::negate:
        give(wrapped(-wide_left()));
        break;
      case Operation::equal:
        give(left() == right());
        break;
      case Operation::not_equal:
        give(left() != right());
        break;
      case Operation::less:
        give(left() < right());
        break;
      case Operation::less_equal:
        give(left() <= right());
        break;
      case Operation::greater:
        give(left() > right());
        break;
      case Operation::greater_equal:
        give(left() >= right());
        break;
      case Operation::jump:
        jump(true);
        break;
      case Operation::jump_if_equal:
        jump(left() == right());
        break;
      case Operation::jump_if_not_equal:
        jump(left() != right());
        break;
      case Operation::jump_if_less:
        jump(left() < right());
        break;
      case Operation::jump_if_less_equal:
        jump(left() <= right());
        break;
      case Operation::jump_if_greater:
        jump(left() > right());
        break;
      case Operation::jump_if_greater_equal:
        jump(left() >= right());
        break;
      case Operation::call:
        count_steps();
        calls_.push_back({instruction + 1, registers});
        registers += instruction->extra[0];
        bases[static_cast<std::size_t>(Place::registers)] = registers;
        instruction = instructions + instruction->target;
        break;
      case Operation::call_return:
        count_steps();
        instruction = calls_.back().next;
        registers = calls_.back().registers;
        bases[static_cast<std::size_t>(Place::registers)] = registers;
        calls_.pop_back();
        break;
      case Operation::assertion:
        if (left() == 0) fault(FaultKind::assertion);
        ++instruction;
        break;
      case Operation::check_range:
        if (!in_range(left())) fault(FaultKind::range);
        ++instruction;
        break;
      case Operation::floating: {
        const auto operation = static_cast<FloatingOperation>(instruction->extra[0]);
        const std::int32_t slot = instruction->extra[1];
        const std::optional<std::int32_t> result =
            operate(operation, left(), right(), slot, memory, slots.size(), dice_);
        if (!result) fault(FaultKind::not_finite);
        if (gives_double(operation)) {
          written_.add(static_cast<std::size_t>(slot));
          written_.add(static_cast<std::size_t>(slot) + 1);
        }
        give(*result);
        break;
      }
      case Operation::end:
        instructions_ += static_cast<std::uint64_t>(steps);
        return left();
    }
  }
}

}  // namespace tachk::machine
