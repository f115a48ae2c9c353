// The arguments and results of the monitors of whole traces as Python objects.
#pragma once

#include <nanobind/nanobind.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "monitor_program.hpp"
#include "monitoring/offline/offline_monitor.hpp"
#include "monitoring/ticks.hpp"

namespace tachk::bind {

// Node, first cell, last cell.
using ViolationTuple = std::tuple<std::size_t, monitoring::Cell, monitoring::Cell>;

inline std::optional<ViolationTuple> violation_tuple(const std::optional<monitoring::offline::FirstViolation>& found) {
  if (!found) return std::nullopt;
  return ViolationTuple{found->node, found->first, found->last};
}

// The first cells of the pieces, lower bounds, upper bounds.
template <class Value>
nanobind::tuple signal_tuple(monitoring::offline::Signal<Value>&& signal) {
  return nanobind::make_tuple(as_array(std::move(signal.starts)), as_array(std::move(signal.low)),
                              as_array(std::move(signal.high)));
}

using NumberArray = nanobind::ndarray<const double, nanobind::ndim<1>, nanobind::c_contig, nanobind::device::cpu>;

// Pushes rows whose times are floating-point numbers (see `counted_as`), and looks whether some columns are
// finite, in pieces that stay in the cache. Returns false where a time cannot be counted or a value is not finite; the
// monitor has then some of the rows, and is of no more use. `all`: look at the rows that do not matter to it, too.
template <class Monitor>
bool push_counted(Monitor& monitor, const NumberArray& times, double before, int decimals, std::int64_t first,
                  std::int64_t factor, const nanobind::sequence& columns, const std::vector<NumberArray>& finite,
                  bool all) {
  const SampleView view(nullptr, times.shape(0), columns);
  if (nanobind::len(columns) != monitor.columns()) throw std::invalid_argument("a column is missing or too many");
  for (const NumberArray& values : finite)
    if (values.shape(0) != times.shape(0)) throw std::invalid_argument("every column has a value for every time");
  nanobind::gil_scoped_release released;
  constexpr std::size_t block = monitoring::AtomEvaluator::block;
  std::array<std::int64_t, block> ticks;
  std::vector<monitoring::Column> piece(view.samples().columns, view.samples().columns + monitor.columns());
  for (std::size_t row = 0; row < times.shape(0); row += block) {
    if (!all && monitor.settled()) return true;
    const std::size_t count = std::min(block, times.shape(0) - row);
    const double* const part = times.data() + row;
    const monitoring::CountedAs counted =
        monitoring::counted_as({part, count}, row == 0 ? before : part[-1], decimals, first, factor, ticks.data());
    if (counted == monitoring::CountedAs::wrong) return false;
    // The next times come while the monitor is busy.
    for (std::size_t next = row + block; next < std::min(row + 2 * block, times.shape(0)); next += 8)
      __builtin_prefetch(times.data() + next);
    const bool strictly = counted == monitoring::CountedAs::rising_strictly;
    if (!monitor.settled()) monitor.push({ticks.data(), piece.data(), count, strictly});
    // The monitor does more with values than this does, so it had better be the one to wait for them.
    for (const NumberArray& values : finite)
      if (!monitoring::all_finite(values.data() + row, count)) return false;
    for (monitoring::Column& column : piece) {
      if (column.numbers != nullptr) column.numbers += count;
      if (column.flags != nullptr) column.flags += count;
    }
  }
  return true;
}

// Pushes samples where NumPy has them, without the interpreter lock.
template <class Monitor>
void push_samples(Monitor& monitor, const TickArray& times, const nanobind::sequence& columns) {
  const SampleView view(times, columns);
  if (nanobind::len(columns) != monitor.columns()) throw std::invalid_argument("a column is missing or too many");
  nanobind::gil_scoped_release released;
  monitor.push(view.samples());
}

}  // namespace tachk::bind
