// Adds the online monitor to the extension module.
#pragma once

#include <nanobind/nanobind.h>

namespace tachk::bind {

void bind_online(nanobind::module_& m);

}  // namespace tachk::bind
