// What the monitors of whole traces take and give, as Python has it.
#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "arrays.hpp"
#include "monitor_program.hpp"
#include "monitoring/offline/offline_monitor.hpp"

// Node, first cell, last cell.
using ViolationTuple = std::tuple<std::size_t, tachk::Cell, tachk::Cell>;

inline std::optional<ViolationTuple> violation_tuple(const std::optional<tachk::FirstViolation>& found) {
  if (!found) return std::nullopt;
  return ViolationTuple{found->node, found->first, found->last};
}

// The first cells of the pieces, lower bounds, upper bounds.
template <class Value>
nanobind::tuple signal_tuple(tachk::Signal<Value>&& signal) {
  return nanobind::make_tuple(as_array(std::move(signal.starts)), as_array(std::move(signal.low)),
                              as_array(std::move(signal.high)));
}

// Pushes samples where NumPy has them, without the interpreter lock.
template <class Monitor>
void push_samples(Monitor& monitor, const TickArray& times, const nanobind::sequence& columns) {
  const SampleView view(times, columns);
  if (nanobind::len(columns) != monitor.columns()) throw std::invalid_argument("a column is missing or too many");
  nanobind::gil_scoped_release released;
  monitor.push(view.samples());
}
