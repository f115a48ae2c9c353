#include "localtime/local_graph.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace tachk::localtime {

using reachability::Options;

namespace {

// The synchronised part of a zone is not abstracted, so its entries may be larger than the constants.
Options widened(Options options) {
  if (options.width == zones::Width::narrow) options.width = zones::Width::wide;
  return options;
}

Agents checked(Agents agents, const Options& options) {
  if (agents.obstacle != nullptr) throw std::invalid_argument(agents.obstacle);
  if (options.extrapolation == symbolic::Extrapolation::none) throw std::invalid_argument("zones are not extrapolated");
  return agents;
}

}  // namespace

LocalGraph::LocalGraph(program::Program program, const Options& options)
    : ordinary_(std::move(program), widened(options)),
      agents_(checked(find_agents(ordinary_.program()), options)),
      zones_(agents_.count, agents_.of_clock),
      symmetry_(ordinary_.representatives(), ordinary_.program(), agents_, zones_),
      anything_(ordinary_.operations()),
      target_(zones_.size()),
      synchronised_(ordinary_.operations()) {
  const zones::ZoneOperations& operations = ordinary_.operations();
  const int dimension = ordinary_.program().dimension();
  clocks_.resize(static_cast<std::size_t>(dimension) * static_cast<std::size_t>(dimension));
  const zones::BoundRowBuffer unbounded(operations, dimension);
  operations.make_zero(anything_.get(), dimension);
  operations.extrapolate_lu_plus(anything_.get(), dimension, unbounded.get(), unbounded.get());
}

bool LocalGraph::begin() {
  effect_ = {};
  for (const program::Slot& slot : program().slots) effect_.slots.push_back(slot.initial);
  effect_.written = program::SlotSet::all();
  if (!ordinary_.semantics().invariant(effect_.slots.data(), effect_.invariant)) return false;
  zones_.make_zero(target_.data());
  effect_.resets = program().starts;
  met_.resize(agents_.count);
  std::iota(met_.begin(), met_.end(), 0U);
  return enter();
}

bool LocalGraph::fire(const symbolic::Action& action) {
  met_.clear();
  for (const std::uint32_t edge : action.edges)
    met_.insert(met_.end(), agents_.of_edge[edge].begin(), agents_.of_edge[edge].end());
  std::sort(met_.begin(), met_.end());
  met_.erase(std::unique(met_.begin(), met_.end()), met_.end());
  return zones_.meet(target_.data(), met_) && constrain(action.guard);
}

bool LocalGraph::enter() {
  for (const zones::ClockReset& reset : effect_.resets) zones_.reset(target_.data(), reset);
  if (!constrain(effect_.invariant)) return false;
  const std::size_t processes = program().processes.size();
  for (const std::uint32_t agent : met_)
    if (agent >= processes || !ordinary_.semantics().location(agent, effect_.slots.data()).urgent)
      zones_.elapse(target_.data(), agent);
  if (!constrain(effect_.invariant)) return false;
  if (!zones_.is_legal(target_.data())) throw symbolic::ConstantOverflow{};
  return true;
}

bool LocalGraph::constrain(std::span<const zones::Atom> atoms) {
  return std::all_of(atoms.begin(), atoms.end(),
                     [&](const zones::Atom& atom) { return zones_.constrain(target_.data(), atom); });
}

bool LocalGraph::synchronise() {
  if (!zones_.synchronised(target_.data(), clocks_.data())) return false;
  ordinary_.operations().assign(synchronised_.get(), program().dimension(), clocks_.data());
  return true;
}

}  // namespace tachk::localtime
