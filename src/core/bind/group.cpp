// tachk._core.MonitorGroup: rows as Python has them, dictionaries of numbers or of arrays; used through
// tachk.recordings.monitors.online. And the times of a whole trace as ticks.
#include "group.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "monitor_program.hpp"
#include "monitoring/online/monitor_group.hpp"
#include "monitoring/ticks.hpp"

namespace tachk::bind {

namespace nb = nanobind;
using monitoring::online::MonitorGroup;

namespace {

using monitoring::int128;
using monitoring::online::RowFault;

nb::object python_int(int128 number) {
  const auto high = static_cast<std::int64_t>(number >> 62);
  const auto low = static_cast<std::int64_t>(number & ((int128{1} << 62) - 1));
  return (nb::int_(high) << nb::int_(62)) + nb::int_(low);
}

struct Group {
  Group(std::vector<MonitorGroup::Watched> watched, const std::vector<std::string>& columns, bool quantitative,
        bool all_violations, const monitoring::TickScale& scale_, std::int64_t reach, std::size_t most_rows,
        nb::object exact_, nb::object truths_)
      : scale(scale_),
        group(std::move(watched), columns.size(), quantitative, all_violations, scale_, reach, most_rows),
        row(columns.size()),
        views(columns.size()),
        exact(std::move(exact_)),
        truths{truths_[0], truths_[1], truths_[2]} {
    for (const std::string& column : columns) names.push_back(nb::steal(PyUnicode_InternFromString(column.c_str())));
  }

  nb::object verdict() const { return truths[static_cast<std::size_t>(group.verdict())]; }

  // The verdict, or None where there is something to look after: a decision, or a fault.
  nb::object answer(RowFault found) {
    fault = found;
    return found != RowFault::none || group.decided_some() ? nb::none() : verdict();
  }

  // A time in ticks, and as a floating-point number where it is one. None with a fault if it cannot be counted.
  std::optional<int128> tick(nb::handle time, std::optional<double>& number) {
    if (PyFloat_Check(time.ptr())) {
      number = PyFloat_AsDouble(time.ptr());
      const std::optional<int128> found = std::isfinite(*number) ? scale.tick(*number) : std::nullopt;
      if (!found) fault = RowFault::not_a_time;
      return found;
    }
    nb::object ticks = PyLong_Check(time.ptr()) ? nb::borrow(time) : exact(time);
    int overflow = 0;
    const long long whole = PyLong_AsLongLongAndOverflow(ticks.ptr(), &overflow);
    if (whole == -1 && PyErr_Occurred() != nullptr) throw nb::python_error();
    if (overflow != 0) {
      fault = RowFault::too_far;
      return std::nullopt;
    }
    if (!PyLong_Check(time.ptr())) return int128{whole};
    constexpr long long exact_doubles = 1LL << 53;
    if (-exact_doubles <= whole && whole <= exact_doubles) number = static_cast<double>(whole);
    return int128{whole} * scale.ticks_per_unit();
  }

  // The number that a column gets; NaN where it keeps the one it has. None for what is no number.
  static std::optional<double> number_of(PyObject* value) {
    constexpr double keeps = std::numeric_limits<double>::quiet_NaN();
    if (value == nullptr || value == Py_None) return keeps;
    if (PyFloat_CheckExact(value)) return PyFloat_AsDouble(value);
    const double number = PyFloat_AsDouble(value);
    if (number == -1.0 && PyErr_Occurred() != nullptr) {
      PyErr_Clear();
      return std::nullopt;
    }
    return number;
  }

  nb::object update(nb::handle time, nb::handle values, nb::handle more) {
    nb::object copied;
    PyObject* given = values.is_none() ? nullptr : values.ptr();
    if (given != nullptr && !PyDict_Check(given)) {
      copied = nb::steal(PyObject_CallFunctionObjArgs(reinterpret_cast<PyObject*>(&PyDict_Type), given, nullptr));
      if (!copied.is_valid()) throw nb::python_error();
      given = copied.ptr();
    }
    PyObject* const others = PyDict_Size(more.ptr()) == 0 ? nullptr : more.ptr();
    for (std::size_t n = 0; n < names.size(); ++n) {
      PyObject* value = given == nullptr ? nullptr : PyDict_GetItemWithError(given, names[n].ptr());
      if (value == nullptr && others != nullptr) value = PyDict_GetItemWithError(others, names[n].ptr());
      if (value == nullptr && PyErr_Occurred() != nullptr) throw nb::python_error();
      const std::optional<double> number = number_of(value);
      if (!number) {
        faulty_column = n;
        return answer(RowFault::not_a_value);
      }
      row[n] = *number;
    }
    std::optional<double> plain;
    const std::optional<int128> at = tick(time, plain);
    if (!at) return nb::none();
    const RowFault found = group.update(*at, plain, row);
    faulty_column = group.faulty_column();
    return answer(found);
  }

