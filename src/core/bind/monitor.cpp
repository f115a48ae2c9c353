// The offline monitors of truth and robustness. Samples are read where NumPy has them, without the interpreter lock.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include "monitor.hpp"
#include "monitor_program.hpp"
#include "tachk/linear_monitor.hpp"
#include "tachk/offline_monitor.hpp"

namespace nb = nanobind;

namespace {

using ProbeList = std::vector<std::pair<std::size_t, tachk::Cell>>;

template <class T>
nb::object as_array(std::vector<T>&& values) {
  auto held = std::make_unique<std::vector<T>>(std::move(values));
  T* const data = held->data();
  const std::size_t size = held->size();
  nb::capsule owner(held.release(), [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return nb::ndarray<nb::numpy, T, nb::ndim<1>>(data, {size}, owner).cast();
}

template <class Value>
std::unique_ptr<tachk::OfflineMonitor<Value>> make_monitor(nb::handle program, bool verdict, const ProbeList& probes,
                                                           const std::vector<std::size_t>& signals) {
  tachk::MonitorProgram read = monitor_program_from(program);
  tachk::Requests requests;
  requests.verdict = verdict;
  requests.signals = signals;
  for (const auto& [node, cell] : probes) requests.probes.push_back({node, cell});
  for (const std::size_t node : signals)
    if (node >= read.nodes.size()) throw std::invalid_argument("there is no such node");
  for (const tachk::Probe& probe : requests.probes)
    if (probe.node >= read.nodes.size() || probe.cell < 0) throw std::invalid_argument("there is no such node or cell");
  return std::make_unique<tachk::OfflineMonitor<Value>>(std::move(read), std::move(requests));
}

using ViolationTuple = std::tuple<std::size_t, tachk::Cell, tachk::Cell>;

std::optional<ViolationTuple> violation_tuple(const std::optional<tachk::FirstViolation>& found) {
  if (!found) return std::nullopt;
  return ViolationTuple{found->node, found->first, found->last};
}

template <class Value>
void bind_offline(nb::module_& m, const char* name, const char* description) {
  using Monitor = tachk::OfflineMonitor<Value>;
  nb::class_<Monitor>(m, name, description)
      .def(nb::new_(&make_monitor<Value>), nb::arg("program"), nb::kw_only(), nb::arg("verdict"), nb::arg("probes"),
           nb::arg("signals"))
      .def(
          "push",
          [](Monitor& self, const TickArray& times, const nb::sequence& columns) {
            const SampleView view(times, columns);
            if (nb::len(columns) != self.columns()) throw std::invalid_argument("a column is missing or too many");
            nb::gil_scoped_release released;
            self.push(view.samples());
          },
          nb::arg("times"), nb::arg("columns"), "Takes samples: ticks that do not decrease, and the columns.")
      .def("finish", &Monitor::finish, nb::arg("end"), nb::call_guard<nb::gil_scoped_release>(),
           "The trace ends at this tick.")
      .def("settled", &Monitor::settled, "Whether further samples cannot change the results.")
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
          "probe",
          [](const Monitor& self, std::size_t number) {
            const auto range = self.probe(number);
            return std::make_pair(range.low, range.high);
          },
          nb::arg("number"), "The bounds of the value that a probe asked for.")
      .def(
          "signal",
          [](const Monitor& self, std::size_t number) {
            auto signal = self.signal(number);
            return nb::make_tuple(as_array(std::move(signal.starts)), as_array(std::move(signal.low)),
                                  as_array(std::move(signal.high)));
          },
          nb::arg("number"), "(first cells of the pieces, lower bounds, upper bounds) up to the end of the trace.");
}

void bind_linear(nb::module_& m) {
  using Monitor = tachk::LinearMonitor;
  nb::class_<Monitor>(m, "LinearMonitor", "Columns that are linear between samples; robustness in time.")
      .def(nb::new_([](nb::handle program, int measure) {
             if (measure < 0 || measure > 2) throw std::invalid_argument("there is no such measure");
             return std::make_unique<Monitor>(monitor_program_from(program), static_cast<tachk::Measure>(measure));
           }),
           nb::arg("program"), nb::kw_only(), nb::arg("measure"))
      .def(
          "push",
          [](Monitor& self, const TickArray& times, const nb::sequence& columns) {
            const SampleView view(times, columns);
            if (nb::len(columns) != self.columns()) throw std::invalid_argument("a column is missing or too many");
            nb::gil_scoped_release released;
            self.push(view.samples());
          },
          nb::arg("times"), nb::arg("columns"), "Takes samples: ticks that do not decrease, and the columns.")
      .def("finish", &Monitor::finish, nb::arg("end"), nb::arg("most_parts"),
           "The trace ends at this tick; crossings are told in at most so many parts of a tick.")
      .def(
          "compute",
          [](Monitor& self, std::size_t node, bool high) {
            if (node >= self.nodes()) throw std::invalid_argument("there is no such node");
            nb::gil_scoped_release released;
            static_cast<void>(self.robustness(node, high));
          },
          nb::arg("node"), nb::arg("high"), "What `robustness` of the node needs; operands first makes short steps.")
      .def(
          "robustness",
          [](Monitor& self, std::size_t node, bool high) {
            if (node >= self.nodes()) throw std::invalid_argument("there is no such node");
            std::vector<double> starts;
            std::vector<double> at;
            std::vector<double> after;
            std::vector<double> before;
            {
              nb::gil_scoped_release released;
              for (const tachk::LinearPiece& piece : self.robustness(node, high)) {
                starts.push_back(piece.start);
                at.push_back(piece.at);
                after.push_back(piece.after);
                before.push_back(piece.before);
              }
            }
            return nb::make_tuple(as_array(std::move(starts)), as_array(std::move(at)), as_array(std::move(after)),
                                  as_array(std::move(before)));
          },
          nb::arg("node"), nb::arg("high"), "(starts in ticks, values there, limits behind them, limits at the ends)")
      .def(
          "truth",
          [](const Monitor& self) {
            std::optional<Monitor::Judgement> found;
            {
              nb::gil_scoped_release released;
              found = self.truth();
            }
            return nb::make_tuple(found->verdict.low, found->verdict.high, violation_tuple(found->violation));
          },
          "The bounds of the truth, and (node, first cell, last cell) of the first violation or None.")
      .def(
          "truth_signal",
          [](const Monitor& self, std::size_t node) {
            if (node >= self.nodes()) throw std::invalid_argument("there is no such node");
            tachk::Signal<tachk::Truth> signal;
            {
              nb::gil_scoped_release released;
              signal = self.truth_signal(node);
            }
            return nb::make_tuple(as_array(std::move(signal.starts)), as_array(std::move(signal.low)),
                                  as_array(std::move(signal.high)));
          },
          nb::arg("node"), "(first cells of the pieces, lower bounds, upper bounds)")
      .def("refinement", &Monitor::refinement, "Into how many parts ticks are divided for truth.");
}

}  // namespace

void bind_monitor(nb::module_& m) {
  bind_offline<tachk::Truth>(m, "OfflineTruth", "Is a formula true on a trace?");
  bind_offline<tachk::Robustness>(m, "OfflineRobustness", "How robustly is a formula true on a trace?");
  bind_linear(m);
}
