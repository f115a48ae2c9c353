// tachk._core.trials; used through tachk.engine.simulation.trials.
#include "simulation/trials.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cstdint>
#include <tuple>
#include <vector>

#include "../arrays.hpp"
#include "interruption.hpp"
#include "simulation.hpp"

namespace tachk::bind {

namespace nb = nanobind;
using simulation::RunQuestion;
using simulation::Trial;

namespace {

struct Trials {
  std::vector<Trial> trials;

  template <class T, class Field>
  nb::object column(Field field) const {
    return column_of<T>(trials, field);
  }
};

Trials run_trials(const simulation::Simulation& simulation, const RunQuestion& question,
                  simulation::TrialRequest request, const nb::callable& check) {
  Trials result;
  interruptibly(request, check, [&] { result.trials = simulation::trials(simulation, question, request); });
  return result;
}

}  // namespace

namespace {

void bind_question(nb::module_& m) {
  nb::class_<RunQuestion>(m, "RunQuestion", "A question about runs, with the numbers that the program has for it.")
      .def(nb::init<>())
      .def_prop_rw(
          "until", [](const RunQuestion& self) { return self.bound.until; },
          [](RunQuestion& self, flow::Ticks until) { self.bound.until = until; })
      .def_prop_rw(
          "steps", [](const RunQuestion& self) { return self.bound.steps; },
          [](RunQuestion& self, std::uint64_t steps) { self.bound.steps = steps; })
      .def_prop_rw(
          "bound_clock", [](const RunQuestion& self) { return self.bound.clock; },
          [](RunQuestion& self, std::uint16_t clock) { self.bound.clock = clock; })
      .def_prop_rw(
          "bound_value", [](const RunQuestion& self) { return self.bound.value; },
          [](RunQuestion& self, flow::Ticks value) { self.bound.value = value; })
      .def_prop_rw(
          "ticks_per_unit", [](const RunQuestion& self) { return self.bound.ticks_per_unit; },
          [](RunQuestion& self, flow::Ticks ticks) { self.bound.ticks_per_unit = ticks; })
      .def_rw("goal", &RunQuestion::goal)
      .def_rw("lost", &RunQuestion::lost)
      .def_rw("observed", &RunQuestion::observed)
      .def_rw("clock", &RunQuestion::clock)
      .def_rw("largest", &RunQuestion::largest);
}

}  // namespace

void bind_trials(nb::module_& m) {
  bind_question(m);
  nb::class_<Trials>(m, "Trials", "The results of runs: an array of each property, in the order of the runs.")
      .def(
          "answers",
          [](const Trials& self) { return self.column<std::int8_t>([](const Trial& trial) { return trial.answer; }); },
          "1 where the goal is reached, 0 where it is not, 2 where that is not known.")
      .def(
          "endings",
          [](const Trials& self) { return self.column<std::int8_t>([](const Trial& trial) { return trial.ending; }); },
          "The number of the `Ending`.")
      .def(
          "ends",
          [](const Trials& self) { return self.column<std::int64_t>([](const Trial& trial) { return trial.end; }); },
          "The moment at which the goal is reached, or up to which the run was looked at, in ticks.")
      .def(
          "transitions",
          [](const Trials& self) {
            return self.column<std::int64_t>([](const Trial& trial) { return trial.transitions; });
          },
          "How many the run has.")
      .def(
          "measured",
          [](const Trials& self) { return self.column<double>([](const Trial& trial) { return trial.measured; }); },
          "The extreme value of what is measured.")
      .def(
          "trial",
          [](const Trials& self, std::size_t number) {
            const Trial& trial = self.trials.at(number);
            return std::make_tuple(trial.answer == simulation::Answered::yes, trial.transitions, trial.instructions);
          },
          nb::arg("number"),
          "(whether the goal is reached, how many transitions it has, how many instructions of code it took as far as "
          "jumps count them), of one run.")
      .def(
          "fault",
          [](const Trials& self, std::size_t number) {
            const Trial& trial = self.trials.at(number);
            return std::make_tuple(trial.fault, trial.position);
          },
          nb::arg("number"), "(kind, code position) of the run-time error of a run with the ending FAULT.");
  m.def(
      "trials",
      [](const simulation::Simulation& simulation, const RunQuestion& question, simulation::Policy policy,
         std::uint64_t seed, std::uint64_t first, std::uint64_t runs, unsigned threads, std::uint64_t most_steps,
         const nb::callable& check) {
        return run_trials(simulation, question, {seed, first, runs, threads, policy, most_steps, {}}, check);
      },
      nb::arg("simulation"), nb::arg("question"), nb::kw_only(), nb::arg("policy"), nb::arg("seed"), nb::arg("first"),
      nb::arg("runs"), nb::arg("threads"), nb::arg("most_steps"), nb::arg("check"),
      "The runs of these numbers, in order. Raises what `check` raises.");
}

}  // namespace tachk::bind
