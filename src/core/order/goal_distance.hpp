// An estimate of how many steps a state is away from the goals: for each test of a goal on its own, the edges that the
// process still has to take to the location wanted, or by how much the variable differs. Of the next edge on the way
// the tests on variables count as well. It ignores clocks, and that one step may bring several tests nearer or undo
// others. So it guides a search, and proves nothing (for such distances see S. Kupferschmid, J. Hoffmann, H. Dierks,
// G. Behrmann, "Adapting an AI planning heuristic for directed model checking", SPIN 2006: h^L without the variables).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "program/program.hpp"

namespace tachk::order {

class GoalDistance final {
 public:
  explicit GoalDistance(const program::Program& program);

  // Of the nearest disjunct of the goals for which the search goes on.
  std::uint32_t of(const std::int32_t* slots) const;

 private:
  // The way of one process to one of its locations.
  struct Way {
    std::uint32_t process;
    std::vector<std::uint32_t> steps;  // from each location
    // Of each location the tests on variables of each edge that leads nearer; empty if an edge has none.
    std::vector<std::vector<std::vector<program::Test>>> obstacles;
  };
  struct Target {
    std::vector<std::size_t> ways;
    std::vector<program::Test> values;
  };

  std::size_t way_to(const program::Program& program, std::uint32_t process, std::int32_t location);
  static std::uint32_t along(const Way& way, const std::int32_t* slots);

  std::vector<Way> ways_;
  std::vector<std::int32_t> locations_;  // that each way leads to
  std::vector<Target> targets_;
};

}  // namespace tachk::order
