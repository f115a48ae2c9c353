#pragma once

#include <nanobind/nanobind.h>

namespace tachk::bind {

// tachk._core.PathOfRun.
void bind_runs(nanobind::module_& m);

}  // namespace tachk::bind
