// A run that is given, gone again without extrapolation.
#pragma once

#include <cstddef>

#include "liveness/ends.hpp"
#include "liveness/predicate.hpp"
#include "liveness/restriction.hpp"
#include "symbolic/zone_graph.hpp"

namespace tachk::liveness {

// True if these actions can end in a state that is stuck and avoid the predicate of the restriction from action number
// `begins` on, where `beginning` holds (null: everywhere). The graph is one without extrapolation. False also if clock
// values become too large on the way.
bool gets_stuck(symbolic::ZoneGraph& graph, Restriction& restriction, Ends& ends, Predicate* beginning,
                const symbolic::Path& actions, std::size_t begins);

}  // namespace tachk::liveness
