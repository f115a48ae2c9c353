// Work of the core that Ctrl-C and the limits of a job end.
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <exception>

#include "simulation/thread_pool.hpp"

namespace tachk::bind {

// So many seconds lie between two looks, for which a thread needs the lock of Python; before memory is taken it looks
// at once.
inline constexpr double between_signals = 0.02;

// Does the work without the lock of Python. Ctrl-C becomes its exception; what `check` raises, which is called with a
// number of bytes that are about to be taken, is raised too.
template <class Request, class Work>
void interruptibly(Request& request, const nanobind::callable& check, const Work& work) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begun = Clock::now();
  std::atomic<double> next = 0;
  std::atomic<bool> ended = false;
  std::exception_ptr reason;  // touched only with the lock of Python
  request.poll = [&](std::size_t bytes) {
    if (ended) throw simulation::Stopped();
    const double now = std::chrono::duration<double>(Clock::now() - begun).count();
    if (bytes == 0 && now < next) return;
    next = now + between_signals;
    const nanobind::gil_scoped_acquire acquired;
    if (ended) throw simulation::Stopped();
    try {
      if (PyErr_CheckSignals() != 0) throw nanobind::python_error();
      check(bytes);
    } catch (const nanobind::python_error&) {
      reason = std::current_exception();
      ended = true;
      throw simulation::Stopped();
    }
  };
  try {
    const nanobind::gil_scoped_release released;
    work();
  } catch (const simulation::Stopped&) {
    std::rethrow_exception(reason);
  }
}

}  // namespace tachk::bind
