// Which edges a search has taken, how each was taken first, and how many steps it has made.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "states/store.hpp"
#include "symbolic/zone_graph.hpp"

namespace tachk::reachability {

class TakenEdges final {
 public:
  explicit TakenEdges(std::size_t edges) : sources_(edges, states::no_node), actions_(edges) {}

  void before_expand(std::uint32_t node, const symbolic::SymbolicState&) { expanded_ = node; }
  bool on_successor(const symbolic::Successor& successor) {
    if (!successor.edges.empty()) ++steps_;
    for (const std::uint32_t edge : successor.edges)
      if (sources_[edge] == states::no_node) {
        sources_[edge] = expanded_;
        actions_[edge].assign(successor.edges.begin(), successor.edges.end());
      }
    return true;
  }

  std::uint64_t steps() const { return steps_; }
  // In ascending order.
  std::vector<std::uint32_t> edges() const {
    std::vector<std::uint32_t> edges;
    for (std::uint32_t edge = 0; edge < sources_.size(); ++edge)
      if (taken(edge)) edges.push_back(edge);
    return edges;
  }
  bool taken(std::size_t edge) const { return source(edge) != states::no_node; }
  // The node from which an edge was taken first; no_node where it has not been taken.
  std::uint32_t source(std::size_t edge) const { return sources_.at(edge); }
  // The action that took it there, with processes sorted as in that node.
  const symbolic::Edges& action(std::size_t edge) const { return actions_.at(edge); }

 private:
  std::vector<std::uint32_t> sources_;
  std::vector<symbolic::Edges> actions_;
  std::uint32_t expanded_ = states::no_node;
  std::uint64_t steps_ = 0;
};

}  // namespace tachk::reachability
