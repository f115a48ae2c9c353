#include "liveness/recurrence_search.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "reachability/paths.hpp"

namespace tachk::liveness {

using reachability::path_to;
using reachability::Status;
using states::no_node;
using states::ZoneView;
using symbolic::Effect;
using symbolic::Path;
using symbolic::Successor;

RecurrenceSearch::RecurrenceSearch(program::Program program, bool begins, const reachability::Options& options,
                                   const reachability::Limits& limits)
    : options_(options),
      limits_(limits),
      graph_(std::move(program), options_),
      restriction_(graph_, graph_.program().goals.at(0)),
      ends_(graph_),
      question_{Predicate(graph_.program().goals.at(1), graph_.semantics(), graph_.operations()), {}, {}},
      beginnings_{Reachable(graph_, nullptr, options_, limits_), begins, 0, no_node, {}},
      states_(graph_.program(), graph_.operations(), options_, graph_.smaller_operations()),
      source_(graph_.blank()) {
  const std::vector<program::Goal>& goals = graph_.program().goals;
  const auto predicate = [&](std::size_t goal) {
    return Predicate(goals.at(goal), graph_.semantics(), graph_.operations());
  };
  if (begins) question_.begins.emplace(goals.at(2), graph_.semantics(), graph_.operations());
  for (std::size_t next = begins ? 3 : 2; next < goals.size(); ++next) question_.again.push_back(predicate(next));
  if (question_.again.size() > 63) throw std::length_error("more predicates than bits");
}

RecurrenceSearch::Marks RecurrenceSearch::all_marks() const { return (Marks{1} << question_.again.size()) - 1; }

// ---- the loop -------------------------------------------------------------------------------------------------------

// Adds the successors that are not hopeless, and notes the steps to them.
struct RecurrenceSearch::Exploring {
  RecurrenceSearch& search;
  bool watches_ends;

