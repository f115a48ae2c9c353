// How to search. No option may change a verdict; what each is for is documented in tachk.engines.protocol.
#pragma once

#include <cstddef>
#include <cstdint>

#include "symbolic/zone_graph.hpp"

namespace tachk {

enum class SearchOrder { breadth_first, depth_first, random_depth_first };

struct Options : ZoneGraphOptions {
  SearchOrder order = SearchOrder::breadth_first;
  std::uint32_t seed = 1;
  bool subsumption = true;
  bool reclaim = true;
  // States with one process in a committed location are passed through, not stored, up to so many in a row.
  std::uint32_t passing = 0;
  bool shortest = false;        // breadth first only: no path to a goal is shorter than the one that is found
  std::size_t chunk_words = 8;  // of the parts in which large discrete states are held; 0: in one
  std::uint64_t state_limit = UINT64_MAX;
  std::uint64_t memory_limit = UINT64_MAX;
  std::uint32_t depth_limit = UINT32_MAX;
};

}  // namespace tachk
