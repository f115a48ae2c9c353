// The slots and clocks that pieces of code, conditions and updates may read and write. Perhaps more than
// they do: where code computes the number of a slot, all that this number may be.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "machine/machine_code.hpp"
#include "program/program.hpp"

namespace tachk::machine {

// A set of slots of the state, but for metas, and of clocks.
class AccessSet {
 public:
  explicit AccessSet(const program::Program& program);

  void add_slots(std::int64_t first, std::int64_t last);
  void add_clock(std::size_t clock);
  void add_everything();
  void add(const AccessSet& other);
  bool meets(const AccessSet& other) const;
  bool has_slot(std::size_t slot) const { return has_bit(slot); }
  bool has_clock(std::size_t clock) const { return has_bit(program_->state_slots + clock); }

 private:
  bool has_bit(std::size_t bit) const { return (words_[bit / 64] >> bit % 64 & 1) != 0; }
  void add_bit(std::size_t bit) { words_[bit / 64] |= std::uint64_t{1} << bit % 64; }

  const program::Program* program_;
  std::vector<std::uint64_t> words_;  // slots, then clocks
};

class CodeAccesses {
 public:
  explicit CodeAccesses(const program::Program& program)
      : reads(program), writes(program), program_(program), code_(program) {}

  void add(std::int32_t code);
  void add(const program::Condition& condition);
  void add(const program::Update& update);
  // Forgets what has been read and written.
  void clear();

  AccessSet reads;
  AccessSet writes;

 private:
  struct Interpretation;

  const program::Program& program_;
  MachineCode code_;
};

}  // namespace tachk::machine
