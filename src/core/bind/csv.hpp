// Adds the reader of recorded signals to the extension module.
#pragma once

#include <nanobind/nanobind.h>

void bind_csv(nanobind::module_& m);
