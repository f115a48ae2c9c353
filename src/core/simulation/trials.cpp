#include "simulation/trials.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <stdexcept>

#include "simulation/thread_pool.hpp"

namespace tachk::simulation {

using flow::Ticks;

namespace {

class Watch {
 public:
  Watch(const Simulation& simulation, const RunQuestion& question, const TrialRequest& request)
      : simulation_(simulation),
        question_(question),
        request_(request),
        simulator_(simulation.program(), simulation.chances(), simulation.tables(), request.policy,
                   question.bound.ticks_per_unit) {}

  void run(std::uint64_t number, Trial& trial) {
    const std::uint64_t before = simulator_.machine().instructions();
    take(number, trial);
    trial.instructions = simulator_.machine().instructions() - before;
  }

 private:
  void take(std::uint64_t number, Trial& trial) {
    try {
      if (!simulator_.begin(request_.seed, number)) {
        trial.answer = Answered::unknown;
        trial.ending = Ending::initial;
        return;
      }
      if (question_.measures()) trial.measured = measured();
      go_on(trial);
    } catch (const machine::ModelFault& fault) {
      trial.answer = Answered::unknown;
      trial.ending = Ending::fault;
      trial.fault = fault.kind;
      trial.position = fault.position;
      trial.end = simulator_.now();
    }
  }

  // One state after another, with the time that passes in it.
  void go_on(Trial& trial) {
    std::uint64_t at_once = 0;
    while (true) {
      if (++polls_ % between_polls == 0 && request_.poll) request_.poll(0);
      const Ticks before = simulator_.now();
      const Ticks last = last_moment(simulator_, question_.bound);
      const bool notes = question_.measures() && simulator_.has_hybrid_clocks();
      Ticks lookahead = notes ? next_note(simulator_, flow::flow_sample(question_.bound.ticks_per_unit)) : flow::never;
      const Ticks reached = first_moment(simulator_, simulation_.program(), question_.goal, lookahead);
      const Ticks lost = first_moment(simulator_, simulation_.program(), question_.lost, lookahead);
      RunLimits limits;
      limits.until = std::min(last, lookahead);
      if (std::min(reached, lost) <= before || last < before) return decide(trial, reached, lost, last);
      const ClockAtStart clock = clock_at_start();
      const std::optional<Ending> ending = simulator_.step(limits);
      const Ticks now = std::min(simulator_.now(), last);
      if (question_.clock > 0) extend(trial, clock, std::min({now, reached, lost}) - before);
      if (std::min(reached, lost) <= now) return decide(trial, reached, lost, last);
      if (ending == Ending::horizon && notes) keep(trial, measured());
      if (ending == Ending::horizon && now < last) continue;  // it was not looked farther ahead
      if (ending == Ending::horizon && cut_off(simulator_, question_.bound))
        return stop(trial, Ending::end_of_time, now);
      if (ending) return stop(trial, *ending, now);
      if (++trial.transitions > question_.bound.steps) return stop(trial, Ending::horizon, now);
      if (question_.measures()) keep(trial, measured());
      at_once = now == before ? at_once + 1 : 0;
      if (at_once >= most_steps_at_once) return stop(trial, Ending::zeno, now);
      if (trial.transitions >= request_.most_steps) return stop(trial, Ending::steps, now);
    }
  }

  static void decide(Trial& trial, Ticks reached, Ticks lost, Ticks last) {
    const Ticks first = std::min(reached, lost);
    if (first > last) return stop(trial, Ending::horizon, last);
    trial.answer = reached <= lost ? Answered::yes : Answered::no;
    trial.end = first;
  }

  static void stop(Trial& trial, Ending ending, Ticks now) {
    trial.ending = ending;
    trial.end = now;
    if (ending == Ending::zeno || ending == Ending::steps || ending == Ending::end_of_time)
      trial.answer = Answered::unknown;
  }

  double measured() {
    if (question_.clock > 0) return in_units(simulator_.clocks().value(question_.clock, simulator_.now()));
    return simulation_.chances().observed[static_cast<std::size_t>(question_.observed)].value(simulator_.machine(),
                                                                                              simulator_.slots());
  }

  struct ClockAtStart {
    Ticks value;
    bool runs;
  };
  ClockAtStart clock_at_start() const {
    if (question_.clock == 0) return {0, false};
    return {simulator_.clocks().value(question_.clock, simulator_.now()), simulator_.clocks().runs(question_.clock)};
  }
  void extend(Trial& trial, const ClockAtStart& clock, Ticks delay) const {
    if (clock.runs) keep(trial, in_units(clock.value + std::max<Ticks>(delay, 0)));
  }
  void keep(Trial& trial, double value) const {
    trial.measured = question_.largest ? std::max(trial.measured, value) : std::min(trial.measured, value);
  }
  double in_units(Ticks ticks) const {
    return static_cast<double>(ticks) / static_cast<double>(question_.bound.ticks_per_unit);
  }

  const Simulation& simulation_;
  const RunQuestion& question_;
  const TrialRequest& request_;
  Simulator simulator_;
  std::uint64_t polls_ = 0;
};

}  // namespace

void check(const Simulation& simulation, const RunQuestion& question) {
  const auto goals = static_cast<std::int64_t>(simulation.program().goals.size());
  const auto numbers = static_cast<std::int64_t>(simulation.chances().observed.size());
  const int clocks = simulation.program().clocks;
  if (question.goal >= goals || question.lost >= goals || question.observed >= numbers || question.clock > clocks ||
      question.bound.clock > clocks)
    throw std::invalid_argument("the program has no such goal, number or clock");
}

std::vector<Trial> trials(const Simulation& simulation, const RunQuestion& question, const TrialRequest& request) {
  check(simulation, question);
  std::vector<Trial> result(request.runs);
  share_work(request.threads, request.runs, request.poll, [&] {
    return [&, watch = Watch(simulation, question, request)](std::uint64_t n) mutable {
      watch.run(request.first + n, result[n]);
    };
  });
  return result;
}

}  // namespace tachk::simulation
