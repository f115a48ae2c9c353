// How to search and when to give up. No option may change a verdict. The fields are those of the same names in
// tachk.engine.options, where it is documented what each is for and which values it takes: nothing is checked here.
#pragma once

#include <cstdint>

#include "order/orders.hpp"
#include "states/store.hpp"
#include "symbolic/zone_graph.hpp"

namespace tachk::reachability {

struct Options : symbolic::ZoneGraphOptions, states::StoreOptions {
  order::SearchOrder order = order::SearchOrder::automatic;
  std::uint32_t seed = 0;
  bool subsumption = true;
  bool alu = true;      // a state is dropped also for one that simulates it, where only what can be reached matters
  bool merging = true;  // waiting states of one discrete part become one where their zones together are a zone
  bool pruning = true;  // a state is dropped if no goal can be reached from it, as far as single processes tell
  // Where time cannot pass, not all orders of independent actions are explored.
  bool partial_order = false;
  bool shortest = false;  // breadth first only: no path to a goal is shorter than the one that is found
  // For liveness: after so many states depth first a short proof is looked for; of p --> q at once; UINT32_MAX: never.
  std::uint32_t proof_after = 2000;
  bool depth_first = true;  // for runs that avoid a goal: steps depth first on the way to all states
};

struct Limits {
  std::uint64_t states = UINT64_MAX;  // stored
  std::uint64_t memory_bytes = UINT64_MAX;
  std::uint32_t depth = UINT32_MAX;
};

}  // namespace tachk::reachability
