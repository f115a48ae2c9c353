// Adds the monitor of lines to the extension module.
#pragma once

#include <nanobind/nanobind.h>

namespace tachk::bind {

void bind_linear(nanobind::module_& m);

}  // namespace tachk::bind
