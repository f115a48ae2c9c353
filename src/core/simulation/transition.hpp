// The change that an action makes, to be undone if the target invariants do not admit it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "simulation/present.hpp"
#include "simulation/tournament.hpp"

namespace tachk::simulation {

class Transition {
 public:
  explicit Transition(std::size_t processes) : readers_(processes) {}

  // Makes the changes of the action; says whether invariants admit the state after it.
  bool enter(Present& present, std::span<const std::uint32_t> action);
  // Makes clocks run or stand as the initial locations want; says whether their invariants hold.
  bool begin(Present& present);
  void undo(Present& present);
  // The change stays.
  void settle() { under_way_ = false; }

  bool under_way() const { return under_way_; }
  bool changes_flow() const { return flow_; }                               // hybrid clocks go on in another way
  const std::vector<std::size_t>& concerned() const { return concerned_; }  // no other draw is void

 private:
  void update(Present& present, std::span<const std::uint32_t> action);
  void switch_clocks(Present& present);
  void find_concerned(const Present& present, std::span<const std::uint32_t> action);
  bool touches(const Dependencies& dependencies) const {
    return dependencies.reads.meets(written_) || (dependencies.clocks & clocks_) != 0 ||
           (flow_ && dependencies.depends_on_flow);
  }
  void find_readers(const Present& present);
  bool invariants_hold(Present& present) const;

  program::SlotSet written_;
  std::vector<zones::ClockReset> resets_;
  std::vector<std::int32_t> slots_;
  std::vector<std::pair<std::uint16_t, flow::Ticks>> values_;
  std::vector<std::uint16_t> switched_;
  std::uint64_t clocks_ = 0;            // groups of those that were touched
  std::vector<std::size_t> concerned_;  // processes
  ProcessSet readers_;                  // those of which some location depends on the change
  bool flow_ = false;
  bool under_way_ = false;
};

}  // namespace tachk::simulation
