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
using symbolic::Path;
using zones::Atom;

namespace {

constexpr std::size_t few = 256;  // so many states on circles are soon gone through

bool has_deadlock_literal(const std::vector<Goal>& goals) {
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
      nested_(graph_, restriction_, ends_, options_, limits_.depth),
      source_(graph_.blank()),
      parts_(graph_) {}

LivenessSearch::Overview LivenessSearch::overview() {
  const std::vector<Goal>& goals = graph_.program().goals;
  // The short proof looks at predicates without the zones that `deadlock` needs.
  const bool proves = options_.proof_after != UINT32_MAX && !has_deadlock_literal(goals);
  const bool one = goals.size() < 2;
  Overview all{{},
               Reachable(graph_, one ? &restriction_ : nullptr, options_, limits_),
               {},
               one ? Stage::descending : Stage::reaching,
               proves};
  if (!one) all.begins.emplace(goals[1], graph_.semantics(), graph_.operations());
  if (one && proves) all.reachable.record_steps(ends_);
  return all;
}

// ---- the loop -------------------------------------------------------------------------------------------------------

Status LivenessSearch::search(std::uint64_t steps) {
  while (!violation_) {
    if (steps-- == 0) return Status::running;
    if (!advance()) return complete() ? Status::finished : Status::depth_limit;
    if (stored() > limits_.states) return Status::state_limit;
    if (limits_.memory_bytes != UINT64_MAX && statistics().bytes > limits_.memory_bytes) return Status::memory_limit;
  }
  return Status::finished;
}

bool LivenessSearch::advance() {
  switch (overview_.stage) {
    case Stage::reaching:
      overview_.depth_first = is_time_for_depth_first();
      if (overview_.depth_first) return descend() || overview_.begins;
      reach();
      return true;
    case Stage::proving:
      return prove();
    case Stage::circling:
      return circle();
    case Stage::descending:
      break;
  }
  if (overview_.begins || !overview_.proves || nested_.explored() < options_.proof_after) return descend();
  overview_.stage = Stage::reaching;
  overview_.explored_before = nested_.explored();
  return true;
}

// True if a step depth first comes before the next one on the way to all states: of p --> q, from the states reached so
// far. A run is then found before all are reached, and what those steps cost stays a small part. Without p such steps
// may also end the search: all states are finished then.
bool LivenessSearch::is_time_for_depth_first() const {
  const Reachable& reachable = overview_.reachable;
  const std::uint64_t explored = nested_.explored() - overview_.explored_before;
  if (!options_.depth_first || explored * 8 >= reachable.explored()) return false;
  if (!overview_.begins) return !nested_.idle() || nested_.complete();
  return !nested_.idle() || overview_.next < reachable.states().size();
}

// Expands one state on the way to all states.
void LivenessSearch::reach() {
  Overview& all = overview_;
  Reachable& reachable = all.reachable;
  if (all.begins) {
    if (reachable.advance(source_)) return note_beginning();
    all.complete &= reachable.complete();
  } else {
    try {
      if (reachable.advance(source_)) {
        all.proves = !reachable.may_end();
        if (all.proves) return;
      }
    } catch (const ModelFault&) {  // the search depth first meets it, too, or a run before it
      all.proves = false;
    } catch (const ConstantOverflow&) {
      all.proves = false;
    }
  }
  all.stage = Stage::descending;
  if (!std::exchange(all.proves, false) || !reachable.complete()) return;
  all.proof.emplace(graph_, restriction_, ends_, reachable, all.begins ? &*all.begins : nullptr);
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
  } catch (const ModelFault&) {  // a search for runs from here meets it
    overview_.met = true;
  }
}

// Looks at one more state of the covered graph; false if there is no run.
bool LivenessSearch::prove() {
  CoveredGraph::Answer answer = CoveredGraph::Answer::open;
  try {
    answer = overview_.proof->advance(source_);
  } catch (const ModelFault&) {  // as above, or an error in states that no run comes to
  } catch (const ConstantOverflow&) {
  }
  if (answer == CoveredGraph::Answer::unknown_yet) return true;
  proved_ = answer == CoveredGraph::Answer::proved;
  overview_.stage = answer == CoveredGraph::Answer::circles && follow_circles() ? Stage::circling : Stage::descending;
  return !proved_;
}

// Prepares the search among the states that lie on circles; false where those are too many for it to pay.
bool LivenessSearch::follow_circles() {
  Overview& all = overview_;
  const std::vector<std::uint32_t>& circular = all.proof->circular();
  if (circular.size() > few && circular.size() * 2 > all.proof->entered()) return false;
  NestedSearch& search = among_circles_.emplace(graph_, restriction_, ends_, options_, limits_.depth);
  for (const std::uint32_t state : circular) {
    zones::Patience::check();
    all.reachable.states().unpack(state, source_.slots.data());
    search.know(source_.slots.data());
  }
  return true;
}

// One step among the states that lie on circles; false if no run stays there.
bool LivenessSearch::circle() {
  Overview& all = overview_;
  NestedSearch& search = *among_circles_;
  try {
    if (!search.idle()) {
      search.advance();
      if (search.found()) all.stage = Stage::descending;
      return true;
    }
    const std::vector<std::uint32_t>& circular = all.proof->circular();
    if (next_circular_ < circular.size()) {
      const std::uint32_t state = circular[next_circular_++];
      all.reachable.states().unpack(state, source_.slots.data());
      graph_.unpack(all.reachable.states(), state, source_);
      search.start_among_known(source_);
      return true;
    }
  } catch (const ModelFault&) {  // as in `prove`
    all.stage = Stage::descending;
    return true;
  } catch (const ConstantOverflow&) {
    all.stage = Stage::descending;
    return true;
  }
  proved_ = search.complete();
  all.stage = Stage::descending;
  return !proved_;
}

// ---- where runs begin -----------------------------------------------------------------------------------------------

// One step depth first; false if there is nothing left to begin with.
bool LivenessSearch::descend() {
  if (nested_.idle()) return start();
  nested_.advance();
  if (nested_.found()) violation_ = nested_.violation(stem());
  return true;
}

// Pushes what the next run may begin with, if that is not known yet; false if there is nothing left to begin with.
bool LivenessSearch::start() {
  if (!overview_.begins) {
    if (overview_.next++ != 0) return false;
    nested_.start();
    return true;
  }
  states::PassedList& states = overview_.reachable.states();
  while (overview_.next < states.size()) {
    const std::uint32_t number = overview_.next++;
    if (states.covered(number)) continue;
    overview_.begun = number;
    states.unpack(number, source_.slots.data());
    graph_.unpack(states, number, source_);
    nested_.start_in(source_, *overview_.begins);
    return true;
  }
  return false;
}

// ---- what was found -------------------------------------------------------------------------------------------------

// The actions that lead to where the path depth first begins.
Path LivenessSearch::stem() {
  if (overview_.begun == no_node) return {};
  return reachability::path_to(graph_, overview_.reachable.states(), overview_.begun);
}

Path LivenessSearch::path_so_far() {
  if (overview_.begins && overview_.stage == Stage::reaching && !overview_.depth_first) {
    const std::uint32_t node = overview_.reachable.node();
    return node == no_node ? Path{} : reachability::path_to(graph_, overview_.reachable.states(), node);
  }
  Path path = stem();
  const Path open = nested_.path();
  path.insert(path.end(), open.begin(), open.end());
  return path;
}

reachability::CoverParts& LivenessSearch::cover() {
  if (!parts_.empty()) return parts_;
  if (overview_.begins) {
    states::PassedList& states = overview_.reachable.states();
    for (std::uint32_t node = 0; node < states.size(); ++node)
      if (!states.covered(node)) parts_.add(states, node, 0);
  }
  states::PassedList& finished = nested_.finished();
  for (std::uint32_t node = 0; node < finished.size(); ++node) parts_.add(finished, node, std::int64_t{node} + 1);
  return parts_;
}

bool LivenessSearch::gets_stuck(const Path& actions, std::size_t begins) {
  return liveness::gets_stuck(graph_, restriction_, ends_, overview_.begins ? &*overview_.begins : nullptr, actions,
                              begins);
}

// ---- the interface --------------------------------------------------------------------------------------------------

Status LivenessSearch::run(std::uint64_t steps) {
  return overview_.pieces(
      [&] { return keeping_faults(fault_, [&] { return search(steps); }, [&] { return path_so_far(); }); });
}

std::uint64_t LivenessSearch::stored() const {
  const std::uint64_t on_circles = among_circles_ ? among_circles_->stored() : 0;
  return overview_.reachable.states().stored() + nested_.stored() + on_circles;
}

reachability::Statistics LivenessSearch::statistics() const {
  const Reachable& reachable = overview_.reachable;
  reachability::Statistics sum{nested_.explored() + reachable.explored(), stored(),
                               nested_.transitions() + reachable.transitions(), nested_.bytes() + reachable.bytes()};
  if (overview_.proof) {
    sum.explored += overview_.proof->explored();
    sum.transitions += overview_.proof->transitions();
    sum.bytes += overview_.proof->bytes();
  }
  if (among_circles_) {
    sum.explored += among_circles_->explored();
    sum.transitions += among_circles_->transitions();
    sum.bytes += among_circles_->bytes();
  }
  return sum;
}

}  // namespace tachk::liveness
