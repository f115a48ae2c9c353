// The machine against a plain interpreter of stack code, on random code: values, memory, resets, faults and their
// places.
#include "machine/machine.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "check.hpp"

namespace {

using namespace tachk::machine;
using namespace tachk::program;
using namespace tachk::zones;

constexpr std::int32_t slots = 16;
constexpr std::int32_t counters = 6;  // slots behind those, one for each level of loops
constexpr std::int32_t largest_reset = 1000;

// The result of a piece of code: its value, or its fault.
struct Result {
  std::int64_t value = 0;
  std::optional<std::pair<FaultKind, std::int32_t>> fault;
  std::vector<std::int32_t> memory;
  std::vector<std::array<int, 3>> resets;  // clock, value, source

  bool operator==(const Result&) const = default;
};

// ---- the oracle -----------------------------------------------------------------------------------------------------

struct Fault {
  FaultKind kind;
};

std::int32_t wrapped(std::int64_t value) { return static_cast<std::int32_t>(static_cast<std::uint32_t>(value)); }

std::int32_t binary(Opcode opcode, std::int64_t a, std::int64_t b) {
  const auto need = [](bool condition, FaultKind kind) {
    if (!condition) throw Fault{kind};
  };
  switch (opcode) {
    case Opcode::add:
      return wrapped(a + b);
    case Opcode::subtract:
      return wrapped(a - b);
    case Opcode::multiply:
      return wrapped(a * b);
    case Opcode::divide:
      need(b != 0, FaultKind::division);
      return wrapped(a / b);
    case Opcode::modulo:
      need(b != 0, FaultKind::division);
      return wrapped(a % b);
    case Opcode::power: {
      need(b >= 0, FaultKind::negative_exponent);
      std::int64_t result = 1;
      for (std::int64_t n = 0; n < b; ++n) result = wrapped(result * a);
      return wrapped(result);
    }
    case Opcode::bit_and:
      return wrapped(a & b);
    case Opcode::bit_or:
      return wrapped(a | b);
    case Opcode::bit_xor:
      return wrapped(a ^ b);
    case Opcode::shift_left:
      need(b >= 0 && b <= 31, FaultKind::shift);
      return wrapped(a * (std::int64_t{1} << b));
    case Opcode::shift_right:
      need(b >= 0 && b <= 31, FaultKind::shift);
      return wrapped(a >> b);
    case Opcode::minimum:
      return wrapped(std::min(a, b));
    case Opcode::maximum:
      return wrapped(std::max(a, b));
    case Opcode::equal:
      return a == b;
    case Opcode::not_equal:
      return a != b;
    case Opcode::less:
      return a < b;
    case Opcode::less_equal:
      return a <= b;
    case Opcode::greater:
      return a > b;
    case Opcode::greater_equal:
      return a >= b;
    default:
      throw std::logic_error("no binary operation");
  }
}

Result interpret(const Program& program, std::int32_t code, std::vector<std::int32_t> memory) {
  Result result;
  std::vector<std::int64_t> stack;
  std::vector<std::int32_t> returns;
  const auto pop = [&] {
    const std::int64_t top = stack.back();
    stack.pop_back();
    return top;
  };
  const auto store = [&](std::int64_t slot, std::int64_t value) {
    const Slot& kind = program.slots.at(static_cast<std::size_t>(slot));
    if (value < kind.low || value > kind.high) throw Fault{FaultKind::range};
    memory[static_cast<std::size_t>(slot)] = static_cast<std::int32_t>(value);
  };
  std::int32_t pc = code;
  try {
    while (true) {
      const auto opcode = static_cast<Opcode>(program.code[static_cast<std::size_t>(pc)]);
      const std::int32_t* operand = program.code.data() + pc + 1;
      std::int32_t next = pc + 1;
      switch (opcode) {
        case Opcode::end:
          result.value = stack.empty() ? 0 : stack.back();
          CHECK(returns.empty() && stack.size() <= 1);
          result.memory = memory;
          return result;
        case Opcode::constant:
          stack.push_back(operand[0]);
          next += 1;
          break;
        case Opcode::load:
          stack.push_back(memory[static_cast<std::size_t>(operand[0])]);
          next += 1;
          break;
        case Opcode::load_indirect:
          stack.back() = memory.at(static_cast<std::size_t>(stack.back()));
          break;
        case Opcode::store:
          store(operand[0], pop());
          next += 1;
          break;
        case Opcode::store_indirect: {
          const std::int64_t value = pop();
          store(pop(), value);
          break;
        }
        case Opcode::index: {
          const std::int64_t offset = pop() - operand[0];
          if (offset < 0 || offset >= operand[1]) throw Fault{FaultKind::index};
          stack.back() += offset * operand[2];
          next += 3;
          break;
        }
        case Opcode::copy: {
          const std::int64_t source = pop();
          const std::int64_t target = pop();
          const std::vector<std::int32_t> before = memory;
          for (std::int64_t n = 0; n < operand[0]; ++n) store(target + n, before[static_cast<std::size_t>(source + n)]);
          next += 1;
          break;
        }
        case Opcode::equal_slots: {
          const std::int64_t b = pop();
          const std::int64_t a = pop();
          stack.push_back(std::equal(memory.begin() + a, memory.begin() + a + operand[0], memory.begin() + b));
          next += 1;
          break;
        }
        case Opcode::reset: {
          const std::int64_t value = pop();
          const std::int64_t clock = pop();
          if (value < 0) throw Fault{FaultKind::negative_clock};
          if (value > largest_reset) throw Fault{FaultKind::bound};
          result.resets.push_back({static_cast<int>(clock), static_cast<int>(value), 0});
          break;
        }
        case Opcode::copy_clock: {
          const auto source = static_cast<int>(pop());
          const auto clock = static_cast<int>(pop());
          if (clock != source) result.resets.push_back({clock, 0, source});
          break;
        }
        case Opcode::advance_clock: {
          const std::int64_t value = pop();
          const auto clock = static_cast<int>(pop());
          if (value < 0) throw Fault{FaultKind::negative_clock};
          if (value > largest_reset) throw Fault{FaultKind::bound};
          result.resets.push_back({clock, static_cast<int>(value), clock});
          break;
        }
        case Opcode::duplicate:
          stack.push_back(stack.back());
          break;
        case Opcode::pop:
          pop();
          break;
        case Opcode::swap:
          std::swap(stack.back(), stack[stack.size() - 2]);
          break;
        case Opcode::over:
          stack.push_back(stack[stack.size() - 2]);
          break;
        case Opcode::negate:
          stack.back() = wrapped(-stack.back());
          break;
        case Opcode::logical_not:
          stack.back() = stack.back() == 0;
          break;
        case Opcode::boolean:
          stack.back() = stack.back() != 0;
          break;
        case Opcode::jump:
          next = operand[0];
          break;
        case Opcode::jump_if_zero:
          next = pop() == 0 ? operand[0] : next + 1;
          break;
        case Opcode::jump_if_nonzero:
          next = pop() != 0 ? operand[0] : next + 1;
          break;
        case Opcode::call:
          returns.push_back(next + 1);
          next = operand[0];
          break;
        case Opcode::call_return:
          next = returns.back();
          returns.pop_back();
          break;
        case Opcode::assertion:
          if (pop() == 0) throw Fault{FaultKind::assertion};
          break;
        case Opcode::check_range:
          if (stack.back() < operand[0] || stack.back() > operand[1]) throw Fault{FaultKind::range};
          next += 2;
          break;
        default: {
          const std::int64_t b = pop();
          const std::int64_t a = pop();
          stack.push_back(binary(opcode, a, b));
        }
      }
      pc = next;
    }
  } catch (const Fault& fault) {
    result.fault = {fault.kind, pc};
    result.memory = memory;
    return result;
  }
}

// ---- random code ----------------------------------------------------------------------------------------------------

class Writer {
 public:
  Writer(std::uint32_t seed, Program& program) : random_(seed), code_(program.code) {}

