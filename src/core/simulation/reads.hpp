// Which slots of the state pieces of code and conditions read: what does not change them does not change their values.
#pragma once

#include "machine/machine_code.hpp"
#include "program/program.hpp"

namespace tachk {

// Perhaps more slots than are read.
class Reads {
 public:
  explicit Reads(const Program& program) : program_(program), code_(program) {}

  void add(std::int32_t code);
  void add(const Condition& condition);

  const SlotSet& slots() const { return slots_; }
  bool reads_locations() const { return reads_locations_; }

 private:
  void add_range(std::int64_t first, std::int64_t count);
  void add_all();
  void add_operands(const Instruction& instruction);

  const Program& program_;
  MachineCode code_;
  SlotSet slots_;
  bool reads_locations_ = false;
};

}  // namespace tachk
