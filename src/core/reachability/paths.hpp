// Ways that have been gone, gone again: states are stored without the actions that led to them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "reachability/deadlock_watch.hpp"
#include "reachability/goals.hpp"
#include "states/store.hpp"
#include "symbolic/zone_graph.hpp"

namespace tachk::reachability {

// The actions that lead from the initial state to a node, found from one node of the chain of its parents to the next.
// If states have interchangeable processes sorted, the actions are those of a run in which no process ever
// changes its place. `last`: gets the state at the end of that run.
symbolic::Path path_to(symbolic::ZoneGraph& graph, states::PassedList& passed, std::uint32_t node,
                       symbolic::SymbolicState* last = nullptr);

// The run-time error in an action of a state.
std::optional<symbolic::ActionFault> fault_after(symbolic::ZoneGraph& graph, symbolic::SymbolicState& state);

// The states to which these actions lead, one after the other, from the initial state.
std::vector<symbolic::SymbolicState> states_after(symbolic::ZoneGraph& graph, const symbolic::Path& actions);

// True if these actions, taken one after the other from the initial state, can end in a goal. For a graph without
// extrapolation and of goals that no state has been shown to; false also if clock values become too large on the way.
bool leads_to(symbolic::ZoneGraph& graph, GoalWatch& goals, DeadlockWatch& deadlocks, const symbolic::Path& actions,
              std::size_t goal);

}  // namespace tachk::reachability
