// tachk._core.OnlineMonitor; used through tachk.recordings.traces.online_monitor.
#include "online.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "monitor_program.hpp"
#include "monitoring/online/online_monitor.hpp"

namespace tachk::bind {

namespace nb = nanobind;

namespace {

// The monitor with room for one sample, so that single samples need no allocation.
struct Monitor {
  Monitor(monitoring::MonitorProgram program, bool quantitative)
      : columns(program.columns), numbers(columns), row(columns), monitor(std::move(program), quantitative) {
    for (std::size_t n = 0; n < columns; ++n) row[n].numbers = &numbers[n];
  }

  int update(std::int64_t tick, nb::handle values) {
    const nb::object items = nb::steal(PySequence_Fast(values.ptr(), "the values of a sample are a sequence"));
    if (!items.is_valid()) throw nb::python_error();
    if (static_cast<std::size_t>(PySequence_Size(items.ptr())) != columns)
      throw std::invalid_argument("a sample needs one value for every column");
    for (std::size_t n = 0; n < columns; ++n) {
      const nb::object item = nb::steal(PySequence_GetItem(items.ptr(), static_cast<Py_ssize_t>(n)));
      numbers[n] = PyFloat_AsDouble(item.ptr());
      if (numbers[n] == -1.0 && PyErr_Occurred() != nullptr) throw nb::python_error();
    }
    monitor.push({&tick, row.data(), 1});
    return static_cast<int>(monitor.verdict());
  }

  int push(const TickArray& ticks, const nb::sequence& arrays) {
    if (nb::len(arrays) != columns) throw std::invalid_argument("a chunk needs every column");
    const SampleView chunk(ticks, arrays);
    monitor.push(chunk.samples());
    return static_cast<int>(monitor.verdict());
  }

  std::size_t columns;
  std::vector<double> numbers;
  std::vector<monitoring::Column> row;
  monitoring::online::OnlineMonitor monitor;
};

// First cell, cell after the last, settled.
std::optional<std::tuple<std::int64_t, std::int64_t, bool>> online_violation_of(const Monitor& self) {
  const std::optional<monitoring::online::ViolatedSpan>& violation = self.monitor.violation();
  if (!violation) return std::nullopt;
  return std::make_tuple(violation->cells.first, violation->cells.end, violation->settled);
}

}  // namespace

void bind_online(nb::module_& m) {
  nb::class_<Monitor>(m, "OnlineMonitor")
      .def(nb::new_([](nb::handle program, bool quantitative) {
             return std::make_unique<Monitor>(monitor_program_from(program), quantitative);
           }),
           nb::arg("program"), nb::kw_only(), nb::arg("quantitative"))
      .def("update", &Monitor::update, nb::arg("tick"), nb::arg("values"),
           "One sample; the verdict: 0, 1, or 2 if open.")
      .def("push", &Monitor::push, nb::arg("ticks"), nb::arg("columns"), "Many samples; the verdict.")
      .def(
          "advance",
          [](Monitor& self, std::int64_t tick) {
            self.monitor.advance(tick);
            return static_cast<int>(self.monitor.verdict());
          },
          nb::arg("tick"), "Nothing has changed before this tick; the verdict.")
      .def(
          "finish",
          [](Monitor& self, std::int64_t tick) {
            self.monitor.finish(tick);
            return static_cast<int>(self.monitor.verdict());
          },
          nb::arg("tick"), "The trace ends with this tick; the verdict.")
      .def("verdict", [](const Monitor& self) { return static_cast<int>(self.monitor.verdict()); })
      .def("decided_at", [](const Monitor& self) { return self.monitor.decided_at(); })
      .def("violation", &online_violation_of, "(first cell, cell after the last, settled) or None.")
      .def(
          "robustness",
          [](Monitor& self) {
            const auto range = self.monitor.robustness();
            return std::make_tuple(range.low, range.high);
          },
          "(low, high)")
      .def("origin", [](const Monitor& self) { return self.monitor.origin(); })
      .def("now", [](const Monitor& self) { return self.monitor.now(); })
      .def("finished", [](const Monitor& self) { return self.monitor.finished(); })
      .def("bytes", [](const Monitor& self) { return self.monitor.bytes(); });
}

}  // namespace tachk::bind
