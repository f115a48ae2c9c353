#include "stubborn/partial_order.hpp"

#include <algorithm>
#include <utility>

namespace tachk::stubborn {

PartialOrder::PartialOrder(symbolic::ZoneGraph& graph, bool wanted)
    : graph_(graph), sets_(graph.program(), graph.semantics(), graph.operations(), wanted) {
  for (const program::Edge& edge : graph.program().edges)
    process_of_.push_back(static_cast<std::uint8_t>(edge.process));
}

void PartialOrder::before_expand(std::uint32_t node, const symbolic::SymbolicState& source) {
  node_ = node;
  source_ = &source;
  members_ = sets_.enough(source.slots.data(), source.zone.get());
  part_ = Part::none;
  goes_on_ = sure_ = false;
}

bool PartialOrder::next() {
  switch (part_) {
    case Part::none:
      part_ = members_ == 0 ? Part::all : Part::members;
      if (members_ == 0) return true;
      if (reduced_.size() <= node_) reduced_.resize(std::size_t{node_} + 1, false);
      reduced_[node_] = true;
      return true;
    case Part::members:
      part_ = goes_on_ ? Part::all : Part::others;
      reduced_states_ += goes_on_;
      if (goes_on_) return false;
      reduced_[node_] = false;
      return true;
    case Part::others:
    case Part::all:
      part_ = Part::all;
      return false;
  }
  return false;
}

bool PartialOrder::is_sure(zones::ConstZoneRef guarded, const symbolic::Effect& effect) {
  const zones::ConstZoneRef zone = source_->zone.get();
  const int dimension = graph_.program().dimension();
  const zones::ZoneOperations& operations = graph_.operations();
  if (!operations.includes(guarded, zone, dimension)) return false;
  atoms_.clear();
  return graph_.semantics().weakest_precondition(effect, atoms_) &&
         std::all_of(atoms_.begin(), atoms_.end(), [&](const zones::Atom& atom) {
           return operations.entry(zone, dimension, atom.left, atom.right) <= atom.raw;
         });
}

}  // namespace tachk::stubborn
