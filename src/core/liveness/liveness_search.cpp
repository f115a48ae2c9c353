#include "liveness/liveness_search.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "reachability/paths.hpp"

namespace tachk::liveness {

using machine::ModelFault;
using program::Goal;
using reachability::Status;
using states::no_node;
using symbolic::ConstantOverflow;
using symbolic::Edges;
using symbolic::Effect;
using symbolic::Path;
using symbolic::Successor;
using symbolic::SymbolicState;
using zones::Atom;
using zones::ConstZoneRef;

namespace {

bool asks_for_deadlock(const std::vector<Goal>& goals) {
  for (const Goal& goal : goals)
    for (const program::Disjunct& disjunct : goal.disjuncts)
      if (disjunct.deadlock != program::DeadlockLiteral::absent) return true;
  return false;
}

}  // namespace

LivenessSearch::LivenessSearch(program::Program program, const reachability::Options& options,
                               const reachability::Limits& limits)
    : options_(options),
      limits_(limits),
      graph_(std::move(program), options_),
      restriction_(graph_, graph_.program().goals.at(0)),
      ends_(graph_),
      overview_(overview()),
      passed_(graph_.program(), graph_.operations(), options_, graph_.smaller_operations()),
      stack_(graph_),
      source_(graph_.blank()),
      parts_(graph_) {}

LivenessSearch::Overview LivenessSearch::overview() {
  const std::vector<Goal>& goals = graph_.program().goals;
  // The short proof looks at predicates without the zones that `deadlock` needs.
  const bool proves = options_.proof_after != UINT32_MAX && !asks_for_deadlock(goals);
  if (goals.size() < 2) return {{}, Reachable(graph_, &restriction_, options_, limits_), {}, Stage::descending, proves};
  return {Predicate(goals[1], graph_.semantics(), graph_.operations()),
          Reachable(graph_, nullptr, options_, limits_),
          {},
          Stage::reaching,
          proves};
}

// ---- the loop -------------------------------------------------------------------------------------------------------

// Pushes the successors that are neither covered nor close a loop.
struct LivenessSearch::Descending {
  LivenessSearch& search;

