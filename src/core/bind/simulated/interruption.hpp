// Work of the core that Ctrl-C and a limit on time end.
#pragma once

#include <nanobind/nanobind.h>

#include <chrono>

#include "simulation/runs.hpp"

namespace tachk::bind {

// Does the work without the lock of Python; nothing comes of it if it takes more seconds, where these are not negative.
// Ctrl-C becomes its exception.
template <class Order, class Work>
void interruptibly(Order& order, double seconds, const Work& work) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begun = Clock::now();
  order.stop = [=] {
    if (seconds >= 0 && std::chrono::duration<double>(Clock::now() - begun).count() > seconds) return true;
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