  // A piece of code; returns its position.
  std::int32_t write() {
    for (int n = pick(3); n > 0; --n) write_function();
    first_counter_ = 2;
    const std::int32_t start = here();
    body(4 + pick(12), 3);
    const int left = pick(2);
    level(left);
    emit(Opcode::end);
    return start;
  }

 private:
  int pick(int count) { return static_cast<int>(random_() % static_cast<std::uint32_t>(count)); }
  std::int32_t here() const { return static_cast<std::int32_t>(code_.size()); }
  void emit(Opcode opcode, std::initializer_list<std::int32_t> operands = {}) {
    code_.push_back(static_cast<std::int32_t>(opcode));
    code_.insert(code_.end(), operands);
  }

  void write_function() {
    const std::int32_t start = here();
    first_counter_ = static_cast<std::int32_t>(functions_.size());
    body(3 + pick(5), 1);
    const int results = pick(2);
    level(results);
    emit(Opcode::call_return);
    functions_.emplace_back(start, results);
    depth_ = 0;
  }

  // Brings the stack to a depth.
  void level(int depth) {
    for (; depth_ > depth; --depth_) emit(Opcode::pop);
    while (depth_ < depth) number();
  }

  void number() {
    if (pick(2) == 0)
      emit(Opcode::constant, {pick(9) - 2});
    else
      emit(Opcode::load, {pick(12)});
    ++depth_;
  }

