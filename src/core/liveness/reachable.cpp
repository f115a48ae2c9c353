#include "liveness/reachable.hpp"

#include <utility>

namespace tachk::liveness {

using states::no_node;
using symbolic::Successor;

Reachable::Reachable(symbolic::ZoneGraph& graph, Restriction* restriction, const reachability::Options& options,
                     const reachability::Limits& limits)
    : graph_(graph),
      restriction_(restriction),
      subsumption_(options.subsumption),
      passed_(graph.program(), graph.operations(), options, graph.smaller_operations()),
      waiting_(order::SearchOrder::breadth_first, options.seed, limits.depth) {}

struct Reachable::Storing {
  Reachable& search;
  std::uint32_t discrete = 0;

  void possible(zones::ConstZoneRef guarded, const symbolic::Effect& effect) const {
    if (search.recorded_) search.recorded_->ends.pass(guarded, effect);
  }
  void expect(const symbolic::Effect& effect) const { search.passed_.announce(effect.slots.data(), effect.written); }
  bool enters(const Successor& entry, const std::vector<zones::Atom>& invariant) {
    search.transitions_ += !entry.edges.empty();
    return search.restriction_ == nullptr ||
           search.restriction_->lets_through(entry, invariant, [this](const Successor& part) {
             search.passed_.announce(part.slots, program::SlotSet::all());
             discrete = search.passed_.locate();
             take(part);
           });
  }
  bool wants(const Successor& successor) {
    discrete = search.passed_.locate();
    if (!search.subsumption_) return true;
    const std::uint32_t by = search.passed_.coverer(discrete, search.graph_.packed(successor.slots, successor.zone));
    if (by != no_node && search.recorded_) search.recorded_->steps.add(by);
    return by == no_node;
  }
  void take(const Successor& successor) const {
    const states::ZoneView zone = search.graph_.packed(successor.slots, successor.zone);
    const std::uint32_t number = search.passed_.add(discrete, zone, search.node_, search.subsumption_);
    if (number != no_node) search.waiting_.add(number, search.node_, successor.slots, search.passed_.covered_last());
    if (!search.recorded_) return;
    CoveringSteps& steps = search.recorded_->steps;
    steps.add(number != no_node ? number : search.passed_.coverer(discrete, zone));
    if (number == no_node) return;
    for (const std::uint32_t covered : search.passed_.covered_last()) steps.cover(covered, number);
  }
};

bool Reachable::advance(symbolic::SymbolicState& source) {
  if (!std::exchange(started_, true)) {
    if (recorded_) recorded_->steps.begin(no_node);
    graph_.start(Storing{*this});
    if (recorded_) recorded_->steps.end();
  }
  std::uint32_t number = waiting_.next();
  while (number != no_node && (passed_.covered(number) || !waiting_.admits(number))) number = waiting_.next();
  if (number == no_node) return false;
  node_ = number;
  passed_.unpack(number, source.slots.data());
  graph_.unpack(passed_, number, source);
  ++explored_;
  expand(source);
  return true;
}

void Reachable::expand(symbolic::SymbolicState& source) {
  if (recorded_) {
    recorded_->steps.begin(node_);
    recorded_->ends.begin(source, restriction_->avoided());
  }
  graph_.expand(source, Storing{*this});
  if (!recorded_) return;
  recorded_->may_end |= recorded_->ends.end().has_value();
  recorded_->steps.end();
}

}  // namespace tachk::liveness
