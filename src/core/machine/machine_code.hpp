// The code of a program as the machine runs it. Stack code (see tachk.engine.compiler.bytecode) is easy to generate and
// to check but slow to run: most instructions only move numbers to the stack. Here an instruction names its operands,
// and what stack code does in two to five instructions (load, constant, compare, jump) is one.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "machine/opcode.hpp"
#include "program/program.hpp"

namespace tachk::machine {

enum class Operation : std::uint8_t {
  move,          // target = left; targets are registers, or instructions to go on with
  store,         // the slot target = left, which must lie in [extra[0], extra[1]]
  store_at,      // the slot with the number left = right
  load_at,       // target = the slot with the number left
  address,       // target = left + (right - extra[0]) * extra[2] + extra[3], with right - extra[0] in [0, extra[1])
  load_element,  // target = the slot at that address
  table,         // target = the word of the code at extra[0] + right - extra[1], with right - extra[1] in [0, extra[2])
  copy,          // extra[0] slots from the one with the number right to the one with the number left
  equal_slots,   // target = whether extra[0] slots from left on equal those from right on
  reset,         // the clock left = right
  copy_clock,    // the clock left = the clock right
  advance_clock,  // the clock left = itself and right
  add,
  subtract,
  multiply,
  divide,
  modulo,
  power,
  bit_and,
  bit_or,
  bit_xor,
  shift_left,
  shift_right,
  minimum,
  maximum,
  negate,
  equal,
  not_equal,
  less,
  less_equal,
  greater,
  greater_equal,
  jump,  // to the instruction target
  jump_if_equal,
  jump_if_not_equal,
  jump_if_less,
  jump_if_less_equal,
  jump_if_greater,
  jump_if_greater_equal,
  call,         // the instruction target, with the registers from extra[0] on as its registers
  call_return,  // the result, if any, is in register 0
  assertion,    // of left
  check_range,  // of left, as for store
  floating,     // target = the FloatingOperation extra[0] on left and right; a double goes to the slot extra[1]
  end,          // the value is left
};

// Where an operand lies.
enum class Place : std::uint8_t { memory, registers, constants };

struct Operand {
  Place place;
  std::int32_t index;

  bool operator==(const Operand&) const = default;
};

struct Instruction {
  Operation operation;
  Operand left;
  Operand right;
  std::int32_t target;
  std::int32_t position;  // in the stack code, for reports of faults
  std::int32_t extra[4];  // for jumps, calls and returns extra[1]: how many instructions of the stack code end here
};

struct StackEffect {
  int operands;  // words behind the opcode
  int pops;
  int pushes;
};

// Of all instructions but calls, which push what the function leaves.
StackEffect effect_of(Opcode opcode);

// Translates pieces of stack code on demand.
class MachineCode {
 public:
  explicit MachineCode(const program::Program& program);

  // The number of the first instruction of the piece of code at this position of the stack code.
  std::int32_t entry(std::int32_t position) {
    const std::int32_t known = entries_[static_cast<std::size_t>(position)];
    return known >= 0 ? known : translate(position).entry;
  }
  // How many numbers the function at this position of the stack code leaves.
  std::int32_t results(std::int32_t position) { return translate(position).results; }
  const Instruction* instructions() const { return instructions_.data(); }
  const std::int32_t* constants() const { return constants_.data(); }
  // How many registers any piece of code and the functions it calls need at most.
  std::size_t registers() const { return registers_; }

 private:
  friend class Translation;

  // A translated piece of code or function.
  struct Piece {
    std::int32_t entry;
    std::int32_t results;    // numbers on the stack at its end, 0 or 1
    std::int32_t registers;  // of its own and of the functions it calls
  };

  const Piece& translate(std::int32_t position);
  Operand constant(std::int32_t value);

  const program::Program& program_;
  std::vector<std::int32_t> entries_;  // by position of the stack code; -1: not translated
  std::map<std::int32_t, Piece> pieces_;
  std::vector<Instruction> instructions_;
  std::vector<std::int32_t> constants_;
  std::map<std::int32_t, std::int32_t> constant_numbers_;
  std::size_t registers_ = 0;
};

}  // namespace tachk::machine
