// Which states of a graph lie on circles, against what can be reached from each.
#include "liveness/circles.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <random>
#include <vector>

#include "check.hpp"

namespace {

using tachk::liveness::Circles;
using Graph = std::vector<std::vector<std::uint32_t>>;

void go_through(const Graph& graph, std::uint32_t state, Circles& circles) {
  circles.enter(state);
  for (const std::uint32_t target : graph[state])
    if (circles.is_new(target))
      go_through(graph, target, circles);
    else
      circles.join(target);
  circles.leave(state);
}

bool returns(const Graph& graph, std::uint32_t state) {
  std::vector<bool> seen(graph.size());
  std::vector<std::uint32_t> waiting = graph[state];
  while (!waiting.empty()) {
    const std::uint32_t next = waiting.back();
    waiting.pop_back();
    if (next == state) return true;
    if (seen[next]) continue;
    seen[next] = true;
    waiting.insert(waiting.end(), graph[next].begin(), graph[next].end());
  }
  return false;
}

}  // namespace

int main() {
  std::mt19937 random(1);
  for (int round = 0; round < 2000; ++round) {
    Graph graph(1 + random() % 12);
    for (auto steps = random() % (2 * graph.size()); steps != 0; --steps)
      graph[random() % graph.size()].push_back(static_cast<std::uint32_t>(random() % graph.size()));
    Circles circles;
    circles.resize(graph.size());
    std::vector<std::uint32_t> expected;
    for (std::uint32_t state = 0; state < graph.size(); ++state) {
      if (circles.is_new(state)) go_through(graph, state, circles);
      if (returns(graph, state)) expected.push_back(state);
    }
    std::vector<std::uint32_t> found = circles.circular();
    std::sort(found.begin(), found.end());
    CHECK(found == expected);
    CHECK(circles.entered() == graph.size());
  }
  std::puts("states on circles are those to which some path returns");
}