  // As `update`; a column that is no contiguous array of float64, bool, or uint8 of 0 and 1, or lacks a number, is a
  // `not_a_value`.
  nb::object push(nb::handle given_times, nb::handle columns, std::int64_t factor) {
    TickArray times;
    if (!nb::try_cast(given_times, times, false)) return answer(RowFault::not_a_time);
    faulty_column = 0;
    if (!PyDict_Check(columns.ptr())) return answer(RowFault::not_a_value);
    using Numbers = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
    using Bytes = nb::ndarray<const std::uint8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
    using Flags = nb::ndarray<const bool, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
    const std::size_t count = times.shape(0);
    Numbers numbers;
    Bytes bytes;
    Flags flags;
    for (std::size_t n = 0; n < names.size(); ++n) {
      faulty_column = n;
      PyObject* const value = PyDict_GetItemWithError(columns.ptr(), names[n].ptr());
      if (value == nullptr) return answer(RowFault::not_a_value);
      std::size_t length = 0;
      if (nb::try_cast(nb::handle(value), numbers, false)) {
        length = numbers.shape(0);
        views[n] = {numbers.data(), nullptr};
        if (!monitoring::all_finite(numbers.data(), length) &&
            std::any_of(numbers.data(), numbers.data() + length, [](double number) { return std::isnan(number); }))
          return answer(RowFault::not_a_value);
      } else if (nb::try_cast(nb::handle(value), bytes, false)) {
        length = bytes.shape(0);
        if (std::any_of(bytes.data(), bytes.data() + length, [](std::uint8_t byte) { return byte > 1; }))
          return answer(RowFault::not_a_value);
        views[n] = {nullptr, bytes.data()};
      } else if (nb::try_cast(nb::handle(value), flags, false)) {
        length = flags.shape(0);
        views[n] = {nullptr, reinterpret_cast<const std::uint8_t*>(flags.data())};
      } else {
        return answer(RowFault::not_a_value);
      }
      if (length != count) return answer(RowFault::not_a_value);
    }
    // The dictionary holds the arrays while they are read.
    const RowFault found = group.push(times.data(), factor, views, count, faulty_row);
    faulty_column = group.faulty_column();
    return answer(found);
  }

  nb::object advance(nb::handle time) {
    std::optional<double> plain;
    const std::optional<int128> at = tick(time, plain);
    return at ? answer(group.advance(*at)) : nb::none();
  }

  nb::object finish(nb::handle time) {
    std::optional<double> plain;
    std::optional<int128> at;
    if (!time.is_none()) {
      at = tick(time, plain);
      if (!at) return nb::none();
    }
    return answer(group.finish(at));
  }

