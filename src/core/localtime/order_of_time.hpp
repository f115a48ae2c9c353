// Runs over local times as runs of the network: independent actions come in the order of time.
#pragma once

#include <optional>

#include "localtime/agents.hpp"
#include "program/program.hpp"
#include "symbolic/successor.hpp"

namespace tachk::localtime {

// The actions of a run over local times, in an order in which they happen in a run of the network that ends where the
// condition holds. None if no times are right for them. Throws ModelFault.
//
// The times of the actions are the unknowns of difference constraints: of guards and invariants, and of actions of the
// same agent. They have a solution iff the run exists (Bellman, Ford), and each solution gives an order.
std::optional<symbolic::Path> in_order_of_time(symbolic::Semantics& semantics, const Agents& agents,
                                               const symbolic::Path& actions, const program::Condition& end);

}  // namespace tachk::localtime