  void possible(zones::ConstZoneRef guarded, const Effect& effect) const {
    if (watches_ends) search.ends_.pass(guarded, effect);
  }
  void expect(const Effect& effect) const { search.states_.announce(effect.slots.data(), effect.written); }
  bool enters(const Successor& entry, const std::vector<zones::Atom>& invariant) const {
    search.done_.transitions += !entry.edges.empty();
    try {
      return search.restriction_.lets_through(entry, invariant, [this](const Successor& part) { take(part); });
    } catch (const machine::ModelFault& fault) {  // of the new state, not of the action that leads there
      throw StateFault(fault, entry.edges);
    }
  }
  bool wants(const Successor& successor) const {
    return !search.is_hopeless(search.states_.locate(), search.graph_.packed(successor.slots, successor.zone));
  }
  void take(const Successor& successor) const { search.push(successor); }
};

Status RecurrenceSearch::search(std::uint64_t steps) {
  while (!violation_) {
    if (steps-- == 0) return Status::running;
    if (!advance()) return way_.complete ? Status::finished : Status::depth_limit;
    if (stored() > limits_.states) return Status::state_limit;
    if (limits_.memory_bytes != UINT64_MAX && statistics().bytes > limits_.memory_bytes) return Status::memory_limit;
  }
  return Status::finished;
}

bool RecurrenceSearch::advance() {
  if (beginnings_.reaching) {
    beginnings_.reaching = beginnings_.reachable.advance(source_);
    way_.complete &= beginnings_.reaching || beginnings_.reachable.complete();
    return true;
  }
  const std::size_t own = way_.path.empty() ? 0 : way_.path.back().first;
  if (way_.steps.size() > own) {
    const State state = way_.steps.back();
    way_.steps.pop_back();
    visit(state);
  } else if (!way_.path.empty()) {
    close();
  } else {
    return start();
  }
  return true;
}

void RecurrenceSearch::visit(State state) {
  if (components_.is_finished(state)) return;
  if (components_.is_new(state)) return open(state);
  if (components_.join(state) == all_marks()) found_loop(state);
}

void RecurrenceSearch::open(State state) {
  if (way_.path.size() >= limits_.depth) {
    way_.complete = false;
    return;
  }
  components_.enter(state);
  way_.path.push_back({state, way_.steps.size()});
  expand(state);
}

void RecurrenceSearch::expand(State state) {
  unpack(state, source_);
  ++done_.explored;
  way_.expanded = state;
  const bool may_end = question_.ending.in(source_.slots.data(), source_.zone.get()) == TruthInZone::always;
  if (may_end) ends_.begin(source_, restriction_.avoided());
  graph_.expand(source_, Exploring{*this, may_end});
  way_.expanded = no_node;
  if (!may_end) return;
  if (const std::optional<EndKind> ending = ends_.end()) found_end(*ending);
}

void RecurrenceSearch::close() {
  const State state = way_.path.back().state;
  way_.path.pop_back();
  components_.leave(state, [this](State member) {
    if (options_.subsumption) retire(member);
  });
}

// ---- states ---------------------------------------------------------------------------------------------------------

void RecurrenceSearch::retire(State state) {
  const std::uint32_t discrete = states_.discrete(state);
  zones::ZoneBuffer buffer(graph_.operations());
  zones::ZoneBuffer of_other(graph_.operations());
  const ZoneView zone = states_.zone(state, buffer);
  if (is_hopeless(discrete, zone)) return;
  if (hopeless_.size() <= discrete) hopeless_.resize(discrete + 1);
  std::vector<State>& all = hopeless_[discrete];
  std::erase_if(all, [&](State other) { return states_.includes(state, states_.zone(other, of_other)); });
  all.push_back(state);
}

bool RecurrenceSearch::is_hopeless(std::uint32_t discrete, ZoneView zone) const {
  if (discrete >= hopeless_.size()) return false;
  const std::vector<State>& all = hopeless_[discrete];
  return std::any_of(all.begin(), all.end(), [&](State other) { return states_.includes(other, zone); });
}

void RecurrenceSearch::push(const Successor& successor) {
  const std::uint32_t discrete = states_.locate();
  const ZoneView zone = graph_.packed(successor.slots, successor.zone);
  if (is_hopeless(discrete, zone)) return;
  State state = states_.find(discrete, zone);
  if (state == no_node) {
    state = states_.add(discrete, zone, way_.expanded, false);
    components_.add(marks_of(successor));
    if (beginnings_.origin != no_node) beginnings_.origins.emplace(state, beginnings_.origin);
  }
  way_.steps.push_back(state);
}

RecurrenceSearch::Marks RecurrenceSearch::marks_of(const Successor& successor) {
  Marks marks = 0;
  for (std::size_t number = 0; number < question_.again.size(); ++number)
    if (question_.again[number].in(successor.slots, successor.zone) == TruthInZone::always) marks |= Marks{1} << number;
  return marks;
}

void RecurrenceSearch::unpack(State state, symbolic::SymbolicState& into) {
  states_.unpack(state, into.slots.data());
  graph_.unpack(states_, state, into);
}

// Notes the states that the next runs may begin with; false if there are none left.
bool RecurrenceSearch::start() {
  const Exploring exploring{*this, false};
  if (!question_.begins) {
    if (beginnings_.next++ != 0) return false;
    graph_.start(exploring);
    return true;
  }
  states::PassedList& reached = beginnings_.reachable.states();
  for (; beginnings_.next < reached.size(); ++beginnings_.next) {
    if (reached.covered(beginnings_.next)) continue;
    reached.unpack(beginnings_.next, source_.slots.data());
    graph_.unpack(reached, beginnings_.next, source_);
    beginnings_.origin = beginnings_.next++;
    restriction_.beginnings(*question_.begins, source_, [&](const Successor& part) {
      states_.announce(part.slots, program::SlotSet::all());
      push(part);
    });
    beginnings_.origin = no_node;
    return true;
  }
  return false;
}

// ---- what was found -------------------------------------------------------------------------------------------------

// Collects the states that a state leads to, as far as they have been seen.
struct RecurrenceSearch::Listing {
  RecurrenceSearch& search;
  std::vector<Step>& steps;

