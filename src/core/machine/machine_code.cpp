#include "machine/machine_code.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

namespace tachk::machine {

StackEffect effect_of(Opcode opcode) {
  switch (opcode) {
    case Opcode::constant:
    case Opcode::load:
      return {1, 0, 1};
    case Opcode::load_indirect:
    case Opcode::negate:
    case Opcode::logical_not:
    case Opcode::boolean:
      return {0, 1, 1};
    case Opcode::store:
    case Opcode::jump_if_zero:
    case Opcode::jump_if_nonzero:
      return {1, 1, 0};
    case Opcode::store_indirect:
    case Opcode::reset:
    case Opcode::copy_clock:
    case Opcode::advance_clock:
      return {0, 2, 0};
    case Opcode::index:
      return {3, 2, 1};
    case Opcode::copy:
      return {1, 2, 0};
    case Opcode::equal_slots:
      return {1, 2, 1};
    case Opcode::duplicate:
      return {0, 1, 2};
    case Opcode::pop:
    case Opcode::assertion:
      return {0, 1, 0};
    case Opcode::swap:
      return {0, 2, 2};
    case Opcode::over:
      return {0, 2, 3};
    case Opcode::jump:
    case Opcode::call:
      return {1, 0, 0};
    case Opcode::call_return:
    case Opcode::end:
      return {0, 0, 0};
    case Opcode::check_range:
      return {2, 1, 1};
    case Opcode::table:
      return {3, 1, 1};
    case Opcode::floating:
      return {2, 2, 1};
    default:
      return {0, 2, 1};
  }
}

namespace {

Operation binary_operation(Opcode opcode) {
  switch (opcode) {
    case Opcode::add:
      return Operation::add;
    case Opcode::subtract:
      return Operation::subtract;
    case Opcode::multiply:
      return Operation::multiply;
    case Opcode::divide:
      return Operation::divide;
    case Opcode::modulo:
      return Operation::modulo;
    case Opcode::power:
      return Operation::power;
    case Opcode::bit_and:
      return Operation::bit_and;
    case Opcode::bit_or:
      return Operation::bit_or;
    case Opcode::bit_xor:
      return Operation::bit_xor;
    case Opcode::shift_left:
      return Operation::shift_left;
    case Opcode::shift_right:
      return Operation::shift_right;
    case Opcode::minimum:
      return Operation::minimum;
    case Opcode::maximum:
      return Operation::maximum;
    case Opcode::equal:
      return Operation::equal;
    case Opcode::not_equal:
      return Operation::not_equal;
    case Opcode::less:
      return Operation::less;
    case Opcode::less_equal:
      return Operation::less_equal;
    case Opcode::greater:
      return Operation::greater;
    case Opcode::greater_equal:
      return Operation::greater_equal;
    default:
      throw std::invalid_argument("unknown instruction");
  }
}

bool compares(Operation operation) { return operation >= Operation::equal && operation <= Operation::greater_equal; }

Operation negated(Operation comparison) {
  switch (comparison) {
    case Operation::equal:
      return Operation::not_equal;
    case Operation::not_equal:
      return Operation::equal;
    case Operation::less:
      return Operation::greater_equal;
    case Operation::less_equal:
      return Operation::greater;
    case Operation::greater:
      return Operation::less_equal;
    default:
      return Operation::less;
  }
}

Operation jump_if(Operation comparison) {
  const int offset = static_cast<int>(comparison) - static_cast<int>(Operation::equal);
  return static_cast<Operation>(static_cast<int>(Operation::jump_if_equal) + offset);
}

}  // namespace

// Runs over the stack code with a stack of operands in place of numbers: a constant or a variable stays where it is
// until something uses it. At labels entry n of the stack is in register n, whichever way led there. In between an
// entry may be in a register behind that, never before, and no two share one.
class Translation {
 public:
  Translation(MachineCode& code, std::int32_t start) : code_(code), words_(code.program_.code), start_(start) {}

  MachineCode::Piece run() {
    find_depths();
    std::int32_t next = -1;  // the position that the instruction before leads to; -1 if to none
    for (const auto& [position, depth] : depths_) {
      if (labels_.contains(position) || position != next) begin_label(position, depth, position == next);
      ++steps_;
      translate(position);
      next = leaves_ ? -1 : after(position);
    }
    for (const std::size_t jump : jumps_) {
      Instruction& instruction = code_.instructions_[jump];
      instruction.target = label_entries_.at(instruction.target);
    }
    return {label_entries_.at(start_), results_, registers_};
  }

