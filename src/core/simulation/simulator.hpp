// One run after another of a program, with UPPAAL's stochastic reading: every process draws a delay, the least one
// wins, the winner draws one of its edges (David, Larsen, Legay, Mikucionis, Poulsen, "Uppaal SMC tutorial", 2015).
//
// Processes keep what they have drawn until something changes that it depends on: the rest of an exponential delay is
// distributed like a new one, and what is left of a uniform one is uniform. docs/simulation.md has the whole meaning.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "flow/chances.hpp"
#include "flow/clock_values.hpp"
#include "flow/crossings.hpp"
#include "flow/flow.hpp"
#include "machine/machine.hpp"
#include "program/program.hpp"
#include "simulation/random.hpp"
#include "simulation/tables.hpp"

namespace tachk::simulation {

// How long processes wait before they act, within what their guards and invariants allow.
enum class Policy : std::int32_t { stochastic, uniform, earliest, latest };

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
  struct State {
    std::vector<std::int32_t> slots;  // frame slots included
    flow::ClockValues clocks;
    std::uint32_t committed = 0;  // processes in committed locations
    std::uint32_t urgent = 0;     // in urgent ones
  };
  enum class Wait : std::uint8_t {
    to_act,
    parked,   // nothing was possible when it was to act
    to_look,  // it was not looked farther ahead for what hybrid clocks allow
  };
  // What each process has drawn.
  struct Race {
    std::vector<flow::Ticks> due;    // when it acts
    std::vector<flow::Ticks> limit;  // when its invariant ends
    std::vector<Wait> waits;
  };
  // What a run can be continued from.
  struct Snapshot {
    State state{{}, flow::ClockValues(1)};
    Race race;
    flow::Ticks now = 0;
  };

  // What it is given must outlive it.
  Simulator(const program::Program& program, const flow::Chances& chances, const Tables& tables, Policy policy,
            flow::Ticks ticks_per_unit = flow::finest_ticks);

  // Begins the run with this number. False if its initial state breaks an invariant. Throws ModelFault.
  bool begin(std::uint64_t seed, std::uint64_t run) { return begin(Random(seed, run)); }
  bool begin(const Random& random);

  // Goes on to the state after the next transition; if there is none, says why. Throws ModelFault.
  std::optional<Ending> step(const RunLimits& limits);

  // The next moment at which something may happen; `never` if nothing does by itself. Nothing happens before.
  flow::Ticks next_moment();

  // Takes an action at this moment that begins with the edge, whether or not its guard holds: what the surroundings of
  // the network do. False, with nothing changed, if nobody receives or invariants forbid it. The moment is neither in
  // the past nor behind `next_moment`. Throws ModelFault.
  bool take(std::uint32_t edge, flow::Ticks moment);

  // Whether some time can pass in this state, however little. Throws ModelFault.
  bool time_passes();
  // After a fault: back to the state before the action that it has interrupted, which ends the run.
  void retreat();

  Snapshot snapshot() const { return {state_, race_, now_}; }
  // Goes on from a snapshot: what processes are still to wait is drawn anew from what is left of it.
  void resume(const Snapshot& snapshot, const Random& random);

  flow::Ticks now() const { return now_; }
  std::span<const std::uint32_t> edges() const { return action_; }  // of the last transition
  std::int32_t* slots() { return state_.slots.data(); }
  machine::Machine& machine() { return machine_; }
  const flow::ClockValues& clocks() const { return state_.clocks; }
  // The moments at which a condition holds if nothing happens; with hybrid clocks the first of them, if it is not
  // behind `sight`.
  flow::Window moments(const program::Condition& condition) {
    sight_ = flow::never;
    return integers_hold(condition) ? window(condition, now_) : flow::Window{flow::never, -flow::never};
  }
  // How far the last condition was looked at.
  flow::Ticks sight() const { return sight_; }
  bool has_hybrid_clocks() const { return flow_.exists(); }

 private:
  // What the action under way has changed, to be undone if the target invariants do not admit it.
  struct Change {
    program::SlotSet written;
    std::vector<zones::ClockReset> resets;
    std::vector<std::int32_t> slots;
    std::vector<std::pair<std::uint16_t, flow::Ticks>> values;
    std::vector<std::uint16_t> switched;
    std::uint64_t clocks = 0;            // groups of those that were touched
    std::vector<std::size_t> concerned;  // processes
    bool flow = false;                   // hybrid clocks go on in another way
    bool under_way = false;
  };

