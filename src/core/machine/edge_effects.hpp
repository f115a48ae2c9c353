// What edges do to clocks and variables in any state, and whether evaluating them can be a run-time error, read off
// their code without running it: off each sequence of instructions. Code that branches, or calls a function that does
// anything to a clock, sets the clocks that `CodeAccesses` says, to anything, and may fail.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "machine/machine_code.hpp"
#include "program/program.hpp"

namespace tachk::machine {

struct EdgeEffects {
  struct OnClock {
    std::uint16_t clock;
    std::optional<std::int64_t> value;  // in units of the program; none: any
  };
  enum class Kind : std::uint8_t { set, raise, anything };
  struct OnSlot {
    std::uint32_t slot;
    Kind kind;
    std::int64_t number;  // that is stored, or added to what was there
  };

  std::vector<OnClock> clocks;  // in order
  std::vector<OnSlot> slots;    // of the state, in order
  bool any_slot = false;        // in place of `slots`: it is not known which ones are written
  bool guard_can_fail = false;  // or the channel
  bool update_can_fail = false;
};

class EffectReader {
 public:
  explicit EffectReader(const program::Program& program) : program_(program), code_(program) {}

  EdgeEffects of(const program::Edge& edge);
  // What code may do to variables, where `any_slot` is all that is known.
  std::vector<EdgeEffects::OnSlot> slots_of(const program::Edge& edge) const;
  // True if evaluating a condition can be a run-time error.
  bool can_fail(const program::Condition& condition);

 private:
  class Sequence;
  struct Range {
    std::int64_t low = INT32_MIN;
    std::int64_t high = INT32_MAX;

    bool lies_in(std::int64_t least, std::int64_t largest) const { return low >= least && high <= largest; }
  };
  // A number on the stack: what a slot held before the code, and so much more, or anything in the range.
  struct Term {
    Range range;
    std::int64_t slot = -1;
    std::int64_t offset = 0;

    bool is_constant() const { return range.low == range.high; }
  };
  using Known = std::map<std::uint32_t, Term>;

  static Term within(std::int64_t low, std::int64_t high);
  // True if evaluating code can be a run-time error, or its value lies beyond what is expected of it.
  bool fails(std::int32_t code, Range expected);
  bool fails(std::int32_t code) { return fails(code, Range{}); }
  bool is_harmless(std::int32_t start) const;
  // The clocks that code may set.
  const std::vector<std::uint16_t>& clocks_set_by(std::int32_t code);
  // The ranges of variables where the tests of a guard hold.
  Known narrowed(const program::Condition& guard) const;

  const program::Program& program_;
  MachineCode code_;
  std::map<std::int32_t, std::vector<std::uint16_t>> clocks_set_;  // by code that has been looked at
};

}  // namespace tachk::machine
