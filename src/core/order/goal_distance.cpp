#include "order/goal_distance.hpp"

#include <algorithm>
#include <cstdlib>

namespace tachk::order {
namespace {

using program::Comparison;
using program::Test;

constexpr std::uint32_t unreachable = 1'000'000;
constexpr std::int64_t largest_gap = 1'000;
constexpr std::size_t most_obstacles = 8;  // edges of one location

// By how much the value has to change for the test to hold.
std::uint32_t gap(const Test& test, const std::int32_t* slots) {
  if (test.holds(slots)) return 0;
  if (test.comparison == Comparison::not_equal) return 1;
  const std::int64_t apart = std::abs(std::int64_t{slots[test.slot]} - test.constant);
  const bool strict = test.comparison == Comparison::less || test.comparison == Comparison::greater;
  return static_cast<std::uint32_t>(std::min(apart + (strict ? 1 : 0), largest_gap));
}

std::uint32_t gaps(const std::vector<Test>& tests, const std::int32_t* slots) {
  std::uint32_t sum = 0;
  for (const Test& test : tests) sum += gap(test, slots);
  return sum;
}

}  // namespace

GoalDistance::GoalDistance(const program::Program& program) {
  const std::size_t processes = program.processes.size();
  for (const program::Goal& goal : program.goals) {
    if (!goal.decides) continue;
    for (const program::Disjunct& disjunct : goal.disjuncts) {
      Target target;
      for (const Test& test : disjunct.condition.tests) {
        if (test.slot < processes && test.comparison == Comparison::equal)
          target.ways.push_back(way_to(program, test.slot, test.constant));
        else
          target.values.push_back(test);
      }
      targets_.push_back(std::move(target));
    }
  }
}

std::size_t GoalDistance::way_to(const program::Program& program, std::uint32_t process, std::int32_t location) {
  for (std::size_t number = 0; number < ways_.size(); ++number)
    if (ways_[number].process == process && locations_[number] == location) return number;
  const std::size_t locations = program.processes[process].locations.size();
  Way way{process, std::vector<std::uint32_t>(locations, unreachable), {}};
  way.obstacles.resize(locations);
  std::vector<const program::Edge*> edges;
  for (const program::Edge& edge : program.edges)
    if (edge.process == process && edge.source != edge.target) edges.push_back(&edge);
  way.steps[static_cast<std::size_t>(location)] = 0;
  for (std::uint32_t steps = 0, found = 1; found > 0; ++steps) {
    found = 0;
    for (const program::Edge* edge : edges) {
      std::uint32_t& source = way.steps[static_cast<std::size_t>(edge->source)];
      if (source != unreachable || way.steps[static_cast<std::size_t>(edge->target)] != steps) continue;
      source = steps + 1;
      ++found;
    }
  }
  std::vector<bool> free(locations, false);
  for (const program::Edge* edge : edges) {
    const auto source = static_cast<std::size_t>(edge->source);
    if (way.steps[source] == unreachable) continue;
    if (way.steps[static_cast<std::size_t>(edge->target)] + 1 != way.steps[source]) continue;
    std::vector<Test> tests;
    for (const Test& test : edge->guard.tests)
      if (test.slot >= program.processes.size()) tests.push_back(test);
    auto& obstacles = way.obstacles[source];
    if (tests.empty() || obstacles.size() == most_obstacles) free[source] = true;
    obstacles.push_back(std::move(tests));
    if (free[source]) obstacles.resize(0);
  }
  ways_.push_back(std::move(way));
  locations_.push_back(location);
  return ways_.size() - 1;
}

std::uint32_t GoalDistance::along(const Way& way, const std::int32_t* slots) {
  const auto location = static_cast<std::size_t>(slots[way.process]);
  std::uint32_t least = 0;
  for (const std::vector<Test>& tests : way.obstacles[location]) {
    const std::uint32_t one = gaps(tests, slots);
    if (one == 0) return way.steps[location];
    least = least == 0 ? one : std::min(least, one);
  }
  return way.steps[location] + least;
}

std::uint32_t GoalDistance::of(const std::int32_t* slots) const {
  std::uint32_t nearest = UINT32_MAX;
  for (const Target& target : targets_) {
    std::uint32_t sum = gaps(target.values, slots);
    for (const std::size_t way : target.ways) sum += along(ways_[way], slots);
    nearest = std::min(nearest, sum);
  }
  return nearest;
}

}  // namespace tachk::order