 private:
  Opcode opcode(std::int32_t position) const {
    return static_cast<Opcode>(words_.at(static_cast<std::size_t>(position)));
  }
  std::int32_t operand(std::int32_t position, int number) const {
    return words_.at(static_cast<std::size_t>(position) + 1 + static_cast<std::size_t>(number));
  }
  std::int32_t after(std::int32_t position) const { return position + 1 + effect_of(opcode(position)).operands; }

  // The depth of the stack in front of every instruction that can be reached, and the targets of jumps.
  void find_depths() {
    std::vector<std::pair<std::int32_t, std::int32_t>> open{{start_, 0}};
    labels_.insert(start_);
    while (!open.empty()) {
      const auto [position, depth] = open.back();
      open.pop_back();
      const auto [known, fresh] = depths_.emplace(position, depth);
      if (known->second != depth) throw std::invalid_argument("the stack depends on the way to an instruction");
      if (!fresh) continue;
      const Opcode here = opcode(position);
      const StackEffect effect = effect_of(here);
      if (depth < effect.pops) throw std::invalid_argument("an instruction finds too little on the stack");
      std::int32_t left = depth - effect.pops + effect.pushes;
      if (here == Opcode::call) left += code_.translate(operand(position, 0)).results;
      if (here == Opcode::jump || here == Opcode::jump_if_zero || here == Opcode::jump_if_nonzero) {
        labels_.insert(operand(position, 0));
        open.emplace_back(operand(position, 0), left);
      }
      if (here == Opcode::end || here == Opcode::call_return)
        results_ = std::max(results_, depth);
      else if (here != Opcode::jump)
        open.emplace_back(after(position), left);
    }
    if (results_ > 1) throw std::invalid_argument("a piece of code leaves more than one number");
  }

  void begin_label(std::int32_t position, std::int32_t depth, bool falls_in) {
    if (falls_in) settle();
    stack_.clear();
    for (std::int32_t n = 0; n < depth; ++n) push({Place::registers, n});
    label_entries_[position] = static_cast<std::int32_t>(code_.instructions_.size());
    label_size_ = code_.instructions_.size();
    steps_ = 0;
  }

  void translate(std::int32_t position) {
    position_ = position;
    leaves_ = false;
    const Opcode here = opcode(position);
    switch (here) {
      case Opcode::constant:
        push(code_.constant(operand(position, 0)));
        break;
      case Opcode::load:
        push({Place::memory, operand(position, 0)});
        break;
      case Opcode::load_indirect:
        load_indirect();
        break;
      case Opcode::store:
        keep_apart(1, operand(position, 0));
        store(operand(position, 0), pop());
        break;
      case Opcode::store_indirect: {
        keep_apart(2, std::nullopt);
        const Operand value = pop();
        const Operand address = pop();
        if (const std::optional<std::int32_t> slot = known_slot(address))
          store(*slot, value);
        else
          emit(Operation::store_at, address, value);
        break;
      }
      case Opcode::index: {
        const Operand index = pop();
        const Operand base = pop();
        Instruction& address = compute(Operation::address, base, index);
        std::copy_n(words_.begin() + position + 1, 3, address.extra);
        break;
      }
      case Opcode::table: {
        Instruction& entry = compute(Operation::table, zero(), pop());
        std::copy_n(words_.begin() + position + 1, 3, entry.extra);
        break;
      }
      case Opcode::copy: {
        keep_apart(2, std::nullopt);
        const Operand source = pop();
        emit(Operation::copy, pop(), source).extra[0] = operand(position, 0);
        break;
      }
      case Opcode::equal_slots: {
        const Operand right = pop();
        const Operand left = pop();
        compute(Operation::equal_slots, left, right).extra[0] = operand(position, 0);
        break;
      }
      case Opcode::reset:
      case Opcode::copy_clock:
      case Opcode::advance_clock: {
        const Operand value = pop();
        emit(here == Opcode::reset        ? Operation::reset
             : here == Opcode::copy_clock ? Operation::copy_clock
                                          : Operation::advance_clock,
             pop(), value);
        break;
      }
      case Opcode::duplicate:
        push_copy(stack_.back());
        break;
      case Opcode::pop:
        pop();
        break;
      case Opcode::swap:
        swap();
        break;
      case Opcode::over:
        push_copy(stack_[stack_.size() - 2]);
        break;
      case Opcode::negate:
        compute(Operation::negate, pop(), zero());
        break;
      case Opcode::logical_not:
        if (ends_with_comparison(stack_.back())) {
          last().operation = negated(last().operation);
          break;
        }
        compute(Operation::equal, pop(), zero());
        break;
      case Opcode::boolean:
        if (!ends_with_comparison(stack_.back())) compute(Operation::not_equal, pop(), zero());
        break;
      case Opcode::jump:
        settle();
        jump(Operation::jump, zero(), zero());
        leaves_ = true;
        break;
      case Opcode::jump_if_zero:
      case Opcode::jump_if_nonzero:
        branch(here == Opcode::jump_if_nonzero);
        break;
      case Opcode::call:
        call(code_.translate(operand(position, 0)));
        break;
      case Opcode::call_return:
        settle();
        emit(Operation::call_return, zero(), zero()).extra[1] = take_steps();
        leaves_ = true;
        break;
      case Opcode::assertion:
        emit(Operation::assertion, pop(), zero());
        break;
      case Opcode::check_range: {
        Instruction& check = emit(Operation::check_range, stack_.back(), zero());
        check.extra[0] = operand(position, 0);
        check.extra[1] = operand(position, 1);
        break;
      }
      case Opcode::floating: {
        const std::int32_t slot = operand(position, 1);
        keep_apart(2, slot);
        keep_apart(2, slot + 1);
        const Operand right = pop();
        Instruction& operation = compute(Operation::floating, pop(), right);
        operation.extra[0] = operand(position, 0);
        operation.extra[1] = slot;
        break;
      }
      case Opcode::end:
        emit(Operation::end, stack_.empty() ? zero() : pop(), zero());
        leaves_ = true;
        break;
      default:
        binary(binary_operation(here));
    }
  }

