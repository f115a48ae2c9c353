// Adds the reader of JSON lines to the extension module.
#pragma once

#include <nanobind/nanobind.h>

namespace tachk::bind {

void bind_json_lines(nanobind::module_& m);

}  // namespace tachk::bind
