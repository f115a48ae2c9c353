#include "liveness/nested_search.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace tachk::liveness {

using machine::ModelFault;
using states::no_node;
using symbolic::ConstantOverflow;
using symbolic::Edges;
using symbolic::Effect;
using symbolic::Path;
using symbolic::Successor;
using zones::Atom;
using zones::ConstZoneRef;

NestedSearch::NestedSearch(symbolic::ZoneGraph& graph, Restriction& restriction, Ends& ends,
                           const reachability::Options& options, std::uint32_t depth_limit)
    : graph_(graph),
      restriction_(restriction),
      ends_(ends),
      subsumption_(options.subsumption),
      depth_limit_(depth_limit),
      passed_(graph.program(), graph.operations(), options, graph.smaller_operations()),
      stack_(graph),
      source_(graph.blank()) {}

// Pushes the successors that are neither covered nor close a loop.
struct NestedSearch::Descending {
  NestedSearch& search;

  void possible(ConstZoneRef guarded, const Effect& effect) const { search.ends_.pass(guarded, effect); }
  void expect(const Effect& effect) const { search.passed_.announce(effect.slots.data(), effect.written); }
  bool enters(const Successor& entry, const std::vector<Atom>& invariant) const {
    search.transitions_ += !entry.edges.empty();
    try {
      return search.restriction_.lets_through(entry, invariant,
                                              [this](const Successor& part) { search.push_sorted(part); });
    } catch (const ModelFault& fault) {  // of the new state, not of the action that leads there
      throw StateFault(fault, entry.edges);
    }
  }
  bool wants(const Successor& successor) const {
    const std::uint32_t discrete = search.passed_.locate();
    if (discrete >= search.known_) return false;
    return !search.subsumption_ ||
           !search.passed_.covers(discrete, search.graph_.packed(successor.slots, successor.zone));
  }
  void take(const Successor& successor) const { search.push(successor); }
};

void NestedSearch::start() { graph_.start(Descending{*this}); }

void NestedSearch::start_in(symbolic::SymbolicState& state, Predicate& begins) {
  restriction_.beginnings(begins, state, [&](const Successor& part) { push_sorted(part); });
}

void NestedSearch::know(const std::int32_t* slots) {
  passed_.announce(slots, program::SlotSet::all());
  passed_.locate();
  known_ = passed_.discrete_states();
}

void NestedSearch::start_among_known(symbolic::SymbolicState& state) {
  restriction_.remaining(state, [&](const Successor& part) { push_sorted(part); });
}

void NestedSearch::advance() {
  const SearchStack::State top = stack_.top();
  if (top.open) {
    passed_.add(top.discrete, stack_.top_zone(), no_node, subsumption_);
    stack_.pop();
  } else if (passed_.contains(top.discrete, stack_.top_zone(), subsumption_)) {
    stack_.pop();
  } else if (stack_.depth() >= depth_limit_) {
    complete_ = false;
    stack_.pop();
  } else {
    expand();
  }
}

void NestedSearch::expand() {
  stack_.open_top();
  unpack(stack_.size() - 1);
  ++explored_;
  ends_.begin(source_, restriction_.avoided());
  graph_.expand(source_, Descending{*this});
  const std::optional<EndKind> ending = ends_.end();
  if (ending == EndKind::idle)
    found_ = ViolationKind::idle;
  else if (closing_)
    found_ = ViolationKind::loop;
  else if (ending == EndKind::stuck)
    found_ = ViolationKind::stuck;
}

void NestedSearch::push_sorted(const Successor& part) {
  passed_.announce(part.slots, program::SlotSet::all());
  push(part);
}

void NestedSearch::push(const Successor& successor) {
  if (closing_) return;
  const std::uint32_t discrete = passed_.locate();
  if (discrete >= known_) return;
  const states::ZoneView zone = graph_.packed(successor.slots, successor.zone);
  if (passed_.contains(discrete, zone, subsumption_)) return;
  const std::uint32_t open = stack_.find_below(discrete, zone, subsumption_);
  if (open == no_node) return stack_.push(discrete, zone);
  closing_ = Closing{open, {successor.edges.begin(), successor.edges.end()}};
}

void NestedSearch::unpack(std::uint32_t number) {
  const SearchStack::State& state = stack_[number];
  passed_.unpack_discrete(state.discrete, source_.slots.data());
  graph_.unpack(source_.slots.data(), stack_.zone(number).data, source_.zone);
}

// ---- the path -------------------------------------------------------------------------------------------------------

// Looks for the action by which one open state led to another one.
struct NestedSearch::Finding {
  NestedSearch& search;
  std::uint32_t sought;
  Edges& edges;

  void possible(ConstZoneRef, const Effect&) const {}
  void expect(const Effect& effect) const { search.passed_.announce(effect.slots.data(), program::SlotSet::all()); }
  bool enters(const Successor& entry, const std::vector<Atom>& invariant) const {
    return edges.empty() && search.restriction_.lets_through(entry, invariant, [this](const Successor& part) {
      search.passed_.announce(part.slots, program::SlotSet::all());
      take(part);
    });
  }
  bool wants(const Successor&) const { return search.passed_.locate() == search.stack_[sought].discrete; }
  void take(const Successor& successor) const {
    if (!edges.empty() || !wants(successor)) return;
    const states::ZoneView zone = search.graph_.packed(successor.slots, successor.zone);
    if (search.stack_.holds(sought, zone)) edges.assign(successor.edges.begin(), successor.edges.end());
  }
};

Edges NestedSearch::edges_between(std::uint32_t from, std::uint32_t to) {
  Edges edges;
  unpack(from);
  try {
    graph_.expand(source_, Finding{*this, to, edges});
  } catch (const ModelFault&) {
    // The search stopped at this fault, in an action behind the one looked for.
  } catch (const ConstantOverflow&) {
    // As above.
  }
  if (edges.empty()) throw std::logic_error("an open state is not a successor of the one below it");
  return edges;
}

Path NestedSearch::path() {
  Path path;
  const std::vector<std::uint32_t> open = stack_.path();
  for (std::size_t number = 1; number < open.size(); ++number)
    path.push_back(edges_between(open[number - 1], open[number]));
  return path;
}

Violation NestedSearch::violation(const Path& stem) {
  Violation violation{*found_, stem, stem.size(), {}};
  Path path = this->path();
  if (*found_ == ViolationKind::loop) {
    const std::vector<std::uint32_t> open = stack_.path();
    const auto entrance = path.begin() + (std::find(open.begin(), open.end(), closing_->state) - open.begin());
    violation.loop.assign(entrance, path.end());
    violation.loop.push_back(closing_->edges);
    path.erase(entrance, path.end());
  }
  violation.stem.insert(violation.stem.end(), path.begin(), path.end());
  return violation;
}

}  // namespace tachk::liveness