  // Lists that are made anew each time, kept for their memory.
  struct Scratch {
    std::vector<std::uint32_t> offered;
    std::vector<std::uint32_t> heard;
    std::vector<std::uint32_t> partner;
    std::vector<std::size_t> candidates;
  };

  flow::Ticks unit() const { return flow_.ticks_per_unit(); }
  const Station& place(std::size_t process) const { return tables_.place(process, state_.slots.data()); }
  std::size_t processes() const { return program_.processes.size(); }

  // ---- conditions
  bool may_hold(const Gate& gate) const { return gate.may_hold(state_.slots.data()); }
  bool integers_hold(const program::Condition& condition);
  bool holds(const program::Condition& condition) {
    return integers_hold(condition) && clock_window(condition).holds(now_) &&
           (condition.flow.empty() || crossings().hold(condition.flow));
  }
  flow::Window clock_window(const program::Condition& condition, zones::Raw closure = 0);
  flow::Window window(const program::Condition& condition, flow::Ticks from);
  flow::Ticks end_of(const program::Condition& invariant, flow::Ticks sight);
  flow::Crossings crossings() { return {flow_, machine_, state_.slots.data()}; }
  bool open(std::uint32_t edge) { return holds(program_.edges[edge].guard); }
  std::int32_t channel_of(const program::Edge& edge);
  bool hears(const Reception& reception, std::int32_t channel);

  // ---- the race
  std::pair<flow::Ticks, flow::Ticks> next_moments() const;
  std::size_t winner_at(flow::Ticks moment);
  void refresh(std::size_t process);
  void park(std::size_t process);
  // When edges of a process can be taken: the first and the last moment, and the first one of urgent edges.
  struct Openings {
    flow::Ticks first = flow::never;
    flow::Ticks last = -flow::never;
    flow::Ticks at_once = flow::never;

    void add(flow::Window window, bool urgent) {
      if (urgent) {
        at_once = std::min(at_once, window.first);
        return;
      }
      first = std::min(first, window.first);
      last = std::max(last, window.last);
    }
  };
  void wait_for(std::size_t process, const Openings& openings, Wait wait);
  bool acts_at_once(std::uint32_t edge);
  void move_to(flow::Ticks moment) {
    now_ = moment;
    if (flow_.exists()) flow_.show(now_, machine_, state_.slots.data());
  }
  flow::Ticks next_opening(std::uint32_t edge, flow::Window own);
  flow::Ticks drawn(std::size_t process, flow::Ticks first, flow::Ticks last);
  flow::Ticks uniform(flow::Ticks first, flow::Ticks last) {
    return first + static_cast<flow::Ticks>(random_.below(static_cast<std::uint64_t>(last - first) + 1));
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
  using Priority = std::pair<std::int32_t, std::int32_t>;
  bool act_by_priority(std::size_t process);
  Priority priority(std::span<const std::uint32_t> action);
  bool admitted(std::span<const std::uint32_t> action);
  std::vector<std::pair<std::uint32_t, double>> shares(std::span<const std::uint32_t> edges);

  // ---- changes
  bool apply();
  bool enter();
  void update();
  void switch_clocks();
  bool touched(std::size_t process) const {
    const Outlook& here = outlooks_[process];
    return here.reads.meets(change_.written) || (here.clocks & change_.clocks) != 0 ||
           (change_.flow && here.looks_at_flow);
  }
  void look_from(std::size_t process) { outlooks_[process] = place(process).outlook; }
  bool changes_flow() const;
  void find_concerned();
  bool invariants_hold();
  void undo();
  void settle();

  const program::Program& program_;
  const flow::Chances& chances_;
  const Tables& tables_;
  const Policy policy_;
  machine::Machine machine_;
  Random random_;
  State state_;
  Race race_;
  Change change_;
  flow::Flow flow_;
  flow::Ticks now_ = 0;
  flow::Ticks sight_ = flow::never;
  std::vector<std::uint32_t> action_;
  Scratch scratch_;
  std::vector<Outlook> outlooks_;  // of the locations in which the processes are
};

}  // namespace tachk::simulation
