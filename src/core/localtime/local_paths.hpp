// Paths of a search over local times in which interchangeable processes are sorted, as paths of processes that keep
// their places.
#pragma once

#include <cstdint>
#include <vector>

#include "localtime/local_graph.hpp"
#include "localtime/local_zone.hpp"
#include "symbolic/successor.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk::localtime {

// The same path without sorting: what the search calls the member at some place is another one whenever a state has
// been sorted. Throws ModelFault, ConstantOverflow.
symbolic::Path unsorted_path(LocalGraph& graph, const symbolic::Path& actions);

struct LocalState {
  std::vector<std::int32_t> slots;
  std::vector<LocalEntry> zone;
  zones::ZoneBuffer synchronised;
};

// Where a path leads to on which processes keep their places. Throws ModelFault, ConstantOverflow.
LocalState state_after(LocalGraph& graph, const symbolic::Path& actions);

}  // namespace tachk::localtime
