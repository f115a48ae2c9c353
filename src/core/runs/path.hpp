// A sequence of transitions, and when they happen.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tachk::runs {

// Of each transition the numbers of its edges: the sender first, then receivers in the order of their processes.
struct RunPath {
  std::vector<std::uint32_t> edges;
  std::vector<std::size_t> ends;  // of each transition: how many edges it and those before it have

  std::size_t size() const { return ends.size(); }
  std::span<const std::uint32_t> operator[](std::size_t number) const {
    const std::size_t first = number == 0 ? 0 : ends[number - 1];
    return {edges.data() + first, ends[number] - first};
  }
};

// Exact moments: a unit of time is `unit` ticks. There is one for each transition, and one for the end of the run.
struct Moments {
  std::int64_t unit = 1;
  std::vector<std::int64_t> ticks;
};

}  // namespace tachk::runs
