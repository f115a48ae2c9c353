#pragma once

#include <nanobind/nanobind.h>

// tachk._core.PathOfRun.
void bind_runs(nanobind::module_& m);
