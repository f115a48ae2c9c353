// Which edges a search has taken, and how many steps it has made.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "symbolic/zone_graph.hpp"

namespace tachk::reachability {

class TakenEdges final {
 public:
  explicit TakenEdges(std::size_t edges) : taken_(edges, 0) {}

  bool on_successor(const symbolic::Successor& successor) {
    if (!successor.edges.empty()) ++steps_;
    for (const std::uint32_t edge : successor.edges) taken_[edge] = 1;
    return true;
  }

  std::uint64_t steps() const { return steps_; }
  // In ascending order.
  std::vector<std::uint32_t> edges() const {
    std::vector<std::uint32_t> edges;
    for (std::uint32_t edge = 0; edge < taken_.size(); ++edge)
      if (taken_[edge] != 0) edges.push_back(edge);
    return edges;
  }

 private:
  std::vector<std::uint8_t> taken_;
  std::uint64_t steps_ = 0;
};

}  // namespace tachk::reachability
