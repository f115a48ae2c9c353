// The agents of a local-time search, each with a time of its own: each process, and each group of variables that
// several processes use. What touches the same agent happens in the order of time; anything else may be done in either
// order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "program/program.hpp"

namespace tachk::localtime {

struct Agents {
  // Why the program cannot be searched with local times; nullptr if it can.
  const char* obstacle = nullptr;
  // The processes first, by their numbers, then groups of shared variables, whose time always passes.
  std::size_t count = 0;
  std::size_t processes = 0;
  std::vector<std::vector<std::uint32_t>> of_edge;  // in ascending order, its process included
  std::vector<std::uint32_t> of_clock;              // by number of the clock; that of clock 0 says nothing
  std::vector<std::uint32_t> of_slot;               // that stands for a shared variable; else `no_agent`

  static constexpr std::uint32_t no_agent = UINT32_MAX;
};

// Local times are sound for reachability only, and only where no action depends on the present of processes that do not
// take part: no committed location, urgent channel, broadcast, priority or stopwatch, no clocks compared with one
// another. An invariant may only speak of clocks and variables that no other process touches without this one taking
// part (Govind, Herbreteau, Srivathsan, Walukiewicz 2019, section 2).
Agents find_agents(const program::Program& program);

}  // namespace tachk::localtime
