// tachk._core.Simulation; used through tachk.engine.simulation.simulator.
#include "simulation.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <cstdint>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "interruption.hpp"
#include "program/program.hpp"
#include "simulation/runs.hpp"

namespace tachk::bind {

namespace nb = nanobind;
using simulation::Ending;
using simulation::Policy;
using simulation::RunRecord;
using simulation::Simulation;

namespace {

// The vector itself, for as long as the record is referenced.
template <auto Field>
nb::object shown(nb::handle record) {
  auto& values = nb::cast<RunRecord&>(record).*Field;
  using Value = typename std::remove_reference_t<decltype(values)>::value_type;
  return nb::ndarray<nb::numpy, const Value, nb::ndim<1>>(values.data(), {values.size()}, record).cast();
}

// The runs. Ctrl-C becomes its exception, and what `check` raises is raised.
std::vector<RunRecord> run_interruptibly(const Simulation& simulation, simulation::RunRequest request,
                                         const nb::callable& check) {
  std::vector<RunRecord> records;
  interruptibly(request, check, [&] { records = simulation.run(request); });
  return records;
}

std::vector<std::vector<std::uint32_t>> path_of(const RunRecord& record) {
  std::vector<std::vector<std::uint32_t>> path;
  auto next = record.edges.begin();
  for (std::size_t number = 1; number < record.sizes.size(); ++number) {
    if (record.sizes[number] == 0) continue;  // only time passes
    path.emplace_back(next, next + record.sizes[number]);
    next += record.sizes[number];
  }
  return path;
}

void bind_run_record(nb::module_& m) {
  nb::class_<RunRecord>(m, "RunRecord", "A run that has been simulated; times are in ticks.")
      .def_ro("ending", &RunRecord::ending)
      .def_ro("end", &RunRecord::end)
      .def_ro("lasts", &RunRecord::lasts, "True if time can pass in the last state.")
      .def_ro("transitions", &RunRecord::transitions)
      .def_prop_ro(
          "fault", [](const RunRecord& self) { return std::make_tuple(self.fault, self.position); },
          "(kind, code position) of the run-time error of a run with the ending FAULT.")
      .def("times", shown<&RunRecord::times>, "Of the initial state and of each transition.")
      .def("sizes", shown<&RunRecord::sizes>, "How many edges each action has; the initial one none.")
      .def("path", &path_of, "The numbers of the edges of each transition.")
      .def("edges", shown<&RunRecord::edges>, "The numbers of these edges, one action after the other.")
      .def("observed", shown<&RunRecord::observed>,
           "The observed values, row by row; floating point numbers as their bits.")
      .def("clocks", shown<&RunRecord::clocks>, "The values of the clocks, row by row.");
}

}  // namespace

void bind_simulation(nb::module_& m) {
  nb::enum_<Policy>(m, "Policy")
      .value("STOCHASTIC", Policy::stochastic)
      .value("UNIFORM", Policy::uniform)
      .value("EARLIEST", Policy::earliest)
      .value("LATEST", Policy::latest)
      .value("BOUNDARY", Policy::boundary);
  nb::enum_<Ending>(m, "Ending")
      .value("HORIZON", Ending::horizon)
      .value("DEADLOCK", Ending::deadlock)
      .value("TIME_LOCK", Ending::time_lock)
      .value("ZENO", Ending::zeno)
      .value("STEPS", Ending::steps)
      .value("FAULT", Ending::fault)
      .value("INITIAL", Ending::initial)
      .value("END_OF_TIME", Ending::end_of_time);
  m.def("finest_ticks", [] { return flow::finest_ticks; }, "How many ticks are a unit of time where a run is short.");
  m.def("coarsest_ticks", [] { return flow::coarsest_ticks; }, "How many they are at least.");
  m.def("latest_end", [] { return flow::latest_end; }, "The longest run, in ticks.");
  bind_run_record(m);
  nb::class_<Simulation>(m, "Simulation", "Runs of a program with their probabilities.")
      .def(nb::new_([](const std::vector<std::int64_t>& image, const std::vector<std::int64_t>& chances) {
             return std::make_unique<Simulation>(program::decode_program(image), chances);
           }),
           nb::arg("image"), nb::arg("chances"))
      .def(
          "run",
          [](const Simulation& self, Policy policy, std::uint64_t seed, std::uint64_t first, std::uint64_t runs,
             flow::Ticks until, flow::Ticks ticks_per_unit, std::uint64_t steps, unsigned threads, bool actions,
             bool observed, bool clocks, const nb::callable& check) {
            simulation::RunLimits limits;
            limits.until = until;
            limits.steps = steps;
            return run_interruptibly(
                self, {seed, first, runs, threads, policy, limits, ticks_per_unit, {actions, observed, clocks}}, check);
          },
          nb::kw_only(), nb::arg("policy"), nb::arg("seed"), nb::arg("first"), nb::arg("runs"), nb::arg("until"),
          nb::arg("ticks_per_unit"), nb::arg("steps"), nb::arg("threads"), nb::arg("actions"), nb::arg("observed"),
          nb::arg("clocks"), nb::arg("check"), "The runs of these numbers, in order. Raises what `check` raises.");
}

}  // namespace tachk::bind
