// The search: goes through the zone graph of a program, stores every state that no stored one contains, and stops when
// each goal is reached or nothing is left.
//
// The loop takes the next waiting state, expands it, and stores its successors. What surrounds it has a class each: the
// order (Waiting), what is looked for (GoalWatch, DeadlockWatch), the graph itself
// (ZoneGraph) and the store (PassedList). Another algorithm is another loop over the same parts.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "order/waiting.hpp"
#include "program/program.hpp"
#include "reachability/deadlock_watch.hpp"
#include "reachability/goals.hpp"
#include "reachability/measures.hpp"
#include "reachability/merging/corridor.hpp"
#include "reachability/merging/merging.hpp"
#include "reachability/options.hpp"
#include "states/adaptive_check.hpp"
#include "states/store.hpp"
#include "stubborn/partial_order.hpp"
#include "symbolic/zone_graph.hpp"
#include "zones/patience.hpp"

namespace tachk::reachability {

enum class Status {
  running,
  finished,  // every goal is reached or has failed, or there is nothing left to explore
  state_limit,
  memory_limit,
  depth_limit,     // finished, but some states were too deep to be explored
  fault,           // the model has a run-time error
  time_limit,      // given up in the midst of a state: this search cannot go on
  constant_limit,  // without extrapolation: clock values beyond what a bound can hold
};

struct Statistics {
  std::uint64_t explored = 0;
  std::uint64_t stored = 0;
  std::uint64_t transitions = 0;
  std::uint64_t bytes = 0;
};

struct FaultReport {
  machine::FaultKind kind;
  std::int32_t position;  // of the code word
  std::uint32_t node;     // the last stored state before it; no_node for the initial state
  symbolic::Edges edges;  // of the action; empty for a guard, an invariant of the initial state or what is measured
};

class Explorer final {
 public:
  Explorer(program::Program program, const Options& options, const Limits& limits = {});
  Explorer(const Explorer&) = delete;
  Explorer& operator=(const Explorer&) = delete;

  // Explores at most `expansions` states. `running` asks for another call. Throws GivenUp.
  Status run(std::uint64_t expansions);

  const program::Program& program() const { return graph_.program(); }
  const zones::ZoneOperations& operations() const { return graph_.operations(); }
  Statistics statistics() const;
  // How many discrete states have been seen.
  std::uint32_t discrete_states() const { return passed_.discrete_states(); }
  bool has_merged() const { return merging_.any(); }
  // How many states have been expanded with some of their actions only.
  std::uint64_t reduced_states() const { return partial_order_.reduced_states(); }
  // The node in which a goal was reached first.
  std::optional<std::uint32_t> reached(std::size_t goal) const;
  // The extreme value of a measure among the states stored so far.
  std::optional<Extreme> extreme(std::size_t measure) const { return measures_.extreme(measure); }
  const std::optional<FaultReport>& fault() const { return fault_; }
  // The fault there is, with the names of processes that belong to a path to its node.
  FaultReport told_fault(symbolic::Path& path);
  // The edges that some action of an explored state has taken, in ascending order. Where the search has gone through
  // everything, no other edge can be taken at all.
  std::vector<std::uint32_t> taken() const;
  // The actions that lead from the initial state to a node. Not where states have been united.
  symbolic::Path path(std::uint32_t node);
  // The run-time error in a predicate of a goal, which is not looked for since.
  const std::optional<GoalFailure>& failure(std::size_t goal) const { return goals_.failure(goal); }
  bool any_failure() const { return goals_.any_failure(); }
  // Actions that lead from the initial state to where a goal has been reached or has failed.
  symbolic::Path path_to_goal(std::size_t goal);
  // Whether these actions, taken one after the other from the initial state, can end in a goal. Asked of an explorer
  // without extrapolation that has not run; false also if clock values become too large on the way.
  bool leads_to(const symbolic::Path& actions, std::size_t goal);

 private:
  struct Storing;
  // What has been done so far.
  struct Work {
    bool started = false;
    zones::InPieces pieces = {};
    bool is_full = false;  // the limit on memory was met in the midst of a state
    std::uint64_t explored = 0;
    std::uint64_t transitions = 0;
    std::vector<std::uint8_t> taken;   // of each edge, whether it has been
    states::AdaptiveCheck simulation;  // of states by others
  };

  Status search(std::uint64_t expansions);
  Status search_keeping_faults(std::uint64_t expansions);
  std::uint32_t next();
  void expand(std::uint32_t node);
  bool needs_too_much_memory() const;
  bool covers(std::uint32_t discrete, const symbolic::Successor& successor);
  bool simulates(std::uint32_t discrete, const symbolic::Successor& successor);
  void store(const symbolic::Successor& successor, std::uint32_t discrete);
  void enlist(std::uint32_t number, std::uint32_t parent, const symbolic::Successor& successor);
  void note_coverer(std::uint32_t discrete, const symbolic::Successor& successor);
  bool keeps_layers(std::uint32_t node);
  // The node in which a goal was reached or failed; no_node for an open one.
  std::uint32_t settled_in(std::size_t goal) const;
  // A search through the discrete states that lead to a node, which unites none.
  std::unique_ptr<Explorer> among_origins(std::uint32_t node, program::Program program);

  Options options_;
  Limits limits_;
  symbolic::ZoneGraph graph_;
  states::PassedList passed_;
  order::Waiting waiting_;
  order::Layers layers_;
  GoalWatch goals_;
  DeadlockWatch deadlocks_;
  MeasureWatch measures_;
  stubborn::PartialOrder partial_order_;
  merging::Merging merging_;
  std::unique_ptr<merging::Corridor> corridor_;  // null: all discrete states
  symbolic::SymbolicState source_;        // that is being expanded; a copy, because its node may be covered meanwhile
  std::uint32_t node_ = states::no_node;  // its number
  Work work_;
  std::optional<FaultReport> fault_;
};

}  // namespace tachk::reachability
