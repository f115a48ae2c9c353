// tachk._core: what Python may call. The border is crossed once to build, once for each slice of the
// search (without the interpreter lock), and once to read results.
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <memory>
#include <string>
#include <tuple>

#include "certificates.hpp"
#include "csv.hpp"
#include "group.hpp"
#include "json_lines.hpp"
#include "judge/runs.hpp"
#include "linear.hpp"
#include "offline.hpp"
#include "online.hpp"
#include "reachability/explorer.hpp"
#include "searching/estimation.hpp"
#include "searching/liveness.hpp"
#include "searching/localtime.hpp"
#include "searching/patiently.hpp"
#include "simulated/simulation.hpp"

namespace tachk::bind {

namespace nb = nanobind;
using machine::FaultKind;
using order::SearchOrder;
using reachability::Explorer;
using reachability::Limits;
using reachability::Status;
using symbolic::Extrapolation;
using zones::Width;

namespace {

using FaultTuple = std::tuple<FaultKind, int, std::vector<std::vector<std::uint32_t>>, std::vector<std::uint32_t>>;

using FailureTuple = std::tuple<FaultKind, int, symbolic::Path>;

// The members have the names of those in tachk.engine.options and tachk.model.fault; the numbers are no other module's
// business.
void bind_enumerations(nb::module_& m) {
  nb::enum_<SearchOrder> search_orders(m, "SearchOrder");
  for (std::size_t number = 0; number < order::orders().size(); ++number)
    search_orders.value(order::orders()[number].name, static_cast<SearchOrder>(number));
  nb::enum_<Extrapolation>(m, "Extrapolation")
      .value("NONE", Extrapolation::none)
      .value("MAX", Extrapolation::max)
      .value("LU", Extrapolation::lu);
  nb::enum_<symbolic::BoundScope>(m, "BoundScope")
      .value("LOCAL", symbolic::BoundScope::local)
      .value("GLOBAL", symbolic::BoundScope::global);
  nb::enum_<Width>(m, "Width")  // a number of bits: here the numbers are the names
      .value("NARROW", Width::narrow)
      .value("WIDE", Width::wide)
      .value("WIDEST", Width::widest);
  nb::enum_<Status>(m, "Status")
      .value("RUNNING", Status::running)
      .value("FINISHED", Status::finished)
      .value("STATE_LIMIT", Status::state_limit)
      .value("MEMORY_LIMIT", Status::memory_limit)
      .value("DEPTH_LIMIT", Status::depth_limit)
      .value("TIME_LIMIT", Status::time_limit)
      .value("FAULT", Status::fault)
      .value("CONSTANT_LIMIT", Status::constant_limit);
  nb::enum_<FaultKind>(m, "FaultKind")
      .value("RANGE", FaultKind::range)
      .value("INDEX", FaultKind::index)
      .value("DIVISION", FaultKind::division)
      .value("NEGATIVE_CLOCK", FaultKind::negative_clock)
      .value("SHIFT", FaultKind::shift)
      .value("NEGATIVE_EXPONENT", FaultKind::negative_exponent)
      .value("ASSERT", FaultKind::assertion)
      .value("LOOP", FaultKind::loop)
      .value("NOT_FINITE", FaultKind::not_finite)
      .value("BOUND", FaultKind::bound);
}

void give_back_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

// Each option of tachk.engine.options that is a field here is handed over, by its name.
void bind_options(nb::module_& m) {
  using reachability::Options;
  nb::class_<Options>(m, "Options")
      .def(nb::init<>())
      .def_rw("order", &Options::order)
      .def_rw("seed", &Options::seed)
      .def_rw("extrapolation", &Options::extrapolation)
      .def_rw("bounds", &Options::bounds)
      .def_rw("subsumption", &Options::subsumption)
      .def_rw("width", &Options::width)
      .def_rw("scale", &Options::scale)
      .def_rw("vector", &Options::vector)
      .def_rw("alu", &Options::alu)
      .def_rw("merging", &Options::merging)
      .def_rw("pruning", &Options::pruning)
      .def_rw("reclaim", &Options::reclaim)
      .def_rw("pack_clocks", &Options::pack_clocks)
      .def_rw("partial_order", &Options::partial_order)
      .def_rw("shortest", &Options::shortest)
      .def_rw("proof_after", &Options::proof_after)
      .def_rw("attempts", &Options::depth_first)
      .def_rw("chunk_words", &Options::chunk_words)
      .def_rw("rows_after", &Options::rows_after)
      .def_rw("reduced_after", &Options::reduced_after);
  nb::class_<Limits>(m, "Limits")
      .def(nb::init<>())
      .def_rw("states", &Limits::states)
      .def_rw("memory_bytes", &Limits::memory_bytes)
      .def_rw("depth", &Limits::depth);
  m.def("give_back_memory", &give_back_memory, "Gives unused memory of the allocator back to the system.");
}

std::unique_ptr<Explorer> make_explorer(const std::vector<std::int64_t>& image, const reachability::Options& options,
                                        const Limits& limits) {
  return std::make_unique<Explorer>(program::decode_program(image), options, limits);
}

std::optional<FaultTuple> fault_of(Explorer& explorer) {
  if (!explorer.fault()) return std::nullopt;
  std::vector<std::vector<std::uint32_t>> path;
  const reachability::FaultReport report = explorer.fault_report(path);
  return FaultTuple{report.kind, report.position, std::move(path), report.edges};
}

std::optional<FailureTuple> failure_of(Explorer& explorer, std::size_t goal) {
  const std::optional<reachability::GoalFailure>& failure = explorer.failure(goal);
  if (!failure) return std::nullopt;
  return FailureTuple{failure->fault.kind, failure->fault.position, explorer.path_to_goal(goal)};
}

void bind_explorer(nb::module_& m) {
  nb::class_<Explorer>(m, "Explorer")
      .def(nb::new_(&make_explorer), nb::arg("image"), nb::arg("options"), nb::arg("limits"))
      .def("begin_after", &Explorer::begin_after, nb::arg("actions"),
           "Lets the search, and all its paths, begin where these actions lead to; False if they lead nowhere.")
      .def("run", &run_patiently<Explorer>, nb::arg("expansions"), nb::arg("seconds") = nb::none(),
           nb::arg("poll") = nb::none(),
           "Explores up to this many states; TIME_LIMIT if it was given up in the midst of one.")
      .def(
          "statistics",
          [](const Explorer& self) {
            const reachability::Statistics s = self.statistics();
            return std::make_tuple(s.explored, s.stored, s.transitions, s.bytes);
          },
          "(explored, stored, transitions, bytes)")
      .def("effort", &Explorer::effort, "The work so far, in states of a small network that would take as long.")
      .def("discrete_states", &Explorer::discrete_states, "How many discrete states have been seen.")
      .def("lost", &Explorer::lost, "How many successors were dropped because no goal can be reached from them.")
      .def("reduced_states", &Explorer::reduced_states, "How many states were expanded with some actions only.")
      .def("has_merged", &Explorer::has_merged, "True if zones have been merged.")
      .def("reached", &Explorer::reached, nb::arg("goal"), "The node where a goal was reached first, or None.")
      .def("taken", &Explorer::taken, "The numbers of the edges that some action so far has taken, ascending.")
      .def(
          "extreme",
          [](const Explorer& self, std::size_t measure) {
            const auto found = self.extreme(measure);
            using Found = std::tuple<std::optional<std::int64_t>, bool, std::uint32_t>;
            if (!found) return std::optional<Found>();
            const bool limited = found->value != zones::unbounded_entry;
            return std::optional(
                Found{limited ? std::optional(found->value) : std::nullopt, found->strict, found->node});
          },
          nb::arg("measure"), "(value or None for no limit, strict, node) of the extreme value; None if there is none.")
      .def("path", &Explorer::path, nb::arg("node"), "The edge numbers of each action on the way to a node.")
      .def("path_to_goal", &Explorer::path_to_goal, nb::arg("goal"),
           "The edge numbers of each action on the way to where a goal was reached, or failed.")
      .def("path_to_edge", &Explorer::path_to_edge, nb::arg("edge"),
           "The edge numbers of each action on the way to where an edge was taken, with the action that takes it.")
      .def("any_failure", &Explorer::any_failure, "True if a predicate of some goal was a run-time error.")
      .def("failure", &failure_of, nb::arg("goal"),
           "(kind, code position, path) of a run-time error in a predicate of a goal, or None.")
      .def("leads_to", &Explorer::leads_to, nb::arg("actions"), nb::arg("goal"),
           "True if these actions, as edge numbers, can end in a goal; for a fresh explorer without extrapolation.")
      .def("fault", &fault_of, "(kind, code position, path, edges of the action) of a run-time error, or None.")
      .def(
          "kernel", [](const Explorer& self) { return std::string(self.operations().name); },
          "Which implementation of the zone operations is in use.");
}

}  // namespace

NB_MODULE(_core, m) {
  m.doc() = "The C++ core: the exploration engine, the monitors and the reader of tables.";
  bind_enumerations(m);
  bind_options(m);
  bind_explorer(m);
  bind_certificates(m);
  bind_estimation(m);
  bind_liveness(m);
  bind_localtime(m);
  bind_csv(m);
  bind_json_lines(m);
  bind_offline(m);
  bind_linear(m);
  bind_online(m);
  bind_group(m);
  bind_runs(m);
  bind_simulation(m);
  bind_monitored(m);
  bind_trials(m);
  bind_splitting(m);
  bind_unit_run(m);
}

}  // namespace tachk::bind
