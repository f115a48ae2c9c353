#pragma once

#include <nanobind/nanobind.h>

namespace tachk::bind {

// The search for a proof and the check of one.
void bind_certificates(nanobind::module_& m);

}  // namespace tachk::bind
