#include "reachability/covering_store.hpp"

namespace tachk::reachability {

using program::Program;
using states::no_node;
using symbolic::Successor;
using zones::ClockBounds;

namespace {

// True if a state that simulates another one stands for it: no goal depends on an action being
// impossible, or on how long clocks have run.
bool depends_on_actions_only(const Program& program) {
  if (!program.measures.empty()) return false;
  for (const program::Goal& goal : program.goals)
    for (const program::Disjunct& disjunct : goal.disjuncts)
      if (disjunct.deadlock != program::DeadlockLiteral::absent) return false;
  return true;
}

}  // namespace

CoveringStore::CoveringStore(symbolic::ZoneGraph& graph, const Options& options)
    : graph_(graph),
      subsumption_(options.subsumption),
      is_divided_(!graph.program().diagonals.empty()),
      states_(graph.program(), graph.operations(), options, graph.smaller_operations()),
      merging_(options.merging, graph.operations()),
      simulation_(options.alu && options.subsumption && graph.knows_simulation() &&
                  depends_on_actions_only(graph.program())) {}

bool CoveringStore::covers(const Successor& successor) {
  if (!subsumption_) return false;
  return states_.covers(discrete_, graph_.packed(successor.slots, successor.zone)) || simulates(successor);
}

bool CoveringStore::simulates(const Successor& successor) {
  if (!simulation_.is_due()) return false;
  const std::size_t others = states_.count(discrete_);
  if (others == 0) return false;
  const ClockBounds bounds = graph_.bounds(successor.slots);
  const bool simulated = states_.covers(discrete_, graph_.packed(successor.slots, successor.zone), &bounds);
  simulation_.record(simulated, others);
  return simulated;
}

std::uint32_t CoveringStore::coverer(const Successor& successor) const {
  return states_.coverer(discrete_, graph_.packed(successor.slots, successor.zone));
}

std::uint32_t CoveringStore::add(const Successor& successor, std::uint32_t parent, std::uint32_t first_untouched) {
  const states::ZoneView zone = graph_.packed(successor.slots, successor.zone);
  const states::ZoneView merged = merging_.merged(states_, discrete_, zone, first_untouched);
  const ClockBounds bounds = simulation_.is_active() ? graph_.bounds(successor.slots) : ClockBounds{};
  const ClockBounds* const simulating = simulation_.is_active() ? &bounds : nullptr;
  const std::uint32_t number = subsumption_ && !is_divided_
                                   ? states_.add_uncovered(discrete_, merged, parent, simulating)
                                   : states_.add(discrete_, merged, parent, subsumption_, simulating);
  if (number != no_node) merging_.stored(number);
  return number;
}

}  // namespace tachk::reachability
