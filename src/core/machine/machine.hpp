// The machine that evaluates guards, updates and predicates.
#pragma once

#include <cstdint>
#include <exception>
#include <vector>

#include "machine/floating.hpp"
#include "machine/machine_code.hpp"
#include "machine/opcode.hpp"
#include "program/program.hpp"
#include "zones/bound.hpp"

namespace tachk::machine {

// A run-time error of the model, at a code position.
struct ModelFault : std::exception {
  ModelFault(FaultKind fault_kind, std::int32_t code_position) : kind(fault_kind), position(code_position) {}
  const char* what() const noexcept override { return "run-time error of the model"; }

  FaultKind kind;
  std::int32_t position;
};

// The largest value that clocks may be set to in runs with exact times, in time units.
inline constexpr zones::Raw largest_exact_reset = INT32_MAX;

class Machine {
 public:
  // A clock set to more than `largest_reset` time units is a fault: the zones could not represent it.
  Machine(const program::Program& program, zones::Raw largest_reset)
      : program_(program), largest_reset_(largest_reset), code_(program) {}

  // The default source of random numbers for code; nullptr: none.
  void draw_from(Dice* dice) { dice_ = dice; }

  // The value of a piece of code. `memory` holds all slots; frame slots may be written. Throws ModelFault.
  std::int64_t value(std::int32_t code, std::int32_t* memory) { return run(code, memory, nullptr); }

  // The value of code that computes a time, in the program's time unit. Throws ModelFault.
  std::int64_t time(std::int32_t code, std::int32_t* memory) { return in_units(run(code, memory, nullptr)); }

  // Runs an update: writes slots, which it reports, and appends clock resets in order. Throws ModelFault.
  std::int64_t update(std::int32_t code, std::int32_t* memory, program::SlotSet& written,
                      std::vector<zones::ClockReset>& resets) {
    written_ = {};
    const std::int64_t value = run(code, memory, &resets);
    written.add(written_);
    return value;
  }

  // How many instructions pieces of code have run so far, as far as jumps count them.
  std::uint64_t instructions() const { return instructions_; }

 private:
  std::int64_t in_units(std::int64_t time) const;
  std::int64_t run(std::int32_t code, std::int32_t* memory, std::vector<zones::ClockReset>* resets);

  struct Frame {
    const Instruction* next;
    std::int32_t* registers;
  };

  const program::Program& program_;
  zones::Raw largest_reset_;
  MachineCode code_;
  program::SlotSet written_;
  Dice* dice_ = nullptr;
  std::uint64_t instructions_ = 0;
  std::vector<std::int32_t> registers_;
  std::vector<Frame> calls_;          // those open, with what to go on with
  std::vector<std::int32_t> copied_;  // by the copy under way
};

}  // namespace tachk::machine
