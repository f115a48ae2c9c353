// All reachable states, breadth first, of the zone graph or of its restriction. Of a restricted one the steps can be
// recorded for CoveredGraph, so that no state is expanded twice.
#pragma once

#include <cstdint>
#include <optional>

#include "liveness/covering_steps.hpp"
#include "liveness/ends.hpp"
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

  // Keeps the steps of the restricted graph, and where a run may end. To be called before the first `advance`.
  void record_steps(Ends& ends) { recorded_.emplace(Recorded{ends, {}, false}); }
  // The steps; null if they are not recorded.
  CoveringSteps* steps() { return recorded_ ? &recorded_->steps : nullptr; }
  // True if a run may end in a state whose steps are recorded.
  bool may_end() const { return recorded_ && recorded_->may_end; }

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
  std::size_t bytes() const { return passed_.bytes() + waiting_.bytes() + (recorded_ ? recorded_->steps.bytes() : 0); }

 private:
  struct Storing;
  struct Recorded {
    Ends& ends;
    CoveringSteps steps;
    bool may_end;
  };

  void expand(symbolic::SymbolicState& source);

  symbolic::ZoneGraph& graph_;
  Restriction* restriction_;
  bool subsumption_;
  states::PassedList passed_;
  order::Waiting waiting_;
  std::uint32_t node_ = states::no_node;
  std::uint64_t explored_ = 0;
  std::uint64_t transitions_ = 0;
  std::optional<Recorded> recorded_;
  bool started_ = false;
};

}  // namespace tachk::liveness
