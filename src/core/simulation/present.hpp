// Where a run is: the values of its variables and clocks, and what conditions say about them, now and later.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
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
enum class Policy : std::int32_t { stochastic, uniform, earliest, latest, boundary };

inline constexpr flow::Ticks first_lookahead = 1;  // in units of time: how far hybrid clocks are followed first

struct Values {
  std::vector<std::int32_t> slots;  // frame slots included
  flow::ClockValues clocks;
  std::uint32_t committed = 0;  // processes in committed locations
  std::uint32_t urgent = 0;     // in urgent ones
};

struct Present {
  // The arguments must outlive it.
  Present(const program::Program& program, const flow::Chances& chances, const Tables& tables, Policy policy,
          flow::Ticks ticks_per_unit);

  // The values before the first run-time error can be, at the time 0.
  void start(const Random& source);
  // The numbers of a copy come from the copy.
  void draw_from_own() { machine.draw_from(&random); }
  void move_to(flow::Ticks moment) {
    now = moment;
    if (flow.exists()) flow.show(now, machine, values.slots.data());
  }
  // Counts and remembers anew what the locations say.
  void update_all_dependencies();
  void update_dependencies(std::size_t process) { dependencies[process] = place(process).dependencies; }

  flow::Ticks unit() const { return flow.ticks_per_unit(); }
  const LocationTables& place(std::size_t process) const { return tables.place(process, values.slots.data()); }
  std::size_t processes() const { return program.processes.size(); }
  bool random_delays() const { return policy == Policy::stochastic || policy == Policy::uniform; }

  bool may_hold(const FirstTest& first_test) const { return first_test.may_hold(values.slots.data()); }
  bool integers_hold(const program::Condition& condition);
  bool holds(const program::Condition& condition) {
    return integers_hold(condition) && clock_window(condition).holds(now) &&
           (condition.flow.empty() || crossings().hold(condition.flow));
  }
  // The moments at which the conditions on clocks that are not hybrid hold, or, with the closure 1, up to which they
  // do.
  flow::Window clock_window(const program::Condition& condition, zones::Raw closure = 0);
  // The first interval, from a moment on, in which all conditions on clocks hold. Its end is looked for where it
  // counts.
  flow::Window window(const program::Condition& condition, flow::Ticks from);
  // The last moment at which an invariant holds that holds now.
  flow::Ticks end_of(const program::Condition& invariant, flow::Ticks lookahead);
  flow::Crossings crossings() { return {flow, machine, values.slots.data()}; }

  bool open(std::uint32_t edge) { return holds(program.edges[edge].guard); }
  std::int32_t channel_of(const program::Edge& edge);
  const program::Channel& channel(std::int32_t number) const {
    return program.channels[static_cast<std::size_t>(number)];
  }
  // The processes that may receive over a channel.
  const std::vector<std::uint32_t>& receivers_of(std::int32_t channel) const {
    return tables.receivers_of[static_cast<std::size_t>(channel)];
  }
  bool receives(const ReceivingEdge& receiving, std::int32_t channel);
  bool has_receiver(std::size_t sender, std::int32_t channel, bool committed_only);
  void open_receives(std::size_t process, std::int32_t channel, std::vector<std::uint32_t>& found);
  // True if a process may begin an action: where some are in committed locations, only these.
  bool admits(std::size_t process) const { return values.committed == 0 || place(process).location->committed; }
  // True if an edge whose guard holds can be taken, but for target invariants.
  bool is_enabled(std::size_t process, std::uint32_t edge);
  // True if a single edge may be tried without asking who receives.
  bool is_enabled_alone(std::size_t process, std::uint32_t edge);
  // True if an urgent synchronisation of the process stops time.
  bool sends_urgently(std::size_t process);

  const program::Program& program;
  const flow::Chances& chances;
  const Tables& tables;
  const Policy policy;
  machine::Machine machine;
  Random random;
  Values values;
  flow::Flow flow;
  flow::Ticks now = 0;
  flow::Ticks lookahead = flow::never;     // how far the last condition was looked at
  std::vector<Dependencies> dependencies;  // of the locations in which the processes are
};

}  // namespace tachk::simulation
