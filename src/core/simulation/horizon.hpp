// The bound and the goals of a run, evaluated in one of its states.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "simulation/simulator.hpp"

namespace tachk::simulation {

// The bound of a run: a moment, a number of transitions, or a value of a clock.
struct Bound {
  flow::Ticks until = flow::latest_end;
  std::uint64_t steps = UINT64_MAX;
  std::uint16_t clock = 0;  // that `value` is for; 0: none
  flow::Ticks value = 0;
  flow::Ticks ticks_per_unit = flow::finest_ticks;
};

// The first moment from now on at which a goal is reached if nothing happens; `never` if it is not. `lookahead` becomes
// less if hybrid clocks were followed only up to there.
inline flow::Ticks first_moment(Simulator& simulator, const program::Goal& goal, flow::Ticks& lookahead) {
  flow::Ticks first = flow::never;
  for (const program::Disjunct& disjunct : goal.disjuncts) {
    const flow::Window window = simulator.moments(disjunct.condition);
    lookahead = std::min(lookahead, simulator.lookahead());
    if (!window.empty()) first = std::min(first, window.first);
  }
  return first;
}

// As above, of a goal of the program; `never` for a negative number.
inline flow::Ticks first_moment(Simulator& simulator, const program::Program& program, std::int32_t goal,
                                flow::Ticks& lookahead) {
  return goal < 0 ? flow::never : first_moment(simulator, program.goals[static_cast<std::size_t>(goal)], lookahead);
}

// The next moment at which values of hybrid clocks are noted: the last one before something may happen, or earlier.
inline flow::Ticks next_note(Simulator& simulator, flow::Ticks apart) {
  const flow::Ticks before_next = simulator.next_moment() - 1;
  const flow::Ticks regular = simulator.now() + apart;
  return before_next > simulator.now() ? std::min(before_next, regular) : regular;
}

// True if a run without a bound on time is sampled only up to here because there are no later moments, although
// something may still happen.
inline bool cut_off(Simulator& simulator, const Bound& bound) {
  return bound.until >= flow::latest_end && simulator.now() >= flow::latest_end &&
         simulator.next_moment() < flow::never;
}

// The last moment that is looked at, if nothing happens before.
inline flow::Ticks last_moment(const Simulator& simulator, const Bound& bound) {
  if (bound.clock == 0) return bound.until;
  const flow::Ticks left = bound.value - simulator.clocks().value(bound.clock, simulator.now());
  if (left < 0) return simulator.now() - 1;
  return simulator.clocks().runs(bound.clock) ? std::min(flow::latest_end, simulator.now() + left) : flow::latest_end;
}

}  // namespace tachk::simulation
