// The actions of a state in two parts: those of a stubborn set, and the others. The others are left out if some action
// of the set that is possible in all of the zone leads to a state that is expanded later, or that has been expanded
// with all its actions. Then no action is put off for ever: from one state to the next it is expanded later, or the
// action is explored (after the proviso of Bosnacki and Holzmann 2005 for searches breadth first; it needs no order).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "states/store.hpp"
#include "stubborn/stubborn_sets.hpp"
#include "symbolic/zone_graph.hpp"

namespace tachk::stubborn {

class PartialOrder final {
 public:
  PartialOrder(symbolic::ZoneGraph& graph, bool wanted);

  // A state is going to be expanded, in as many parts as `next` says.
  void before_expand(std::uint32_t node, const symbolic::SymbolicState& source);
  // True if there is one more part to expand.
  bool next();
  // True if an action belongs to the part.
  bool admits(const symbolic::Edges& edges) const {
    return part_ == Part::all || (members_ >> process_of_[edges.front()] & 1) == (part_ == Part::members);
  }
  // An action of the part is possible, and then perhaps: what it leads to is in this node.
  void possible(zones::ConstZoneRef guarded, const symbolic::Effect& effect) {
    if (part_ == Part::members) sure_ = is_sure(guarded, effect);
  }
  void on_store(std::uint32_t node, const symbolic::Successor&) { leads_to(node); }
  void on_covered(std::uint32_t node) {
    if (node != states::no_node) leads_to(node);
  }
  // How many states have been expanded with some of their actions only.
  std::uint64_t reduced_states() const { return reduced_states_; }
  // True if it matters which node that is.
  bool needs_coverer() const { return part_ == Part::members && sure_; }

 private:
  enum class Part : std::uint8_t { none, members, others, all };

  void leads_to(std::uint32_t node) { goes_on_ = goes_on_ || (needs_coverer() && !puts_off(node)); }
  // True if every valuation of the source can take the action.
  bool is_sure(zones::ConstZoneRef guarded, const symbolic::Effect& effect);

  symbolic::ZoneGraph& graph_;
  // True if a node has been expanded with some of its actions only.
  bool puts_off(std::uint32_t node) const { return node < reduced_.size() && reduced_[node]; }

  StubbornSets sets_;
  std::vector<bool> reduced_;  // of each node
  std::uint64_t reduced_states_ = 0;
  std::uint32_t node_ = 0;
  std::vector<std::uint8_t> process_of_;  // of each edge
  const symbolic::SymbolicState* source_ = nullptr;
  StubbornSets::Members members_ = 0;
  Part part_ = Part::all;
  bool sure_ = false;
  bool goes_on_ = false;  // a sure action has led to a new state
  std::vector<zones::Atom> atoms_;
};

}  // namespace tachk::stubborn
