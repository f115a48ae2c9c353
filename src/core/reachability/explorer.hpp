// The search: goes through the zone graph of a program, stores every state that no stored one contains, and stops when
// each goal is reached or nothing is left.
//
// The loop takes the next waiting state (Waiting), expands it (ZoneGraph), and stores its successors (CoveringStore).
// All else observes it (Observers): what is looked for, measured and counted, the orders of actions that are left out,
// and the states among which it stays. Another algorithm is another loop over the same parts.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "order/waiting.hpp"
#include "program/program.hpp"
#include "reachability/covering_store.hpp"
#include "reachability/deadlock_watch.hpp"
#include "reachability/goals.hpp"
#include "reachability/measures.hpp"
#include "reachability/merging/path_filter.hpp"
#include "reachability/observers.hpp"
#include "reachability/options.hpp"
#include "reachability/pruning/lost_states.hpp"
#include "reachability/taken_edges.hpp"
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

class Explorer final {
 public:
  Explorer(program::Program program, const Options& options, const Limits& limits = {});
  Explorer(const Explorer&) = delete;
  Explorer& operator=(const Explorer&) = delete;

  // Lets the search begin where these actions lead to, as do all paths then. Call it before `run`. False if they lead
  // nowhere, or something goes wrong on the way. Not where processes are interchangeable.
  bool begin_after(const symbolic::Path& actions);
  // Explores at most `expansions` states. `running` asks for another call. Throws GivenUp.
  Status run(std::uint64_t expansions);

  const program::Program& program() const { return graph_.program(); }
  const zones::ZoneOperations& operations() const { return graph_.operations(); }
  Statistics statistics() const;
  // A measure of the work done so far that does not depend on the machine: about so many states of a small network
  // would have taken as long.
  std::uint64_t effort() const;
  // How many discrete states have been seen.
  std::uint32_t discrete_states() const { return store_.states().discrete_states(); }
  bool has_merged() const { return store_.merging().any(); }
  // How many states have been expanded with some of their actions only.
  std::uint64_t reduced_states() const { return parts_.partial_order.reduced_states(); }
  // How many successors have been dropped because no goal can be reached from them.
  std::uint64_t lost() const { return parts_.lost.lost(); }
  // The node in which a goal was reached first.
  std::optional<std::uint32_t> reached(std::size_t goal) const;
  // The extreme value of a measure among the states stored so far.
  std::optional<Extreme> extreme(std::size_t measure) const { return parts_.measures.extreme(measure); }
  const std::optional<FaultReport>& fault() const { return fault_; }
  // The fault there is, with the names of processes that belong to a path to its node.
  FaultReport fault_report(symbolic::Path& path);
  // The edges that some action of an explored state has taken, in ascending order. Where the search has gone through
  // everything, no other edge can be taken at all.
  std::vector<std::uint32_t> taken() const { return parts_.taken.edges(); }
  // The actions that lead from the initial state to a node. Not where states have been merged.
  symbolic::Path path(std::uint32_t node);
  // The run-time error in a predicate of a goal, which is not looked for since.
  const std::optional<GoalFailure>& failure(std::size_t goal) const { return parts_.goals.failure(goal); }
  bool any_failure() const { return parts_.goals.any_failure(); }
  // Actions from the initial state on, the last of which takes an edge that has been taken. Not where processes are
  // interchangeable.
  symbolic::Path path_to_edge(std::size_t edge);
  // Actions that lead from the initial state to where a goal has been reached or has failed.
  symbolic::Path path_to_goal(std::size_t goal);
  // True if these actions, taken one after the other from the initial state, can end in a goal. For an explorer
  // without extrapolation that has not run; false also if clock values become too large on the way.
  bool leads_to(const symbolic::Path& actions, std::size_t goal);

 private:
  struct Storing;
  // The observers of the loop.
  struct Parts {
    TakenEdges taken;
    merging::PathFilter path_filter;
    stubborn::PartialOrder partial_order;
    GoalWatch goals;
    DeadlockWatch deadlocks;
    MeasureWatch measures;
    pruning::LostStates lost;
    Observers<TakenEdges, merging::PathFilter, stubborn::PartialOrder, GoalWatch, DeadlockWatch, MeasureWatch,
              pruning::LostStates>
        all{taken, path_filter, partial_order, goals, deadlocks, measures, lost};

    Parts(symbolic::ZoneGraph& graph, const Options& options);
  };
  // The work done so far.
  struct Work {
    bool started = false;
    zones::InPieces pieces = {};
    bool is_full = false;  // the limit on memory was met in the midst of a state
    std::uint64_t explored = 0;
  };

  Status search(std::uint64_t expansions);
  Status search_keeping_faults(std::uint64_t expansions);
  std::uint32_t next();
  void expand(std::uint32_t node);
  void close();
  bool needs_too_much_memory() const;
  void store(const symbolic::Successor& successor);
  bool keeps_layers(std::uint32_t node);
  // The node in which a goal was reached or failed; no_node for an open one.
  std::uint32_t settled_in(std::size_t goal) const;
  // A search through the discrete states that lead to a node, which merges none.
  std::unique_ptr<Explorer> among_origins(std::uint32_t node, program::Program program);

  Options options_;
  Limits limits_;
  symbolic::ZoneGraph graph_;
  CoveringStore store_;
  order::Waiting waiting_;
  order::Layers layers_;
  Parts parts_;
  symbolic::SymbolicState source_;        // that is being expanded; a copy, because its node may be covered meanwhile
  std::uint32_t node_ = states::no_node;  // its number
  Work work_;
  std::optional<FaultReport> fault_;
};

}  // namespace tachk::reachability
