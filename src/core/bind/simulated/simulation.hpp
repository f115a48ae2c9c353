#pragma once

#include <nanobind/nanobind.h>

// Adds the simulator to the module.
void bind_simulation(nanobind::module_& m);
