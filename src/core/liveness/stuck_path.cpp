#include "liveness/stuck_path.hpp"

#include <algorithm>
#include <vector>

namespace tachk::liveness {

using machine::ModelFault;
using symbolic::ConstantOverflow;
using symbolic::Edges;
using symbolic::Effect;
using symbolic::Successor;
using symbolic::SymbolicState;
using zones::Atom;
using zones::ConstZoneRef;

namespace {

// Keeps the successors by one action, within the restriction, or the initial states where no action has been taken yet.
struct RestrictedSuccessors {
  const symbolic::ZoneGraph& graph;
  Restriction* restriction;  // none where q may hold
  const Edges* edges;
  std::vector<SymbolicState>& states;

  void possible(ConstZoneRef, const Effect&) const {}
  void expect(const Effect&) const {}
  bool enters(const Successor& entry, const std::vector<Atom>& invariant) const {
    if (edges != nullptr && !std::equal(entry.edges.begin(), entry.edges.end(), edges->begin(), edges->end()))
      return false;
    return restriction == nullptr ||
           restriction->lets_through(entry, invariant, [this](const Successor& part) { take(part); });
  }
  bool wants(const Successor&) const { return true; }
  void take(const Successor& successor) const { states.push_back(graph.copy(successor)); }
};

// Wants no successors, only to know whether there are any.
struct Probing {
  Ends& ends;

  void possible(ConstZoneRef guarded, const Effect& effect) const { ends.pass(guarded, effect); }
  void expect(const Effect&) const {}
  bool wants(const Successor&) const { return false; }
  void take(const Successor&) const {}
};

}  // namespace

bool gets_stuck(symbolic::ZoneGraph& graph, Restriction& restriction, Ends& ends, Predicate* beginning,
                const symbolic::Path& actions, std::size_t begins) {
  std::vector<SymbolicState> states;
  try {
    graph.start(RestrictedSuccessors{graph, beginning != nullptr ? nullptr : &restriction, nullptr, states});
    for (std::size_t number = 0;; ++number) {
      if (beginning != nullptr && number == begins) {
        std::vector<SymbolicState> parts_of_all;
        for (SymbolicState& state : states)
          restriction.beginnings(*beginning, state,
                                 [&](const Successor& part) { parts_of_all.push_back(graph.copy(part)); });
        states.swap(parts_of_all);
      }
      if (number == actions.size()) break;
      Restriction* restricted = number >= begins ? &restriction : nullptr;
      std::vector<SymbolicState> next;
      for (SymbolicState& state : states)
        graph.expand(state, RestrictedSuccessors{graph, restricted, &actions[number], next});
      states.swap(next);
    }
    for (SymbolicState& state : states) {
      ends.begin(state, restriction.avoided());
      graph.expand(state, Probing{ends});
      if (ends.end()) return true;
    }
  } catch (const ModelFault&) {
  } catch (const ConstantOverflow&) {
  }
  return false;
}

}  // namespace tachk::liveness