  void possible(ConstZoneRef guarded, const Effect& effect) const { search.ends_.pass(guarded, effect); }
  void expect(const Effect& effect) const { search.passed_.announce(effect.slots.data(), effect.written); }
  bool enters(const Successor& entry, const std::vector<Atom>& invariant) const {
    search.done_.transitions += !entry.edges.empty();
    try {
      return search.restriction_.lets_through(entry, invariant, [this](const Successor& part) { take(part); });
    } catch (const ModelFault& fault) {  // of the new state, not of the action that leads there
      throw StateFault(fault, entry.edges);
    }
  }
  bool wants(const Successor& successor) const {
    return !search.options_.subsumption ||
           !search.passed_.covers(search.passed_.locate(), search.graph_.packed(successor.slots, successor.zone));
  }
  void take(const Successor& successor) const { search.push(successor); }
};

Status LivenessSearch::search(std::uint64_t steps) {
  while (!violation_) {
    if (steps-- == 0) return Status::running;
    if (!advance()) return complete_ ? Status::finished : Status::depth_limit;
    if (stored() > limits_.states) return Status::state_limit;
    if (limits_.memory_bytes != UINT64_MAX && statistics().bytes > limits_.memory_bytes) return Status::memory_limit;
  }
  return Status::finished;
}

bool LivenessSearch::advance() {
  switch (overview_.stage) {
    case Stage::reaching:
      overview_.attempts = is_time_for_attempt();
      if (overview_.attempts)
        descend();
      else
        reach();
      return true;
    case Stage::proving:
      return prove();
    case Stage::descending:
      break;
  }
  if (!overview_.begins && overview_.proves && done_.explored >= options_.proof_after)
    overview_.stage = Stage::reaching;
  else
    return descend();
  return true;
}

// Whether a step depth first comes before the next one on the way to all states: of p --> q, from the states reached so
// far. A run is then found before all are reached, and what the attempts cost stays a small part.
bool LivenessSearch::is_time_for_attempt() const {
  const Reachable& reachable = overview_.reachable;
  return overview_.begins && options_.attempts && done_.explored * 8 < reachable.explored() &&
         (!stack_.empty() || overview_.next < reachable.states().size());
}

// Expands one state on the way to all states.
void LivenessSearch::reach() {
  Overview& all = overview_;
  if (all.begins) {
    if (all.reachable.advance(source_)) return note_beginning();
    complete_ &= all.reachable.complete();
  } else {
    try {
      if (all.reachable.advance(source_)) return;
    } catch (const ModelFault&) {  // the search depth first meets it, too, or a run before it
      all.proves = false;
    } catch (const ConstantOverflow&) {
      all.proves = false;
    }
  }
  all.stage = Stage::descending;
  if (!std::exchange(all.proves, false) || !all.reachable.complete()) return;
  all.proof.emplace(graph_, restriction_, ends_, all.reachable, all.begins ? &*all.begins : nullptr);
  all.stage = Stage::proving;
}

// Looks whether p holds in the state that has been expanded last.
void LivenessSearch::note_beginning() {
  if (overview_.met) return;
  try {
    Predicate& predicate = *overview_.begins;
    overview_.met = predicate.in(source_.slots.data(), source_.zone.get()) == TruthInZone::always;
    for (std::size_t number = 0; number < predicate.size() && !overview_.met; ++number) {
      zones::ZoneBuffer part(source_.zone);
      const std::vector<Atom>& atoms = predicate[number];
      const int dimension = graph_.program().dimension();
      overview_.met = graph_.operations().intersect(part.get(), dimension, atoms.data(), atoms.size());
    }
  } catch (const ModelFault&) {  // whoever asks for runs from here meets it
    overview_.met = true;
  }
}

// Looks at one more state of the covered graph; false if there is no run.
bool LivenessSearch::prove() {
  CoveredGraph& proof = *overview_.proof;
  try {
    switch (proof.advance(source_)) {
      case CoveredGraph::Answer::unknown_yet:
        return true;
      case CoveredGraph::Answer::proved:
        complete_ = true;
        return false;
      case CoveredGraph::Answer::open:
        break;
    }
  } catch (const ModelFault&) {  // as above, or an error in states that no run comes to
  } catch (const ConstantOverflow&) {
  }
  overview_.stage = Stage::descending;
  return true;
}

bool LivenessSearch::descend() {
  if (stack_.empty()) return start();
  const SearchStack::State top = stack_.top();
  if (top.open) {
    passed_.add(top.discrete, stack_.top_zone(), no_node, options_.subsumption);
    stack_.pop();
  } else if (passed_.contains(top.discrete, stack_.top_zone(), options_.subsumption)) {
    stack_.pop();
  } else if (stack_.depth() >= limits_.depth) {
    complete_ = false;
    stack_.pop();
  } else {
    expand();
  }
  return true;
}

void LivenessSearch::expand() {
  stack_.open_top();
  unpack(stack_.size() - 1);
  ++done_.explored;
  ends_.begin(source_, restriction_.avoided());
  graph_.expand(source_, Descending{*this});
  const std::optional<EndKind> ending = ends_.end();
  if (ending == EndKind::idle)
    found(ViolationKind::idle);
  else if (closing_)
    found(ViolationKind::loop);
  else if (ending == EndKind::stuck)
    found(ViolationKind::stuck);
}

void LivenessSearch::push(const Successor& successor) {
  if (closing_) return;
  const std::uint32_t discrete = passed_.locate();
  const states::ZoneView zone = graph_.packed(successor.slots, successor.zone);
  if (passed_.contains(discrete, zone, options_.subsumption)) return;
  const std::uint32_t open = stack_.find_below(discrete, zone, options_.subsumption);
  if (open == no_node) return stack_.push(discrete, zone);
  closing_ = Closing{open, {successor.edges.begin(), successor.edges.end()}};
}

void LivenessSearch::unpack(std::uint32_t number) {
  const SearchStack::State& state = stack_[number];
  passed_.unpack_discrete(state.discrete, source_.slots.data());
  graph_.unpack(source_.slots.data(), stack_.zone(number).data, source_.zone);
}

// ---- where runs begin -----------------------------------------------------------------------------------------------

// Pushes what the next run may begin with, if that is not known yet; false if there is nothing left to begin with.
bool LivenessSearch::start() {
  if (!overview_.begins) {
    if (overview_.next++ != 0) return false;
    graph_.start(Descending{*this});
    return true;
  }
  while (overview_.next < overview_.reachable.states().size())
    if (start_from(overview_.next++)) return true;
  return false;
}

bool LivenessSearch::start_from(std::uint32_t number) {
  states::PassedList& states = overview_.reachable.states();
  if (states.covered(number)) return false;
  overview_.begun = number;
  states.unpack(number, source_.slots.data());
  graph_.unpack(states, number, source_);
  restriction_.beginnings(*overview_.begins, source_, [&](const Successor& part) {
    passed_.announce(part.slots, program::SlotSet::all());
    push(part);
  });
  return true;
}

// ---- what was found -------------------------------------------------------------------------------------------------

// Looks for the action by which one open state led to another one.
struct LivenessSearch::Finding {
  LivenessSearch& search;
  std::uint32_t sought;
  Edges& edges;

