// Adds the monitors of growing traces, as users feed them, to the extension module.
#pragma once

#include <nanobind/nanobind.h>

namespace tachk::bind {

void bind_group(nanobind::module_& m);

}  // namespace tachk::bind
