// Adds the search over local times to the extension module.
#pragma once

#include <nanobind/nanobind.h>

namespace tachk::bind {

void bind_localtime(nanobind::module_& m);

}  // namespace tachk::bind
