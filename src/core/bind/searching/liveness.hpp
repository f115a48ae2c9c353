// Adds the search for runs that avoid a predicate for ever to the extension module.
#pragma once

#include <nanobind/nanobind.h>

namespace tachk::bind {

void bind_liveness(nanobind::module_& m);

}  // namespace tachk::bind
