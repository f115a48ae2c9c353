// Paths of a search over local times in which interchangeable processes are sorted, told with processes that keep their
// places.
#pragma once

#include "localtime/local_graph.hpp"
#include "symbolic/successor.hpp"

namespace tachk {

// The same path without sorting: what the search calls the member at some place is another one whenever a state has
// been sorted. Throws ModelFault, ConstantOverflow.
Path unsorted_path(LocalGraph& graph, const Path& actions);

}  // namespace tachk
