// Adds the set of states after what was seen to the extension module.
#pragma once

#include <nanobind/nanobind.h>

namespace tachk::bind {

void bind_estimation(nanobind::module_& m);

}  // namespace tachk::bind