  // ---- single instructions ------------------------------------------------------------------------------------------

  void load_indirect() {
    const Operand address = stack_.back();
    if (const std::optional<std::int32_t> slot = known_slot(address)) {
      stack_.back() = {Place::memory, *slot};
    } else if (ends_with(address, Operation::address)) {
      last().operation = Operation::load_element;
    } else {
      pop();
      compute(Operation::load_at, address, zero());
    }
  }

  void store(std::int32_t slot, Operand value) {
    Instruction& store = emit(Operation::store, value, zero());
    store.target = slot;
    store.extra[0] = code_.program_.slots.at(static_cast<std::size_t>(slot)).low;
    store.extra[1] = code_.program_.slots[static_cast<std::size_t>(slot)].high;
  }

  void binary(Operation operation) {
    const Operand right = pop();
    const Operand left = stack_.back();
    if (operation == Operation::add && right.place == Place::constants && ends_with(left, Operation::address)) {
      last().extra[3] += value_of(right);  // the place of a field in an element of an array
      return;
    }
    pop();
    compute(operation, left, right);
  }

  void swap() {
    const Operand top = pop();
    const Operand below = pop();
    push(top);
    const auto place = static_cast<std::int32_t>(stack_.size());
    if (below.place == Place::registers && below.index < place)
      move_to_free_register(below);
    else
      push(below);
  }

  void branch(bool if_nonzero) {
    const Operand condition = pop();
    Operation comparison = Operation::not_equal;
    Operand left = condition;
    Operand right = zero();
    if (ends_with_comparison(condition)) {
      comparison = last().operation;
      left = last().left;
      right = last().right;
      code_.instructions_.pop_back();
    }
    settle();
    jump(jump_if(if_nonzero ? comparison : negated(comparison)), left, right);
  }

  void jump(Operation operation, Operand left, Operand right) {
    jumps_.push_back(code_.instructions_.size());
    Instruction& instruction = emit(operation, left, right);
    instruction.target = operand(position_, 0);
    instruction.extra[1] = take_steps();
  }

  void call(const MachineCode::Piece& function) {
    keep_apart(0, std::nullopt);
    auto frame = static_cast<std::int32_t>(stack_.size());
    for (const Operand& entry : stack_)
      if (entry.place == Place::registers) frame = std::max(frame, entry.index + 1);
    Instruction& instruction = emit(Operation::call, zero(), zero());
    instruction.target = function.entry;
    instruction.extra[0] = frame;
    instruction.extra[1] = take_steps();
    registers_ = std::max(registers_, frame + function.registers);
    if (function.results == 1) push({Place::registers, frame});
  }

  // ---- the stack of operands ----------------------------------------------------------------------------------------

  void push(Operand operand) {
    stack_.push_back(operand);
    if (operand.place == Place::registers) registers_ = std::max(registers_, operand.index + 1);
  }

  Operand pop() {
    const Operand top = stack_.back();
    stack_.pop_back();
    return top;
  }

  // The first register that the entry pushed next may take.
  std::int32_t free_register(std::size_t place) const {
    auto number = static_cast<std::int32_t>(place);
    while (std::find(stack_.begin(), stack_.end(), Operand{Place::registers, number}) != stack_.end()) ++number;
    return number;
  }

