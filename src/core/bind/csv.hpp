// Adds the reader of recorded signals to the extension module.
#pragma once

#include <nanobind/nanobind.h>

namespace tachk::bind {

void bind_csv(nanobind::module_& m);

}  // namespace tachk::bind