  monitoring::TickScale scale;
  MonitorGroup group;
  std::vector<nb::object> names;
  std::vector<double> row;
  std::vector<monitoring::Column> views;
  nb::object exact;  // counts times that are neither int nor float
  nb::object truths[3];
  RowFault fault = RowFault::none;
  std::size_t faulty_column = 0;
  std::size_t faulty_row = 0;
};

std::unique_ptr<Group> make_group(const std::vector<nb::object>& programs, const std::vector<std::string>& columns,
                                  bool quantitative, bool all_violations, int decimals, std::int64_t parts,
                                  std::int64_t reach, std::size_t most_rows, nb::object exact, nb::object truths) {
  std::vector<MonitorGroup::Watched> watched;
  for (const nb::object& program : programs) {
    MonitorGroup::Watched each{monitor_program_from(program), {}};
    for (const auto& name : nb::cast<std::vector<std::string>>(program.attr("columns"))) {
      const auto found = std::find(columns.begin(), columns.end(), name);
      if (found == columns.end()) throw std::invalid_argument("a program reads a column that is not there");
      each.places.push_back(static_cast<std::size_t>(found - columns.begin()));
    }
    watched.push_back(std::move(each));
  }
  return std::make_unique<Group>(std::move(watched), columns, quantitative, all_violations,
                                 monitoring::TickScale(decimals, parts), reach, most_rows, std::move(exact),
                                 std::move(truths));
}

// First cell, cell after the last.
std::optional<std::pair<std::int64_t, std::int64_t>> violation_of(const Group& self, std::size_t number) {
  const auto& violation = self.group.monitor(number).violation();
  if (!violation) return std::nullopt;
  return std::make_pair(violation->cells.first, violation->cells.end);
}

std::vector<std::pair<std::int64_t, std::int64_t>> pairs_of(const std::vector<monitoring::online::Span>& spans) {
  std::vector<std::pair<std::int64_t, std::int64_t>> pairs;
  pairs.reserve(spans.size());
  for (const monitoring::online::Span& span : spans) pairs.emplace_back(span.first, span.end);
  return pairs;
}

nb::tuple retained_rows(const Group& self) {
  const auto copied = [](auto values) { return as_array(std::vector(values.begin(), values.end())); };
  nb::list columns;
  for (std::size_t n = 0; n < self.group.columns(); ++n) columns.append(copied(self.group.retained_column(n)));
  return nb::make_tuple(copied(self.group.retained_ticks()), columns, self.group.has_all_rows());
}

using Times = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

using WrittenTicks = nb::ndarray<std::int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

nb::tuple count_times(const Times& times, int usual, const WrittenTicks& ticks) {
  if (ticks.shape(0) != times.shape(0)) throw std::invalid_argument("every time has a tick");
  monitoring::CountedTimes found;
  {
    nb::gil_scoped_release released;
    found = monitoring::counted({times.data(), times.shape(0)}, usual, ticks.data());
  }
  return nb::make_tuple(found.first, found.decimals, static_cast<int>(found.fault), found.row, found.rounded);
}

}  // namespace

void bind_group(nb::module_& m) {
  nb::class_<Group>(m, "MonitorGroup")
      .def(nb::new_(&make_group), nb::kw_only(), nb::arg("programs"), nb::arg("columns"), nb::arg("quantitative"),
           nb::arg("all_violations"), nb::arg("decimals"), nb::arg("parts"), nb::arg("reach"), nb::arg("most_rows"),
           nb::arg("exact"), nb::arg("truths"))
      .def("update", &Group::update, nb::arg("time"), nb::arg("values").none(), nb::arg("more"),
           "One row; the joint verdict, or None where there is a decision or a fault.")
      .def("push", &Group::push, nb::arg("times"), nb::arg("columns"), nb::arg("factor"), "Many rows, likewise.")
      .def("advance", &Group::advance, nb::arg("time"), "Nothing has changed before this time.")
      .def("finish", &Group::finish, nb::arg("time").none(), "The trace is over.")
      .def("verdict", &Group::verdict, "Of all formulas together.")
      .def(
          "fault",
          [](const Group& self) {
            return std::make_tuple(static_cast<int>(self.fault), self.faulty_column, self.faulty_row);
          },
          "(kind, column, row) of the last call")
      .def("open", [](const Group& self) { return self.group.open(); })
      .def(
          "held", [](const Group& self, std::size_t column) { return self.group.held(column); }, nb::arg("column"))
      .def("rows", [](const Group& self) { return self.group.rows(); })
      .def("begun", [](const Group& self) { return self.group.begun(); })
      .def("origin", [](const Group& self) { return python_int(self.group.origin()); })
      .def(
          "now", [](const Group& self) { return self.group.now(); }, "Since the origin.")
      .def("retained_rows", &retained_rows, "(ticks since the origin, columns, whether these are all rows)")
      .def(
          "verdict_of",
          [](const Group& self, std::size_t n) { return static_cast<int>(self.group.monitor(n).verdict()); },
          nb::arg("number"))
      .def(
          "decided_at", [](const Group& self, std::size_t n) { return self.group.monitor(n).decided_at(); },
          nb::arg("number"))
      .def("violation", &violation_of, nb::arg("number"))
      .def(
          "take_violations",
          [](Group& self, std::size_t n) { return pairs_of(self.group.monitor(n).take_violations()); },
          nb::arg("number"), "(first cell, cell after the last) of those that have ended since the last call.")
      .def(
          "violated_since", [](const Group& self, std::size_t n) { return self.group.monitor(n).violated_since(); },
          nb::arg("number"), "The first cell of a violation that has not ended.")
      .def(
          "finished", [](const Group& self, std::size_t n) { return self.group.monitor(n).finished(); },
          nb::arg("number"))
      .def(
          "robustness",
          [](Group& self, std::size_t n) {
            const auto range = self.group.monitor(n).robustness();
            return std::make_tuple(range.low, range.high);
          },
          nb::arg("number"))
      .def("bytes", [](const Group& self) {
        std::size_t total = 0;
        for (std::size_t n = 0; n < self.group.size(); ++n) total += self.group.monitor(n).bytes();
        return total;
      });
  m.def(
      "count_times", &count_times, nb::arg("times"), nb::arg("usual"), nb::arg("ticks"),
      "Writes the ticks from the first on: (the first, decimals, fault, row of the fault, whether some were rounded).");
  m.def(
      "count_as",
      [](const Times& times, int decimals, std::int64_t first, std::int64_t factor, const WrittenTicks& ticks) {
        if (ticks.shape(0) != times.shape(0)) throw std::invalid_argument("every time has a tick");
        if (times.shape(0) == 0) return true;
        return monitoring::CountedAs::wrong != monitoring::counted_as({times.data(), times.shape(0)}, times.data()[0],
                                                                      decimals, first, factor, ticks.data());
      },
      nb::arg("times"), nb::arg("decimals"), nb::arg("first"), nb::arg("factor"), nb::arg("ticks"),
      "Writes ticks of times that are whole in units of 10^-decimals; false if they are not, or decrease.");
  m.def(
      "first_backwards",
      [](const TickArray& times) -> std::optional<std::size_t> {
        const std::size_t row = monitoring::first_backwards(times.data(), times.shape(0));
        return row == times.shape(0) ? std::nullopt : std::optional(row);
      },
      nb::arg("times"), "The first row with an earlier time than the row before.");
  m.def(
      "all_finite", [](const Times& values) { return monitoring::all_finite(values.data(), values.shape(0)); },
      nb::arg("values"));
}

}  // namespace tachk::bind
