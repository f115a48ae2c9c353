// Work of the core that Ctrl-C and a limit on time end.
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>

#include "simulation/runs.hpp"

namespace tachk::bind {

// So many seconds lie between two looks at whether Ctrl-C was pressed, for which a thread needs the lock of Python.
inline constexpr double between_signals = 0.02;

// Does the work without the lock of Python; nothing comes of it if it takes more seconds, where these are not negative.
// Ctrl-C becomes its exception.
template <class Order, class Work>
void interruptibly(Order& order, double seconds, const Work& work) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begun = Clock::now();
  std::atomic<double> next_signal = 0;
  order.stop = [=, &next_signal] {
    const double now = std::chrono::duration<double>(Clock::now() - begun).count();
    if (seconds >= 0 && now > seconds) return true;
    if (now < next_signal) return false;
    next_signal = now + between_signals;
    const nanobind::gil_scoped_acquire acquired;
    return PyErr_CheckSignals() != 0;
  };
  try {
    const nanobind::gil_scoped_release released;
    work();
  } catch (const simulation::Stopped&) {
    if (PyErr_Occurred() != nullptr) throw nanobind::python_error();
  }
}

}  // namespace tachk::bind
