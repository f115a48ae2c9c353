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

  void possible(zones::ConstZoneRef, const symbolic::Effect&) const {}
  void expect(const symbolic::Effect& effect) const { search.passed_.announce(effect.slots.data(), effect.written); }
  bool enters(const Successor& entry, const std::vector<zones::Atom>& invariant) {
    search.transitions_ += !entry.edges.empty();
    return search.restriction_ == nullptr ||
           search.restriction_->lets_through(entry, invariant, [this](const Successor& part) {
             discrete = search.passed_.locate();
             take(part);
           });
  }
  bool wants(const Successor& successor) {
    discrete = search.passed_.locate();
    return !search.subsumption_ ||
           !search.passed_.covers(discrete, search.graph_.packed(successor.slots, successor.zone));
  }
  void take(const Successor& successor) const {
    const states::ZoneView zone = search.graph_.packed(successor.slots, successor.zone);
    const std::uint32_t number = search.passed_.add(discrete, zone, search.node_, search.subsumption_);
    if (number != no_node) search.waiting_.add(number, search.node_, successor.slots, search.passed_.covered_last());
  }
};

bool Reachable::advance(symbolic::SymbolicState& source) {
  if (!std::exchange(started_, true)) graph_.start(Storing{*this});
  std::uint32_t number = waiting_.next();
  while (number != no_node && (passed_.covered(number) || !waiting_.admits(number))) number = waiting_.next();
  if (number == no_node) return false;
  node_ = number;
  passed_.unpack(number, source.slots.data());
  graph_.unpack(passed_, number, source);
  ++explored_;
  graph_.expand(source, Storing{*this});
  return true;
}

}  // namespace tachk::liveness
