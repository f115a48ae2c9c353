// Adds the search for runs that avoid a predicate for ever to the extension module.
#pragma once

#include <nanobind/nanobind.h>

void bind_liveness(nanobind::module_& m);
