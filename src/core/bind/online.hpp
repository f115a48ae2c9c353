// Adds the online monitor to the extension module.
#pragma once

#include <nanobind/nanobind.h>

void bind_online(nanobind::module_& m);
