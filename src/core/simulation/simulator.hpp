// One run after another of a program, with UPPAAL's stochastic semantics: every process draws a delay, the least one
// wins, the winner draws one of its edges (David, Larsen, Legay, Mikucionis, Poulsen, "Uppaal SMC tutorial", 2015).
//
// Processes keep what they have drawn until something changes that it depends on: the rest of an exponential delay is
// distributed like a new one, and what is left of a uniform one is uniform. docs/simulation.md has the whole meaning.
//
// The parts: where the run is (Present), when processes act (Race), which action is taken (ActionChoice), and what it
// changes (Transition).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "simulation/action_choice.hpp"
#include "simulation/present.hpp"
#include "simulation/race.hpp"
#include "simulation/transition.hpp"

namespace tachk::simulation {

// Why a run ends.
enum class Ending : std::int32_t {
  horizon,      // it is as long as it was to be
  deadlock,     // nothing can happen and time cannot pass
  time_lock,    // an invariant ends, and nothing can happen
  zeno,         // too many steps without time between them
  steps,        // as many steps as it may have
  fault,        // a run-time error
  initial,      // the initial state breaks an invariant
  end_of_time,  // it has no bound on time, and the ticks are used up
};

// A run that takes more transitions at one time is taken for Zeno.
inline constexpr std::uint64_t most_steps_at_once = 1'000'000;

struct RunLimits {
  flow::Ticks until = flow::latest_end;
  std::uint64_t steps = UINT64_MAX;
  std::uint64_t steps_at_once = most_steps_at_once;
};

class Simulator {
 public:
  // A state from which a run can be continued.
  struct Snapshot {
    Values values{{}, flow::ClockValues(1)};
    Race race{0};
    flow::Ticks now = 0;
  };

  // The arguments must outlive it.
  Simulator(const program::Program& program, const flow::Chances& chances, const Tables& tables, Policy policy,
            flow::Ticks ticks_per_unit = flow::finest_ticks)
      : present_(program, chances, tables, policy, ticks_per_unit),
        race_(program.processes.size()),
        transition_(program.processes.size()) {}

  // Begins the run with this number. False if its initial state breaks an invariant. Throws ModelFault.
  bool begin(std::uint64_t seed, std::uint64_t run) { return begin(Random(seed, run)); }
  bool begin(const Random& random);

  // Goes on to the state after the next transition; if there is none, says why. Throws ModelFault.
  std::optional<Ending> step(const RunLimits& limits);

  // The next moment at which something may happen; `never` if nothing does by itself. Nothing happens before.
  flow::Ticks next_moment();

  // Takes an action at this moment that begins with the edge, whether or not its guard holds: an action of
  // its environment. False, with nothing changed, without a receiver or if invariants forbid it. The moment is neither
  // in the past nor behind `next_moment`. Throws ModelFault.
  bool take(std::uint32_t edge, flow::Ticks moment);

  // True if some time can pass in this state, however little. Throws ModelFault.
  bool time_passes();
  // After a fault: back to the state before the action that it has interrupted, which ends the run.
  void retreat();

  Snapshot snapshot() const { return {present_.values, race_, present_.now}; }
  // Goes on from a snapshot: what processes are still to wait is drawn anew from what is left of it.
  void resume(const Snapshot& snapshot, const Random& random);

  flow::Ticks now() const { return present_.now; }
  std::span<const std::uint32_t> edges() const { return action_; }  // of the last transition
  std::int32_t* slots() { return present_.values.slots.data(); }
  machine::Machine& machine() { return present_.machine; }
  const flow::ClockValues& clocks() const { return present_.values.clocks; }
  // The moments at which a condition holds if nothing happens; with hybrid clocks the first of them, if it is not
  // after `lookahead`.
  flow::Window moments(const program::Condition& condition) {
    present_.lookahead = flow::never;
    return present_.integers_hold(condition) ? present_.window(condition, present_.now)
                                             : flow::Window{flow::never, -flow::never};
  }
  // How far the last condition was looked at.
  flow::Ticks lookahead() const { return present_.lookahead; }
  bool has_hybrid_clocks() const { return present_.flow.exists(); }

 private:
  using Priority = std::pair<std::int32_t, std::int32_t>;

  bool frozen();
  bool act_now();
  bool act_first(std::vector<std::size_t>& candidates);
  bool act(std::size_t process);
  bool carry_out();
  bool act_exhaustively();
  bool act_by_priority(std::size_t process);
  Priority priority(const Action& action);
  bool admitted(const Action& action);
  bool apply();

  Present present_;
  Race race_;
  ActionChoice choice_;
  Transition transition_;
  Action action_;
  // Lists that are made anew each time, kept for their memory.
  std::vector<std::uint32_t> enabled_;
  std::vector<std::size_t> candidates_;
};

}  // namespace tachk::simulation