  void possible(zones::ConstZoneRef, const Effect&) const {}
  void expect(const Effect& effect) const { search.states_.announce(effect.slots.data(), program::SlotSet::all()); }
  bool enters(const Successor& entry, const std::vector<zones::Atom>& invariant) const {
    return search.restriction_.lets_through(entry, invariant, [this](const Successor& part) { take(part); });
  }
  bool wants(const Successor&) const { return true; }
  void take(const Successor& successor) const {
    const ZoneView zone = search.graph_.packed(successor.slots, successor.zone);
    const State state = search.states_.find(search.states_.locate(), zone);
    if (state != no_node) steps.push_back({state, {successor.edges.begin(), successor.edges.end()}});
  }
};

std::vector<RecurrenceSearch::Step> RecurrenceSearch::steps_from(State state) {
  std::vector<Step> steps;
  unpack(state, source_);
  try {
    graph_.expand(source_, Listing{*this, steps});
  } catch (const machine::ModelFault&) {
    // The search stopped at this fault, in an action behind the one looked for.
  } catch (const symbolic::ConstantOverflow&) {
    // As above.
  }
  return steps;
}

RecurrenceSearch::State RecurrenceSearch::go(State from, Marks wanted, State target, Path& path) {
  struct Coming {
    State from;
    symbolic::Edges edges;
  };
  std::unordered_map<State, Coming> came;
  std::vector<State> waiting{from};
  for (std::size_t next = 0; next < waiting.size(); ++next)
    for (Step& step : steps_from(waiting[next])) {
      if (!components_.is_in_newest(step.state)) continue;
      if (!came.try_emplace(step.state, Coming{waiting[next], std::move(step.edges)}).second) continue;
      waiting.push_back(step.state);
      if (wanted != 0 ? (components_.marks(step.state) & wanted) == 0 : step.state != target) continue;
      Path back;
      State state = step.state;
      do {
        const Coming& last = came.at(state);
        back.push_back(last.edges);
        state = last.from;
      } while (state != from);
      path.insert(path.end(), back.rbegin(), back.rend());
      return step.state;
    }
  throw std::logic_error("a component does not hang together");
}

Path RecurrenceSearch::path_to_state(State state, std::size_t& begins) {
  std::vector<State> chain{state};
  while (states_.parent(chain.back()) != no_node) chain.push_back(states_.parent(chain.back()));
  std::reverse(chain.begin(), chain.end());
  Path path;
  const auto origin = beginnings_.origins.find(chain.front());
  if (origin != beginnings_.origins.end()) path = path_to(graph_, beginnings_.reachable.states(), origin->second);
  begins = path.size();
  for (std::size_t number = 1; number < chain.size(); ++number) {
    const std::vector<Step> steps = steps_from(chain[number - 1]);
    const auto taken =
        std::find_if(steps.begin(), steps.end(), [&](const Step& s) { return s.state == chain[number]; });
    if (taken == steps.end()) throw std::logic_error("a state is not a successor of its parent");
    path.push_back(taken->edges);
  }
  return path;
}

void RecurrenceSearch::found_end(EndKind ending) {
  std::size_t begins = 0;
  Path stem = path_to_state(way_.path.back().state, begins);
  violation_ =
      Violation{ending == EndKind::idle ? ViolationKind::idle : ViolationKind::stuck, std::move(stem), begins, {}};
}

void RecurrenceSearch::found_loop(State entrance) {
  Path loop;
  State state = entrance;
  Marks missing = all_marks() & ~components_.marks(entrance);
  while (missing != 0) {
    state = go(state, missing, no_node, loop);
    missing &= ~components_.marks(state);
  }
  if (state != entrance || loop.empty()) go(state, 0, entrance, loop);
  std::size_t begins = 0;
  Path stem = path_to_state(entrance, begins);
  violation_ = Violation{ViolationKind::loop, std::move(stem), begins, std::move(loop)};
}

// ---- the interface --------------------------------------------------------------------------------------------------

Status RecurrenceSearch::run(std::uint64_t steps) {
  return way_.pieces(
      [&] { return keeping_faults(fault_, [&] { return search(steps); }, [&] { return path_so_far(); }); });
}

// The way to the state whose successors are being made.
Path RecurrenceSearch::path_so_far() {
  std::size_t begins = 0;
  if (beginnings_.reaching && beginnings_.reachable.node() != no_node)
    return path_to(graph_, beginnings_.reachable.states(), beginnings_.reachable.node());
  if (beginnings_.origin != no_node) return path_to(graph_, beginnings_.reachable.states(), beginnings_.origin);
  return way_.expanded == no_node ? Path{} : path_to_state(way_.expanded, begins);
}

std::uint64_t RecurrenceSearch::stored() const {
  return std::uint64_t{states_.stored()} + beginnings_.reachable.states().stored();
}

reachability::Statistics RecurrenceSearch::statistics() const {
  return {done_.explored + beginnings_.reachable.explored(), stored(),
          done_.transitions + beginnings_.reachable.transitions(),
          states_.bytes() + components_.bytes() + way_.steps.capacity() * sizeof(State) +
              way_.path.capacity() * sizeof(Visit) + beginnings_.reachable.bytes()};
}

}  // namespace tachk::liveness
