// The parts of a search beside the graph, the store and the order: observers of the loop. An observer
// has those of these calls that it needs; the loop makes each of them for all observers, in their order.
//   before_expand(node, source)     a stored state is going to be expanded; `source` stays as it is until it has been
//   on_successor(successor)         a step leads to this state, whose zone is not abstracted; false: it is dropped
//   on_store(node, successor)       a new state has been stored, with its zone abstracted
// Observers that have to know actions, not states only, have some of these as well (see Receiver in zone_graph.hpp):
//   counts()                        whether the observer needs `possible` for every action, also for those that differ
//                                   from another one by a permutation of interchangeable processes only
//   admits(edges)                   whether an action is followed at all
//   possible(guarded, effect)       an action is possible
//   on_covered(node)                what the last action leads to is part of a stored state
//   after_expand(node, source)
// All calls are resolved when the program is compiled: what an observer does not have costs nothing.
#pragma once

#include <cstdint>
#include <tuple>

#include "symbolic/zone_graph.hpp"

namespace tachk::reachability {

// A run-time error that ends a search.
struct FaultReport {
  machine::FaultKind kind;
  std::int32_t position;  // of the code word
  std::uint32_t node;     // the last stored state before it; no_node for the initial state
  symbolic::Edges edges;  // of the action; empty for a guard, an invariant of the initial state or what is measured
};

template <class... Parts>
class Observers final {
 public:
  explicit Observers(Parts&... parts) : parts_(parts...) {}

  void before_expand(std::uint32_t node, symbolic::SymbolicState& source) {
    each([&](auto& part) {
      if constexpr (requires { part.before_expand(node, source); }) part.before_expand(node, source);
    });
  }
  void after_expand(std::uint32_t node, symbolic::SymbolicState& source) {
    each([&](auto& part) {
      if constexpr (requires { part.after_expand(node, source); }) part.after_expand(node, source);
    });
  }
  bool counts() {
    return any([](auto& part) {
      if constexpr (requires { part.counts(); }) return part.counts();
      return false;
    });
  }
  bool admits(const symbolic::Edges& edges) {
    return !any([&](auto& part) {
      if constexpr (requires { part.admits(edges); }) return !part.admits(edges);
      return false;
    });
  }
  void possible(zones::ConstZoneRef guarded, const symbolic::Effect& effect) {
    each([&](auto& part) {
      if constexpr (requires { part.possible(guarded, effect); }) part.possible(guarded, effect);
    });
  }
  bool on_successor(const symbolic::Successor& successor) {
    return !any([&](auto& part) {
      if constexpr (requires { part.on_successor(successor); }) return !part.on_successor(successor);
      return false;
    });
  }
  // `coverer()` gives the node; it is called only if an observer wants to know.
  template <class Coverer>
  void on_covered(const Coverer& coverer) {
    each([&](auto& part) {
      if constexpr (requires { part.on_covered(std::uint32_t{}); })
        if (part.needs_coverer()) part.on_covered(coverer());
    });
  }
  void on_store(std::uint32_t node, const symbolic::Successor& successor) {
    each([&](auto& part) {
      if constexpr (requires { part.on_store(node, successor); }) part.on_store(node, successor);
    });
  }

 private:
  template <class Call>
  void each(const Call& call) {
    std::apply([&](Parts&... parts) { (call(parts), ...); }, parts_);
  }
  template <class Call>
  bool any(const Call& call) {
    return std::apply([&](Parts&... parts) { return (call(parts) || ...); }, parts_);
  }

  std::tuple<Parts&...> parts_;
};

}  // namespace tachk::reachability
