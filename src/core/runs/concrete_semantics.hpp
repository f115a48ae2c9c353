// The meaning of a program on a single run: the constraints on clocks in a state, and the effect of a transition.
// It uses the program and the machine only, and nothing of the search.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "machine/machine.hpp"
#include "program/program.hpp"

namespace tachk::runs {

class ConcreteSemantics {
 public:
  // The program must outlive it.
  explicit ConcreteSemantics(const program::Program& program);

  // Goes to the initial state.
  void begin();

  // True if the integer part of a condition holds; then its clock constraints are appended. Throws ModelFault.
  bool holds(const program::Condition& condition, std::vector<zones::Atom>& constraints);
  // The same of the invariants of all processes.
  bool invariants(std::vector<zones::Atom>& constraints);
  // True if no location is urgent or committed.
  bool waits() const;
  // The number of the channel that an edge names. Throws ModelFault.
  std::int32_t channel(const program::Edge& edge);
  // Executes updates and goes to the targets; appends what clocks are set to. Throws ModelFault.
  void take(std::span<const std::uint32_t> edges, std::vector<zones::ClockReset>& resets);

  // The slots of the state.
  std::vector<std::int32_t> state() const { return {slots_.begin(), slots_.begin() + program_.state_slots}; }

  const program::Location& location(std::size_t process) const {
    return program_.processes[process].locations[static_cast<std::size_t>(slots_[process])];
  }
  // The edges that leave the present location of a process.
  const std::vector<std::uint32_t>& leaving(std::size_t process) const {
    return leaving_[process][static_cast<std::size_t>(slots_[process])];
  }

 private:
  const program::Program& program_;
  machine::Machine machine_;
  std::vector<std::int32_t> slots_;
  std::vector<std::uint32_t> metas_;
  std::vector<std::vector<std::vector<std::uint32_t>>> leaving_;
  program::SlotSet written_;
};

}  // namespace tachk::runs
