// The meaning of a compiled program: written independently of the engine, to judge it, and as plainly as possible. Of
// the core it uses the program (program/) and the machine that evaluates its expressions (machine/), nothing else.
// Nothing is extrapolated, and no option changes anything. What cannot be evaluated throws ModelFault.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "certificates/zones.hpp"
#include "machine/machine.hpp"
#include "program/program.hpp"

namespace tachk::certificates {

// A discrete state and what it says of time.
struct Situation {
  std::vector<std::int32_t> slots;  // those of frames have no meaning
  bool possible = true;             // whether clocks can satisfy the invariants, as far as that is known without them
  Constraints limits;               // of the invariants
  bool waits = true;                // whether time may pass
  std::vector<bool> stands;         // the clocks that stand still, the reference clock among them
  bool stops = false;               // whether others than that one do
};

struct Step {
  std::vector<std::uint32_t> edges;
  Zone guarded;  // where the guards hold
  Situation target;
  std::vector<zones::ClockReset> resets;
  std::pair<std::int32_t, std::int32_t> priority;

  Zone possible() const;  // where in the source it is: its resets lead into the invariant of the target
  Zone& reach();          // makes of `guarded` what is reached right after it
};

// Steps in memory that has been that of others.
class Steps {
 public:
  void clear() { count_ = 0; }
  Step& add() {
    if (count_ == all_.size()) all_.emplace_back();
    return all_[count_++];
  }
  void drop_last() { --count_; }
  std::span<Step> found() { return {all_.data(), count_}; }

 private:
  std::vector<Step> all_;
  std::size_t count_ = 0;
};

class Network final {
 public:
  explicit Network(program::Program given);

  std::vector<std::int32_t> initial() const;
  // Makes a situation of its slots.
  void describe(Situation& here);
  // The delay successors of a zone; a superset if clocks are stopped.
  Zone later(const Situation& here, Zone zone) const;
  // The steps from a zone; those that a higher priority forbids come without the part where it does, in several pieces.
  std::span<Step> steps(Situation& here, const Zone& zone, Steps& room);
  // The parts of a zone where a goal holds. Where it contains `deadlock` and clocks are stopped, it is perhaps more
  // than that, or less if not `widely`.
  Zones where(const program::Goal& goal, Situation& here, const Zone& zone, bool widely);
  // From where in a zone no step is possible, now or later; likewise.
  Zones stuck(Situation& here, const Zone& zone, bool widely);
  // The valuations that delays reach from a zone as long as a goal does not hold.
  Zones avoiding(const program::Goal& goal, Situation& here, const Zone& zone);

  const program::Program program;
  const std::size_t n;                     // clocks, the reference clock included
  std::vector<std::uint32_t> taking_part;  // the edges of the step under construction

 private:
  using Slots = std::vector<std::int32_t>;
  struct Part {
    Constraints guard;
    Zone zone;
  };

  const program::Location& location(std::size_t process, const Slots& slots) const;
  const std::vector<std::uint32_t>& leaving(std::size_t process, const Slots& slots) const;
  bool holds(const program::Condition& condition, Slots& slots, Constraints& constraints);
  const Zone* where(const program::Edge& edge, Slots& slots, const Zone& zone, Part& room);
  std::int32_t channel(const program::Edge& edge, Slots& slots);
  bool receives(const program::Edge& edge, std::int32_t used, Slots& slots);
  bool is_urgent(Slots& slots);
  void find_steps(Situation& here, const Zone& zone);
  void add_partner(Slots& slots, std::int32_t used, const Zone& zone, bool free);
  void add_receivers(Slots& slots, std::size_t next, std::int32_t used, const Zone& zone, bool free);
  void add_step(const Slots& slots, const Zone& guarded, std::int32_t used);
  void hold_back_lower_priorities();

  machine::Machine machine_;
  std::vector<std::vector<std::vector<std::uint32_t>>> leaving_;  // of each process and location, the edges
  std::vector<std::vector<std::uint32_t>> receivers_;             // of each channel, the processes that may receive
  std::vector<std::uint32_t> metas_;
  bool has_urgent_channels_ = false;
  int most_ = 0;  // the largest commitment where steps are looked for
  Steps steps_;   // under construction
};

}  // namespace tachk::certificates
