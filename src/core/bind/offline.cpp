// tachk._core.OfflineTruth and OfflineRobustness; used through tachk.recordings.traces.core_monitor.
#include "offline.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <cstddef>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "monitor_program.hpp"
#include "monitor_results.hpp"
#include "monitoring/offline/offline_monitor.hpp"

namespace tachk::bind {

namespace nb = nanobind;

namespace {

template <class Value>
std::unique_ptr<monitoring::offline::OfflineMonitor<Value>> make_monitor(nb::handle program, bool verdict,
                                                                         const std::vector<std::size_t>& signals) {
  monitoring::MonitorProgram read = monitor_program_from(program);
  monitoring::offline::Requests requests;
  requests.verdict = verdict;
  requests.signals = signals;
  for (const std::size_t node : signals)
    if (node >= read.nodes.size()) throw std::invalid_argument("there is no such node");
  return std::make_unique<monitoring::offline::OfflineMonitor<Value>>(std::move(read), std::move(requests));
}

template <class Value>
void bind_values_of(nb::module_& m, const char* name, const char* description) {
  using Monitor = monitoring::offline::OfflineMonitor<Value>;
  nb::class_<Monitor>(m, name, description)
      .def(nb::new_(&make_monitor<Value>), nb::arg("program"), nb::kw_only(), nb::arg("verdict"), nb::arg("signals"))
      .def("push", &push_samples<Monitor>, nb::arg("times"), nb::arg("columns"),
           "Takes samples: ticks that do not decrease, and the columns.")
      .def(
          "push_counted", &push_counted<Monitor>, nb::arg("times"), nb::arg("before"), nb::arg("decimals"),
          nb::arg("first"), nb::arg("factor"), nb::arg("columns"), nb::arg("finite"), nb::arg("all"),
          "Takes samples at floating-point times; whether these are whole in so many decimals and do not decrease, and "
          "the last columns are finite.")
      .def("finish", &Monitor::finish, nb::arg("end"), nb::call_guard<nb::gil_scoped_release>(),
           "The trace ends at this tick.")
      .def("lasting", &Monitor::lasting, "The value at the beginning if all values stay for ever.")
      .def("settled", &Monitor::settled, "True if further samples cannot change the results.")
      .def("bytes", &Monitor::bytes, "Memory held.")
      .def(
          "verdict",
          [](const Monitor& self) {
            const auto range = self.verdict();
            return std::make_pair(range.low, range.high);
          },
          "The bounds of the value at the beginning.")
      .def(
          "violation", [](const Monitor& self) { return violation_tuple(self.violation()); },
          "(node, first cell, last cell) of the earliest certain violation, or None.")
      .def(
          "signal", [](const Monitor& self, std::size_t number) { return signal_tuple(self.signal(number)); },
          nb::arg("number"), "(first cells of the pieces, lower bounds, upper bounds) up to the end of the trace.");
}

}  // namespace

void bind_offline(nb::module_& m) {
  bind_values_of<monitoring::offline::Truth>(m, "OfflineTruth", "Is a formula true on a trace?");
  bind_values_of<monitoring::offline::Robustness>(m, "OfflineRobustness", "How robustly is a formula true on a trace?");
}

}  // namespace tachk::bind
