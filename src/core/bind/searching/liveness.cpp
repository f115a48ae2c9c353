#include "liveness.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <optional>
#include <tuple>
#include <vector>

#include "liveness/liveness_search.hpp"
#include "liveness/recurrence_search.hpp"
#include "patiently.hpp"

namespace tachk::bind {

namespace nb = nanobind;
using liveness::LivenessSearch;
using liveness::RecurrenceSearch;
using liveness::ViolationKind;

namespace {

using FaultTuple = std::tuple<machine::FaultKind, int, symbolic::Path, symbolic::Edges>;
using ViolationTuple = std::tuple<ViolationKind, symbolic::Path, std::size_t, symbolic::Path>;

std::unique_ptr<LivenessSearch> make_search(const std::vector<std::int64_t>& image,
                                            const reachability::Options& options, const reachability::Limits& limits) {
  return std::make_unique<LivenessSearch>(program::decode_program(image), options, limits);
}

std::unique_ptr<RecurrenceSearch> make_recurrence_search(const std::vector<std::int64_t>& image, bool begins,
                                                         const reachability::Options& options,
                                                         const reachability::Limits& limits) {
  return std::make_unique<RecurrenceSearch>(program::decode_program(image), begins, options, limits);
}

template <class Search>
std::optional<FaultTuple> fault_of(const Search& search) {
  const auto& fault = search.fault();
  if (!fault) return std::nullopt;
  return FaultTuple{fault->kind, fault->position, fault->path, fault->edges};
}

template <class Search>
std::optional<ViolationTuple> violation_of(const Search& search) {
  const auto& found = search.violation();
  if (!found) return std::nullopt;
  return ViolationTuple{found->kind, found->stem, found->begins, found->loop};
}

template <class Search>
std::tuple<std::uint64_t, std::uint64_t, std::uint64_t, std::uint64_t> statistics_of(const Search& search) {
  const reachability::Statistics s = search.statistics();
  return {s.explored, s.stored, s.transitions, s.bytes};
}

}  // namespace

void bind_liveness(nb::module_& m) {
  nb::enum_<ViolationKind>(m, "ViolationKind")
      .value("LOOP", ViolationKind::loop)
      .value("IDLE", ViolationKind::idle)
      .value("STUCK", ViolationKind::stuck);
  nb::class_<LivenessSearch>(m, "LivenessSearch")
      .def(nb::new_(&make_search), nb::arg("image"), nb::arg("options"), nb::arg("limits"))
      .def("run", &run_patiently<LivenessSearch>, nb::arg("expansions"), nb::arg("seconds") = nb::none(),
           nb::arg("poll") = nb::none(),
           "Takes up to this many steps of the search; TIME_LIMIT if it was given up in the midst of one.")
      .def("statistics", &statistics_of<LivenessSearch>, "(explored, stored, transitions, bytes)")
      .def("cover", &LivenessSearch::cover, nb::rv_policy::reference_internal,
           "Of a finished search without a violation: the states that have been gone through, in their order.")
      .def("violation", &violation_of<LivenessSearch>,
           "(kind, stem, begins, loop) of a run that was found, as edge numbers, or None.")
      .def("begins", &LivenessSearch::begins, "True if the left side of p --> q holds in some state so far.")
      .def("gets_stuck", &LivenessSearch::gets_stuck, nb::arg("actions"), nb::arg("begins"),
           "True if these actions, as edge numbers, can end where nothing is possible; for a fresh search without "
           "extrapolation.")
      .def("fault", &fault_of<LivenessSearch>,
           "(kind, code position, path, edges of the action) of a run-time error, or None.");
  nb::class_<RecurrenceSearch>(m, "RecurrenceSearch")
      .def(nb::new_(&make_recurrence_search), nb::arg("image"), nb::arg("begins"), nb::arg("options"),
           nb::arg("limits"))
      .def("run", &run_patiently<RecurrenceSearch>, nb::arg("expansions"), nb::arg("seconds") = nb::none(),
           nb::arg("poll") = nb::none(),
           "Takes up to this many steps of the search; TIME_LIMIT if it was given up in the midst of one.")
      .def("statistics", &statistics_of<RecurrenceSearch>, "(explored, stored, transitions, bytes)")
      .def("violation", &violation_of<RecurrenceSearch>,
           "(kind, stem, begins, loop) of a run that was found, as edge numbers, or None.")
      .def("begins", &RecurrenceSearch::begins, "True if runs can begin in some state so far.")
      .def("fault", &fault_of<RecurrenceSearch>,
           "(kind, code position, path, edges of the action) of a run-time error, or None.");
}

}  // namespace tachk::bind
