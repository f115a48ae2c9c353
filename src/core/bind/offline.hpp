// Adds the offline monitors to the extension module.
#pragma once

#include <nanobind/nanobind.h>

namespace tachk::bind {

void bind_offline(nanobind::module_& m);

}  // namespace tachk::bind
