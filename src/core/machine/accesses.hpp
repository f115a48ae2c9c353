// Which slots of the state, and which clocks, a part of a program touches: what does not touch the same things can be
// done in either order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "machine/machine_code.hpp"
#include "program/program.hpp"

namespace tachk {

// Perhaps more than are touched, never fewer.
struct Touched {
  explicit Touched(const Program& program);

  std::vector<bool> read;     // by slot of the state
  std::vector<bool> written;  // by slot of the state
  std::vector<bool> clocks;   // compared or reset, by number; number 0 is never
};

class Accesses {
 public:
  explicit Accesses(const Program& program) : program_(program), code_(program) {}

  // What an edge does: its guard, the choice of its channel, its updates, and the locations it leaves and enters.
  Touched edge(const Edge& edge);
  void add(const Condition& condition, Touched& touched);
  void add(std::int32_t code, Touched& touched);

 private:
  std::vector<Instruction> reachable(std::int32_t entry) const;
  // `computed`: the slots whose numbers may be in a register.
  void add(const Instruction& instruction, const std::vector<bool>& computed, Touched& touched) const;
  std::optional<std::int64_t> clock_of(const Operand& operand) const;
  std::int32_t value(const Operand& constant) const { return code_.constants()[constant.index]; }

  const Program& program_;
  MachineCode code_;
};

}  // namespace tachk