  // The number of a slot, sometimes by an index that may be wrong, sometimes that of a neighbour.
  void address() {
    emit(Opcode::constant, {pick(4)});
    ++depth_;
    if (pick(3) == 0) return;
    number();
    emit(Opcode::index, {pick(3) - 1, 3 + pick(2), 1 + pick(2)});
    --depth_;
    if (pick(2) == 0) emit(Opcode::constant, {pick(2)}), emit(Opcode::add);
  }

  // Instructions that may change the stack, but nothing below its depth now.
  void body(int length, int nesting) {
    const int floor = depth_;
    for (; length > 0; --length) {
      const int above = depth_ - floor;
      switch (pick(20)) {
        case 0:
        case 1:
          number();
          break;
        case 2:
          address();
          emit(Opcode::load_indirect);
          break;
        case 3:
        case 4:
          if (above == 0) number();
          emit(Opcode::store, {pick(12)});
          --depth_;
          break;
        case 5:
          address();
          number();
          emit(Opcode::store_indirect);
          depth_ -= 2;
          break;
        case 6:
          address();
          emit(Opcode::constant, {pick(4)});
          emit(pick(2) == 0 ? Opcode::copy : Opcode::equal_slots, {1 + pick(4)});
          depth_ -= code_[code_.size() - 2] == static_cast<std::int32_t>(Opcode::copy) ? 1 : 0;
          break;
        case 7:
          if (above > 0) emit(Opcode::duplicate), ++depth_;
          break;
        case 8:
          if (above > 1) emit(Opcode::swap);
          break;
        case 9:
          if (above > 1) emit(Opcode::over), ++depth_;
          break;
        case 10:
          if (above > 0) emit(static_cast<Opcode>(33 + pick(3)));
          break;
        case 11:
          if (above > 0 && pick(3) == 0) emit(Opcode::check_range, {-20, 20});
          break;
        case 12:
          number();
          emit(Opcode::constant, {60});
          emit(Opcode::less);
          emit(Opcode::assertion);
          --depth_;
          break;
        case 13:
          if (nesting > 0) choice(nesting);
          break;
        case 14:
          if (nesting > 0) loop(nesting);
          break;
        case 15:
          if (!functions_.empty()) {
            const auto [start, results] =
                functions_[static_cast<std::size_t>(pick(static_cast<int>(functions_.size())))];
            emit(Opcode::call, {start});
            depth_ += results;
          }
          break;
        case 16:
          emit(Opcode::constant, {1 + pick(2)});
          if (pick(3) == 0) {
            emit(Opcode::constant, {1 + pick(2)});
            emit(Opcode::copy_clock);
            break;
          }
          number();
          emit(pick(2) == 0 ? Opcode::reset : Opcode::advance_clock);
          --depth_;
          break;
        default:
          while (depth_ - floor < 2) number();
          emit(pick(2) == 0 ? static_cast<Opcode>(20 + pick(13)) : static_cast<Opcode>(40 + pick(6)));
          --depth_;
      }
    }
  }

  void choice(int nesting) {
    number();
    if (pick(2) == 0) number(), emit(static_cast<Opcode>(40 + pick(6))), --depth_;
    const std::size_t branch = code_.size() + 1;
    emit(pick(2) == 0 ? Opcode::jump_if_zero : Opcode::jump_if_nonzero, {0});
    --depth_;
    const int outer = depth_;
    const int after = outer + pick(2);
    body(1 + pick(4), nesting - 1);
    level(after);
    const std::size_t skip = code_.size() + 1;
    emit(Opcode::jump, {0});
    code_[branch] = here();
    depth_ = outer;
    body(pick(4), nesting - 1);
    level(after);
    code_[skip] = here();
  }

