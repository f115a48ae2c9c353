// Adds the offline monitors to the extension module.
#pragma once

#include <nanobind/nanobind.h>

void bind_offline(nanobind::module_& m);
