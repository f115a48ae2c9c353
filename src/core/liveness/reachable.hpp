// All reachable states, breadth first, of the zone graph or of its restriction.
#pragma once

#include <cstdint>

#include "liveness/restriction.hpp"
#include "order/waiting.hpp"
#include "reachability/options.hpp"
#include "states/store.hpp"
#include "symbolic/zone_graph.hpp"

namespace tachk::liveness {

class Reachable final {
 public:
  // `restriction` may be null.
  Reachable(symbolic::ZoneGraph& graph, Restriction* restriction, const reachability::Options& options,
            const reachability::Limits& limits);

  // Expands one state; false if none is left. Throws ModelFault, ConstantOverflow.
  bool advance(symbolic::SymbolicState& source);

  bool is_restricted() const { return restriction_ != nullptr; }
  states::PassedList& states() { return passed_; }
  const states::PassedList& states() const { return passed_; }
  // The state being expanded; no_node before the first.
  std::uint32_t node() const { return node_; }
  // True if the limit on depth has left nothing out.
  bool complete() const { return waiting_.complete(); }
  std::uint64_t explored() const { return explored_; }
  std::uint64_t transitions() const { return transitions_; }
  std::size_t bytes() const { return passed_.bytes() + waiting_.bytes(); }

 private:
  struct Storing;

  symbolic::ZoneGraph& graph_;
  Restriction* restriction_;
  bool subsumption_;
  states::PassedList passed_;
  order::Waiting waiting_;
  std::uint32_t node_ = states::no_node;
  std::uint64_t explored_ = 0;
  std::uint64_t transitions_ = 0;
  bool started_ = false;
};

}  // namespace tachk::liveness
