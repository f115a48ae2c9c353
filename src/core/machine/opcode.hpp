// The numbers of src/tachk/engine/compiler/bytecode.py (instructions) and src/tachk/model/fault.py (faults); a test
// compares them. What an instruction does is documented there.
#pragma once

#include <cstdint>

namespace tachk::machine {

enum class Opcode : std::int32_t {
  end = 0,
  constant = 1,
  load = 2,
  load_indirect = 3,
  store = 4,
  store_indirect = 5,
  index = 6,
  copy = 7,
  equal_slots = 8,
  reset = 9,
  duplicate = 10,
  pop = 11,
  swap = 12,
  over = 13,
  table = 14,
  copy_clock = 15,
  advance_clock = 16,
  add = 20,
  subtract = 21,
  multiply = 22,
  divide = 23,
  modulo = 24,
  power = 25,
  bit_and = 26,
  bit_or = 27,
  bit_xor = 28,
  shift_left = 29,
  shift_right = 30,
  minimum = 31,
  maximum = 32,
  negate = 33,
  logical_not = 34,
  boolean = 35,
  equal = 40,
  not_equal = 41,
  less = 42,
  less_equal = 43,
  greater = 44,
  greater_equal = 45,
  jump = 50,
  jump_if_zero = 51,
  jump_if_nonzero = 52,
  call = 53,
  call_return = 54,
  assertion = 55,
  check_range = 56,
  floating = 57,
};

// The run-time errors of a model.
enum class FaultKind {
  range,
  index,
  division,
  negative_clock,
  shift,
  negative_exponent,
  assertion,
  loop,
  not_finite,
  bound,
};

}  // namespace tachk::machine