  void possible(ConstZoneRef, const Effect&) const {}
  void expect(const Effect& effect) const { search.passed_.announce(effect.slots.data(), program::SlotSet::all()); }
  bool enters(const Successor& entry, const std::vector<Atom>& invariant) const {
    return edges.empty() &&
           search.restriction_.lets_through(entry, invariant, [this](const Successor& part) { take(part); });
  }
  bool wants(const Successor&) const { return search.passed_.locate() == search.stack_[sought].discrete; }
  void take(const Successor& successor) const {
    if (!edges.empty() || !wants(successor)) return;
    const states::ZoneView zone = search.graph_.packed(successor.slots, successor.zone);
    if (search.stack_.holds(sought, zone)) edges.assign(successor.edges.begin(), successor.edges.end());
  }
};

Edges LivenessSearch::edges_between(std::uint32_t from, std::uint32_t to) {
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

Path LivenessSearch::path_so_far() {
  Path path;
  if (overview_.begins) {
    Reachable& reachable = overview_.reachable;
    const bool reaching = overview_.stage == Stage::reaching && !overview_.attempts;
    const std::uint32_t node = reaching ? reachable.node() : overview_.begun;
    if (node != no_node) path = reachability::path_to(graph_, reachable.states(), node);
    if (reaching) return path;
  }
  const std::vector<std::uint32_t> open = stack_.path();
  for (std::size_t number = 1; number < open.size(); ++number)
    path.push_back(edges_between(open[number - 1], open[number]));
  return path;
}

void LivenessSearch::found(ViolationKind kind) {
  Path stem = path_so_far();
  const std::vector<std::uint32_t> open = stack_.path();
  const std::size_t begins = stem.size() + 1 - open.size();
  violation_ = Violation{kind, {}, begins, {}};
  if (kind == ViolationKind::loop) {
    const auto back = std::find(open.begin(), open.end(), closing_->state) - open.begin();
    const auto entrance = stem.begin() + static_cast<std::ptrdiff_t>(begins) + back;
    violation_->loop.assign(entrance, stem.end());
    violation_->loop.push_back(closing_->edges);
    stem.erase(entrance, stem.end());
  }
  violation_->stem = std::move(stem);
}

reachability::CoverParts& LivenessSearch::cover() {
  if (!parts_.empty()) return parts_;
  if (overview_.begins) {
    states::PassedList& states = overview_.reachable.states();
    for (std::uint32_t node = 0; node < states.size(); ++node)
      if (!states.covered(node)) parts_.add(states, node, 0);
  }
  for (std::uint32_t node = 0; node < passed_.size(); ++node) parts_.add(passed_, node, std::int64_t{node} + 1);
  return parts_;
}

// ---- a path without extrapolation -----------------------------------------------------------------------------------

namespace {

// Keeps what an action leads to, or all there is where no action has been taken yet.
struct Following {
  const symbolic::ZoneGraph& graph;
  Restriction* restriction;  // none where q may hold
  const Edges* edges;
  std::vector<SymbolicState>& states;

  void possible(ConstZoneRef, const Effect&) const {}
  void expect(const Effect&) const {}
  bool enters(const Successor& entry, const std::vector<Atom>& invariant) const {
    if (edges != nullptr && !std::equal(entry.edges.begin(), entry.edges.end(), edges->begin(), edges->end()))
      return false;
    return restriction == nullptr ||
           restriction->lets_through(entry, invariant, [this](const Successor& part) { take(part); });
  }
  bool wants(const Successor&) const { return true; }
  void take(const Successor& successor) const { states.push_back(graph.copy(successor)); }
};

// Wants no successors, only to know whether there are any.
struct Probing {
  Ends& ends;

  void possible(ConstZoneRef guarded, const Effect& effect) const { ends.pass(guarded, effect); }
  void expect(const Effect&) const {}
  bool wants(const Successor&) const { return false; }
  void take(const Successor&) const {}
};

}  // namespace

bool LivenessSearch::gets_stuck(const Path& actions, std::size_t begins) {
  std::vector<SymbolicState> states;
  try {
    graph_.start(Following{graph_, overview_.begins ? nullptr : &restriction_, nullptr, states});
    for (std::size_t number = 0;; ++number) {
      if (overview_.begins && number == begins) {
        std::vector<SymbolicState> parts_of_all;
        for (SymbolicState& state : states)
          restriction_.beginnings(*overview_.begins, state,
                                  [&](const Successor& part) { parts_of_all.push_back(graph_.copy(part)); });
        states.swap(parts_of_all);
      }
      if (number == actions.size()) break;
      Restriction* restriction = number >= begins ? &restriction_ : nullptr;
      std::vector<SymbolicState> next;
      for (SymbolicState& state : states) graph_.expand(state, Following{graph_, restriction, &actions[number], next});
      states.swap(next);
    }
    for (SymbolicState& state : states) {
      ends_.begin(state, restriction_.avoided());
      graph_.expand(state, Probing{ends_});
      if (ends_.end()) return true;
    }
  } catch (const ModelFault&) {
  } catch (const ConstantOverflow&) {
  }
  return false;
}

// ---- how it is asked for --------------------------------------------------------------------------------------------

Status LivenessSearch::run(std::uint64_t steps) {
  return overview_.pieces(
      [&] { return keeping_faults(fault_, [&] { return search(steps); }, [&] { return path_so_far(); }); });
}

std::uint64_t LivenessSearch::stored() const {
  return overview_.reachable.states().stored() + passed_.stored() + stack_.depth();
}

reachability::Statistics LivenessSearch::statistics() const {
  const Reachable& reachable = overview_.reachable;
  reachability::Statistics sum{done_.explored + reachable.explored(), stored(),
                               done_.transitions + reachable.transitions(),
                               passed_.bytes() + stack_.bytes() + reachable.bytes()};
  if (overview_.proof) {
    sum.explored += overview_.proof->explored();
    sum.transitions += overview_.proof->transitions();
    sum.bytes += overview_.proof->bytes();
  }
  return sum;
}

}  // namespace tachk::liveness
