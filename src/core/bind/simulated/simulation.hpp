#pragma once

#include <nanobind/nanobind.h>

namespace tachk::bind {

// Adds the simulator and the questions about runs to the module.
void bind_simulation(nanobind::module_& m);
void bind_monitored(nanobind::module_& m);
void bind_trials(nanobind::module_& m);
void bind_splitting(nanobind::module_& m);
void bind_unit_run(nanobind::module_& m);

}  // namespace tachk::bind
