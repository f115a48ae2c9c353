// A piece of a search that Ctrl-C and limits end, also in the midst of a state.
#pragma once

#include <nanobind/nanobind.h>

#include <chrono>
#include <cstdint>
#include <optional>

#include "reachability/explorer.hpp"
#include "zones/patience.hpp"

namespace tachk::bind {

// Runs a search without the lock of Python, for at most so many seconds. Ctrl-C becomes its exception; what `poll`,
// which is called a few times a second, raises ends the search, too.
template <class Search>
reachability::Status run_patiently(Search& search, std::uint64_t expansions, std::optional<double> seconds,
                                   const nanobind::object& poll) {
  using Clock = zones::Patience::Clock;
  std::optional<Clock::time_point> end;
  constexpr double most = 1e8;  // what a clock can count without overflow is more
  if (seconds && *seconds < most)
    end = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(*seconds));
  try {
    const nanobind::gil_scoped_release released;
    const zones::Patience patience(end, [&] {
      const nanobind::gil_scoped_acquire acquired;
      if (PyErr_CheckSignals() != 0) return false;
      if (poll.is_none()) return true;
      PyObject* const seen = PyObject_CallNoArgs(poll.ptr());
      Py_XDECREF(seen);
      return seen != nullptr;
    });
    return search.run(expansions);
  } catch (const zones::GivenUp&) {
    if (PyErr_Occurred() != nullptr) throw nanobind::python_error();
    return reachability::Status::time_limit;
  }
}

}  // namespace tachk::bind