  void move_to_free_register(Operand operand) {
    const std::int32_t number = free_register(stack_.size());
    emit(Operation::move, operand, zero()).target = number;
    push({Place::registers, number});
  }

  void push_copy(Operand operand) {
    if (operand.place == Place::registers)
      move_to_free_register(operand);
    else
      push(operand);
  }

  // Before memory is written: moves what the stack says of it, or of one slot, to registers; not the top `spared`
  // entries.
  void keep_apart(std::size_t spared, std::optional<std::int32_t> slot) {
    for (std::size_t n = 0; n + spared < stack_.size(); ++n) {
      if (stack_[n].place != Place::memory || (slot && stack_[n].index != *slot)) continue;
      const std::int32_t number = free_register(n);
      emit(Operation::move, stack_[n], zero()).target = number;
      stack_[n] = {Place::registers, number};
      registers_ = std::max(registers_, number + 1);
    }
  }

  // Puts entry n of the stack into register n. From the bottom up, as no entry is in a register before its own.
  void settle() {
    for (std::size_t n = 0; n < stack_.size(); ++n) {
      const Operand place{Place::registers, static_cast<std::int32_t>(n)};
      if (stack_[n] == place) continue;
      emit(Operation::move, stack_[n], zero()).target = place.index;
      stack_[n] = place;
      registers_ = std::max(registers_, place.index + 1);
    }
  }

  // ---- instructions -------------------------------------------------------------------------------------------------

  Instruction& emit(Operation operation, Operand left, Operand right) {
    code_.instructions_.push_back({operation, left, right, 0, position_, {}});
    return code_.instructions_.back();
  }

  // An instruction with a result, which goes to the stack.
  Instruction& compute(Operation operation, Operand left, Operand right) {
    const std::int32_t target = free_register(stack_.size());
    push({Place::registers, target});
    Instruction& instruction = emit(operation, left, right);
    instruction.target = target;
    return instruction;
  }

  Instruction& last() { return code_.instructions_.back(); }

  // True if the instruction before this one, with no label in between, computed the operand.
  bool ends_with(Operand operand, Operation operation) {
    return code_.instructions_.size() > label_size_ && operand == Operand{Place::registers, last().target} &&
           last().operation == operation;
  }
  bool ends_with_comparison(Operand operand) {
    return code_.instructions_.size() > label_size_ && compares(last().operation) &&
           operand == Operand{Place::registers, last().target};
  }

  Operand zero() { return code_.constant(0); }
  std::int32_t value_of(Operand constant) const { return code_.constants_[static_cast<std::size_t>(constant.index)]; }
  std::optional<std::int32_t> known_slot(Operand address) const {
    if (address.place != Place::constants) return std::nullopt;
    const std::int32_t slot = value_of(address);
    const bool legal = slot >= 0 && static_cast<std::size_t>(slot) < code_.program_.slots.size();
    return legal ? std::optional(slot) : std::nullopt;
  }
  std::int32_t take_steps() { return std::exchange(steps_, 0); }

  MachineCode& code_;
  const std::vector<std::int32_t>& words_;
  std::int32_t start_;
  std::map<std::int32_t, std::int32_t> depths_;  // of the stack, by position
  std::set<std::int32_t> labels_;
  std::map<std::int32_t, std::int32_t> label_entries_;
  std::vector<std::size_t> jumps_;  // their targets are positions until the end
  std::int32_t results_ = 0;
  std::int32_t registers_ = 0;

  std::vector<Operand> stack_;
  std::int32_t position_ = 0;
  bool leaves_ = false;         // control does not go on behind this instruction
  std::size_t label_size_ = 0;  // instructions in front of the last label
  std::int32_t steps_ = 0;      // instructions of the stack code since the last label or jump
};

MachineCode::MachineCode(const program::Program& program) : program_(program), entries_(program.code.size(), -1) {}

const MachineCode::Piece& MachineCode::translate(std::int32_t position) {
  const auto [known, fresh] = pieces_.try_emplace(position, Piece{-1, 0, 0});
  if (!fresh) {
    if (known->second.entry < 0) throw std::invalid_argument("recursive code");
    return known->second;
  }
  known->second = Translation(*this, position).run();
  entries_.at(static_cast<std::size_t>(position)) = known->second.entry;
  registers_ = std::max(registers_, static_cast<std::size_t>(known->second.registers));
  return known->second;
}

Operand MachineCode::constant(std::int32_t value) {
  const auto [place, fresh] = constant_numbers_.try_emplace(value, static_cast<std::int32_t>(constants_.size()));
  if (fresh) constants_.push_back(value);
  return {Place::constants, place->second};
}

}  // namespace tachk::machine
