// tachk._core.monitored_runs; used through tachk.engine.simulation.simulator.
#include "../arrays.hpp"
#include "../monitor_program.hpp"
#include "interruption.hpp"
#include "monitored/monitored_runs.hpp"
#include "simulation.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

namespace tachk::bind {

namespace nb = nanobind;
using monitored::MonitoredFormula;
using monitored::MonitoredRun;
using monitored::RecordedRows;

namespace {

struct MonitoredRuns {
  std::vector<MonitoredRun> runs;

  template <class T, class Field>
  nb::object column(Field field) const {
    return column_of<T>(runs, [&](const MonitoredRun& run) { return field(run.record); });
  }

  nb::object truths(std::size_t formula) const {
    return column_of<std::int8_t>(runs, [&](const MonitoredRun& run) { return run.truths.at(formula); });
  }
};

using ColumnTuple = std::tuple<std::size_t, bool, std::vector<double>>;

MonitoredFormula read_formula(nb::handle program, const std::vector<ColumnTuple>& columns, std::int64_t factor) {
  MonitoredFormula result{monitor_program_from(program), {}, factor};
  for (const auto& [number, floating, values] : columns) result.columns.push_back({number, floating, values});
  return result;
}

}  // namespace

void bind_monitored(nb::module_& m) {
  nb::enum_<RecordedRows>(m, "RecordedRows", "The runs of which all rows stay.")
      .value("NONE", RecordedRows::none)
      .value("VIOLATING", RecordedRows::violating)
      .value("ALL", RecordedRows::all);
  nb::class_<MonitoredFormula>(m, "MonitoredFormula", "A formula with the observed values that it reads.")
      .def(nb::new_(&read_formula), nb::arg("program"), nb::arg("columns"), nb::arg("factor"));
  nb::class_<MonitoredRuns>(m, "MonitoredRuns", "Runs on which formulas are evaluated: arrays in their order.")
      .def("truths", &MonitoredRuns::truths, nb::arg("formula"), "0 is false, 1 is true, 2 undetermined.")
      .def(
          "endings",
          [](const MonitoredRuns& self) {
            return self.column<std::int8_t>([](const simulation::RunRecord& run) { return run.ending; });
          },
          "The number of the `Ending`.")
      .def(
          "ends",
          [](const MonitoredRuns& self) {
            return self.column<std::int64_t>([](const simulation::RunRecord& run) { return run.end; });
          },
          "In ticks.")
      .def(
          "transitions",
          [](const MonitoredRuns& self) {
            return self.column<std::int64_t>([](const simulation::RunRecord& run) { return run.transitions; });
          },
          "How many the run has.")
      .def(
          "record", [](MonitoredRuns& self, std::size_t number) { return &self.runs.at(number).record; },
          nb::arg("number"), nb::rv_policy::reference_internal, "What is left of one run.");
  m.def(
      "monitored_runs",
      [](const simulation::Simulation& simulation, const std::vector<const MonitoredFormula*>& formulas,
         RecordedRows rows, bool until_decided, simulation::Policy policy, std::uint64_t seed, std::uint64_t first,
         std::uint64_t runs, flow::Ticks until, flow::Ticks ticks_per_unit, std::uint64_t steps, unsigned threads,
         bool actions, const nb::callable& check) {
        std::vector<MonitoredFormula> read;
        for (const MonitoredFormula* const formula : formulas) read.push_back(*formula);
        simulation::RunLimits limits;
        limits.until = until;
        limits.steps = steps;
        simulation::RunRequest request{
            seed, first, runs, threads, policy, limits, ticks_per_unit, {actions, true, false}, {}};
        MonitoredRuns result;
        interruptibly(request, check,
                      [&] { result.runs = monitored_runs(simulation, read, request, rows, until_decided); });
        return result;
      },
      nb::arg("simulation"), nb::arg("formulas"), nb::kw_only(), nb::arg("rows"), nb::arg("until_decided"),
      nb::arg("policy"), nb::arg("seed"), nb::arg("first"), nb::arg("runs"), nb::arg("until"),
      nb::arg("ticks_per_unit"), nb::arg("steps"), nb::arg("threads"), nb::arg("actions"), nb::arg("check"),
      "The runs of these numbers, in order. Raises what `check` raises.");
}

}  // namespace tachk::bind
