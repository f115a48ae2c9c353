// tachk._core.LinearMonitor; used through tachk.recordings.traces.linear_monitor.
#include "linear.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "monitor_program.hpp"
#include "monitor_results.hpp"
#include "monitoring/linear/linear_monitor.hpp"

namespace tachk::bind {

namespace nb = nanobind;
using monitoring::linear::RobustnessKind;

void bind_linear(nb::module_& m) {
  using Monitor = monitoring::linear::LinearMonitor;
  nb::enum_<RobustnessKind>(m, "Measure")
      .value("SPACE", RobustnessKind::space)
      .value("AHEAD", RobustnessKind::ahead)
      .value("BEHIND", RobustnessKind::behind);
  nb::class_<Monitor>(m, "LinearMonitor", "Columns that are linear between samples; robustness in time.")
      .def(nb::new_([](nb::handle program, RobustnessKind measure) {
             return std::make_unique<Monitor>(monitor_program_from(program), measure);
           }),
           nb::arg("program"), nb::kw_only(), nb::arg("measure"))
      .def("push", &push_samples<Monitor>, nb::arg("times"), nb::arg("columns"),
           "Takes samples: ticks that do not decrease, and the columns.")
      .def("finish", &Monitor::finish, nb::arg("end"), nb::arg("most_parts"),
           "The trace ends at this tick; crossings are given in at most so many parts of a tick.")
      .def(
          "compute",
          [](Monitor& self, std::size_t node, bool high) {
            if (node >= self.nodes()) throw std::invalid_argument("there is no such node");
            nb::gil_scoped_release released;
            static_cast<void>(self.robustness(node, high));
          },
          nb::arg("node"), nb::arg("high"),
          "The nodes that `robustness` of the node needs; operands first makes short steps.")
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
              for (const monitoring::linear::LinearPiece& piece : self.robustness(node, high)) {
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
            return nb::make_tuple(found->verdict.low, found->verdict.high, violation_tuple(found->violation),
                                  found->lasting);
          },
          "The bounds of the truth, (node, first cell, last cell) of the first violation or None, and the truth if all "
          "values stay.")
      .def(
          "truth_signal",
          [](const Monitor& self, std::size_t node) {
            if (node >= self.nodes()) throw std::invalid_argument("there is no such node");
            monitoring::offline::Signal<monitoring::offline::Truth> signal;
            {
              nb::gil_scoped_release released;
              signal = self.truth_signal(node);
            }
            return signal_tuple(std::move(signal));
          },
          nb::arg("node"), "(first cells of the pieces, lower bounds, upper bounds)")
      .def("refinement", &Monitor::refinement, "Into how many parts ticks are divided for truth.");
}

}  // namespace tachk::bind
