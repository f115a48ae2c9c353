// One run after another of a program, with UPPAAL's stochastic reading: every process draws a delay, the least one
// wins, the winner draws one of its edges (David, Larsen, Legay, Mikucionis, Poulsen, "Uppaal SMC tutorial", 2015).
//
// Processes keep what they have drawn until something changes that it depends on: the rest of an exponential delay is
// distributed like a new one, and what is left of a uniform one is uniform. docs/simulation.md has the whole meaning.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "machine/machine.hpp"
#include "program/program.hpp"
#include "simulation/chances.hpp"
#include "simulation/clock_values.hpp"
#include "simulation/random.hpp"
#include "simulation/tables.hpp"

namespace tachk {

// How long processes wait before they act, within what their guards and invariants allow.
enum class Policy : std::int32_t { stochastic, uniform, earliest, latest };

// Why a run ends.
enum class Ending : std::int32_t {
  horizon,    // it is as long as it was to be
  deadlock,   // nothing can happen and time cannot pass
  time_lock,  // an invariant ends, and nothing can happen
  zeno,       // too many steps without time between them
  steps,      // as many steps as it may have
  fault,      // a run-time error
  initial,    // the initial state breaks an invariant
};

struct RunLimits {
  Ticks until = latest_end;
  std::uint64_t steps = UINT64_MAX;
  std::uint64_t steps_at_once = 1'000'000;
};

class Simulator {
 public:
  struct State {
    std::vector<std::int32_t> slots;  // frame slots included
    ClockValues clocks;
    std::uint32_t committed = 0;  // processes in committed locations
    std::uint32_t urgent = 0;     // in urgent ones
  };
  // What each process has drawn.
  struct Race {
    std::vector<Ticks> due;    // when it acts
    std::vector<Ticks> limit;  // when its invariant ends
    std::vector<std::uint8_t> parked;
  };
  // What a run can be continued from.
  struct Snapshot {
    State state{{}, ClockValues(1)};
    Race race;
    Ticks now = 0;
  };

  // What it is given must outlive it.
  Simulator(const Program& program, const Chances& chances, const Tables& tables, Policy policy);

  // Begins the run with this number. False if its initial state breaks an invariant. Throws ModelFault.
  bool begin(std::uint64_t seed, std::uint64_t run) { return begin(Random(seed, run)); }
  bool begin(Random random);

  // Goes on to the state after the next transition; if there is none, says why. Throws ModelFault.
  std::optional<Ending> step(const RunLimits& limits);

  // The next moment at which something may happen; `never` if nothing does by itself. Nothing happens before.
  Ticks next_moment();

  // Takes an action at this moment that begins with the edge, whether or not its guard holds: what the surroundings of
  // the network do. False, with nothing changed, if nobody receives or invariants forbid it. The moment is neither in
  // the past nor behind `next_moment`. Throws ModelFault.
  bool take(std::uint32_t edge, Ticks moment);

  Snapshot snapshot() const { return {state_, race_, now_}; }
  // Goes on from a snapshot: what processes are still to wait is drawn anew from what is left of it.
  void resume(const Snapshot& snapshot, Random random);

  Ticks now() const { return now_; }
  std::span<const std::uint32_t> edges() const { return action_; }  // of the last transition
  std::int32_t* slots() { return state_.slots.data(); }
  Machine& machine() { return machine_; }
  const ClockValues& clocks() const { return state_.clocks; }
  // The moments at which a condition holds if nothing happens.
  Window moments(const Condition& condition) {
    return integers_hold(condition) ? window(condition) : Window{never, -never};
  }

 private:
  // What the action under way has changed, to be undone if the target invariants do not admit it.
  struct Change {
    SlotSet written;
    std::vector<ClockReset> resets;
    std::vector<std::int32_t> slots;
    std::vector<std::pair<std::uint16_t, Ticks>> values;
    std::vector<std::uint16_t> switched;
    std::uint64_t clocks = 0;            // groups of those that were touched
    std::vector<std::size_t> concerned;  // processes
  };

  const Station& place(std::size_t process) const { return tables_.place(process, state_.slots.data()); }
  std::size_t processes() const { return program_.processes.size(); }

  // ---- conditions
  bool integers_hold(const Condition& condition);
  Window window(const Condition& condition);
  bool open(std::uint32_t edge) {
    const Condition& guard = program_.edges[edge].guard;
    return integers_hold(guard) && window(guard).holds(now_);
  }
  std::int32_t channel_of(const Edge& edge);
  bool hears(std::uint32_t number, std::int32_t channel);

  // ---- the race
  std::pair<Ticks, Ticks> next_moments() const;
  std::size_t winner_at(Ticks moment);
  void refresh(std::size_t process);
  void park(std::size_t process);
  Ticks next_opening(std::uint32_t edge, Window own);
  Ticks drawn(std::size_t process, Ticks first, Ticks last);
  Ticks uniform(Ticks first, Ticks last) {
    return first + static_cast<Ticks>(random_.below(static_cast<std::uint64_t>(last - first) + 1));
  }

  // ---- actions
  bool act(std::size_t process);
  bool carry_out();
  bool act_first(std::vector<std::size_t>& candidates);
  bool act_now();
  bool frozen();
  bool sends_urgently(std::size_t process);
  bool admits(std::size_t process) const { return state_.committed == 0 || place(process).location->committed; }
  bool offers(std::size_t process, std::uint32_t edge);
  bool offers_alone(std::size_t process, std::uint32_t edge);
  bool has_receiver(std::size_t sender, std::int32_t channel, bool committed_only);
  void open_receives(std::size_t process, std::int32_t channel, std::vector<std::uint32_t>& found);
  std::uint32_t pick(std::span<const std::uint32_t> edges);
  double weight(std::uint32_t edge);
  bool choose(std::span<const std::uint32_t> offered);
  bool act_exhaustively(std::span<const std::uint32_t> offered);
  void enumerate(std::uint32_t first, std::vector<std::vector<std::uint32_t>>& actions,
                 std::vector<double>& probabilities, double probability);
  std::vector<std::pair<std::uint32_t, double>> shares(std::span<const std::uint32_t> edges);

  // ---- changes
  bool apply();
  void update();
  void switch_clocks();
  bool touched(std::size_t process) const {
    const Station& here = place(process);
    return here.reads.meets(change_.written) || (here.clocks & change_.clocks) != 0;
  }
  void find_concerned();
  bool invariants_hold();
  void undo();
  void settle();

  const Program& program_;
  const Chances& chances_;
  const Tables& tables_;
  const Policy policy_;
  Machine machine_;
  Random random_;
  State state_;
  Race race_;
  Change change_;
  Ticks now_ = 0;
  std::vector<std::uint32_t> action_;
  std::vector<std::uint32_t> offered_;
  std::vector<std::uint32_t> heard_;
  std::vector<std::uint32_t> partner_;
  std::vector<std::size_t> candidates_;
};

}  // namespace tachk