  void loop(int nesting) {
    const std::int32_t counter = slots + first_counter_ + nesting - 1;
    emit(Opcode::constant, {0});
    emit(Opcode::store, {counter});
    const std::int32_t again = here();
    emit(Opcode::load, {counter});
    emit(Opcode::constant, {1 + pick(3)});
    emit(Opcode::greater_equal);
    const std::size_t branch = code_.size() + 1;
    emit(Opcode::jump_if_nonzero, {0});
    const int outer = depth_;
    body(1 + pick(4), nesting - 1);
    level(outer);
    emit(Opcode::load, {counter});
    emit(Opcode::constant, {1});
    emit(Opcode::add);
    emit(Opcode::store, {counter});
    emit(Opcode::jump, {again});
    code_[branch] = here();
  }

  std::mt19937 random_;
  std::vector<std::int32_t>& code_;
  std::vector<std::pair<std::int32_t, int>> functions_;
  std::int32_t first_counter_ = 0;  // functions and the code that calls them count their loops apart
  int depth_ = 0;
};

Program blank_program() {
  Program program;
  program.clocks = 2;
  for (std::int32_t slot = 0; slot < slots; ++slot) program.slots.push_back({-100 + slot, 100, slot % 5, false});
  for (std::int32_t slot = 0; slot < counters; ++slot) program.slots.push_back({0, 9, 0, false});
  program.state_slots = static_cast<std::uint32_t>(program.slots.size());
  return program;
}

Result run(const Program& program, std::int32_t code, std::vector<std::int32_t> memory) {
  Machine machine(program, largest_reset);
  Result result;
  std::vector<ClockReset> resets;
  const std::vector<std::int32_t> before = memory;
  SlotSet written;
  try {
    result.value = machine.update(code, memory.data(), written, resets);
  } catch (const ModelFault& fault) {
    result.fault = {fault.kind, fault.position};
  }
  for (std::size_t slot = 0; slot < memory.size(); ++slot) {
    SlotSet single;
    single.add(slot);
    CHECK(result.fault || memory[slot] == before[slot] || written.meets(single));
  }
  result.memory = memory;
  for (const ClockReset& reset : resets) result.resets.push_back({reset.clock, reset.value, reset.source});
  return result;
}

void test_random_code() {
  int faults = 0;
  for (std::uint32_t seed = 0; seed < 30000; ++seed) {
    Program program = blank_program();
    const std::int32_t start = Writer(seed, program).write();
    std::vector<std::int32_t> memory;
    for (const Slot& slot : program.slots) memory.push_back(slot.initial);
    const Result expected = interpret(program, start, memory);
    const Result found = run(program, start, memory);
    if (!(expected == found)) std::fprintf(stderr, "seed %u\n", seed);
    CHECK(expected == found);
    faults += expected.fault.has_value();
  }
  CHECK(faults > 3000 && faults < 27000);
}

std::int32_t append(Program& program, std::initializer_list<std::int32_t> words) {
  const auto start = static_cast<std::int32_t>(program.code.size());
  program.code.insert(program.code.end(), words);
  return start;
}

void test_a_loop_without_end_is_a_fault() {
  Program program = blank_program();
  const std::int32_t start = append(program, {50, 0});  // JUMP 0
  const Result result = run(program, start, std::vector<std::int32_t>(program.slots.size()));
  CHECK(result.fault && result.fault->first == FaultKind::loop);
}

void test_code_that_makes_no_sense_is_rejected() {
  const auto rejected = [](std::initializer_list<std::int32_t> words) {
    Program program = blank_program();
    append(program, words);
    try {
      run(program, 0, std::vector<std::int32_t>(program.slots.size()));
    } catch (const std::logic_error&) {
      return true;
    }
    return false;
  };
  CHECK(rejected({20, 0}));                 // ADD on an empty stack
  CHECK(rejected({1, 5, 1, 5, 0}));         // two values at the end
  CHECK(rejected({53, 0, 54}));             // a function that calls itself
  CHECK(rejected({1, 1, 52, 6, 1, 2, 0}));  // the stack differs at the end
  CHECK(rejected({1, 1}));                  // no end
}

}  // namespace

int main() {
  test_random_code();
  test_a_loop_without_end_is_a_fault();
  test_code_that_makes_no_sense_is_rejected();
}
