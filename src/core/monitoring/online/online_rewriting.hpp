// Another form of a formula G f, whose robustness falls as soon as the reason has been seen.
#pragma once

#include <optional>

#include "monitoring/monitor_program.hpp"

namespace tachk::monitoring::online {

// G(a && b) becomes G a && G b, and G(a || G[c,d] b) becomes G(H[c,d] a || b): the same over a trace without end, but
// decided without waiting for d. On a trace that has ended the second one forgets what the end leaves open, so it gives
// upper bounds only while the trace goes on. Nothing if there is no such G outside.
std::optional<MonitorProgram> falling_sooner(const MonitorProgram& program);

}  // namespace tachk::monitoring::online
