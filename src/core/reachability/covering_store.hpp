// The states that a search has stored, and which new ones need not be: a state is dropped for a stored one whose zone
// contains its own, or, where only what can be reached matters, simulates it (aLU). Waiting states may be merged with
// new ones (Merging).
#pragma once

#include <cstdint>

#include "reachability/merging/merging.hpp"
#include "reachability/options.hpp"
#include "states/adaptive_check.hpp"
#include "states/store.hpp"
#include "symbolic/zone_graph.hpp"

namespace tachk::reachability {

class CoveringStore final {
 public:
  CoveringStore(symbolic::ZoneGraph& graph, const Options& options);

  states::PassedList& states() { return states_; }
  const states::PassedList& states() const { return states_; }
  const merging::Merging& merging() const { return merging_; }

  // Looks up the announced discrete state, to which the other calls belong.
  void locate() { discrete_ = states_.locate(); }
  // True if a successor may be dropped.
  bool covers(const symbolic::Successor& successor);
  // The stored state whose zone contains that of a successor; no_node if there is none.
  std::uint32_t coverer(const symbolic::Successor& successor) const;
  // The number of the new state; no_node if the successor is dropped. To be called only when `covers` has said no of
  // the successor before it was abstracted. States from `first_untouched` on wait.
  std::uint32_t add(const symbolic::Successor& successor, std::uint32_t parent, std::uint32_t first_untouched);

  std::size_t bytes() const { return states_.bytes() + merging_.bytes(); }

 private:
  bool simulates(const symbolic::Successor& successor);

  symbolic::ZoneGraph& graph_;
  bool subsumption_;
  bool is_divided_;  // a successor may be abstracted to several, which may be covered though it is not
  states::PassedList states_;
  merging::Merging merging_;
  states::AdaptiveCheck simulation_;
  std::uint32_t discrete_ = 0;
};

}  // namespace tachk::reachability
