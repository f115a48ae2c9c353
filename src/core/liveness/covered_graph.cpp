#include "liveness/covered_graph.hpp"

#include <utility>

namespace tachk::liveness {

using states::PassedList;
using symbolic::Successor;
using symbolic::SymbolicState;

// Notes the stored states that cover the successors in which the predicate can be false.
struct CoveredGraph::Stepping {
  CoveredGraph& search;

  PassedList& states() const { return search.reachable_.states(); }
  void possible(zones::ConstZoneRef guarded, const symbolic::Effect& effect) const {
    search.ends_.pass(guarded, effect);
  }
  void expect(const symbolic::Effect& effect) const { states().announce(effect.slots.data(), effect.written); }
  bool enters(const Successor& entry, const std::vector<zones::Atom>& invariant) const {
    ++search.transitions_;
    if (!search.reachable_.is_restricted())
      return search.restriction_.avoided().in(entry.slots, entry.zone) != TruthInZone::always;
    return search.restriction_.lets_through(entry, invariant, [this](const Successor& part) {
      states().announce(part.slots, program::SlotSet::all());
      take(part);
    });
  }
  // A widened zone is covered where the zone is, unless it is widened in several parts.
  bool wants(const Successor& successor) const { return !covered(successor); }
  void take(const Successor& successor) const { search.open_ |= !covered(successor); }

  bool covered(const Successor& successor) const {
    const std::uint32_t discrete = states().locate();
    const State state = states().coverer(discrete, search.graph_.packed(successor.slots, successor.zone));
    if (state == states::no_node) return false;
    search.step(state);
    return true;
  }
};

CoveredGraph::Answer CoveredGraph::advance(SymbolicState& source) {
  if (path_.empty() && steps_.empty()) {
    if (!begin(source)) return circles_.circular().empty() ? Answer::proved : Answer::circles;
  } else if (!path_.empty() && steps_.size() == path_.back().first) {
    circles_.leave(path_.back().state);
    path_.pop_back();
  } else {
    const State state = steps_.back();
    steps_.pop_back();
    if (!circles_.is_new(state))
      circles_.join(state);
    else if (!visit(state, source))
      return Answer::open;
  }
  return open_ ? Answer::open : Answer::unknown_yet;
}

// Notes where runs begin, if that is not done yet; false if it is.
bool CoveredGraph::begin(SymbolicState& source) {
  PassedList& states = reachable_.states();
  circles_.resize(states.size());
  if (begins_ == nullptr) {
    if (std::exchange(next_, 1) != 0) return false;
    if (const CoveringSteps* recorded = reachable_.steps())
      step(recorded->initial());
    else
      graph_.start(Stepping{*this});
    return true;
  }
  for (; next_ < states.size(); ++next_) {
    if (states.covered(next_) || !circles_.is_new(next_)) continue;
    states.unpack(next_, source.slots.data());
    if (begins_->in(source.slots.data(), source.zone.get()) == TruthInZone::never) continue;
    if (restriction_.avoided().in(source.slots.data(), source.zone.get()) == TruthInZone::always) continue;
    steps_.push_back(next_++);
    return true;
  }
  return false;
}

void CoveredGraph::step(State state) {
  if (circles_.is_new(state))
    steps_.push_back(state);
  else if (!path_.empty())
    circles_.join(state);
}

void CoveredGraph::step(CoveringSteps::Reader recorded) {
  for (State target; recorded.next(target);) step(reachable_.steps()->uncovered(reachable_.states(), target));
}

// False if a run may end in the state.
bool CoveredGraph::visit(State state, SymbolicState& source) {
  circles_.enter(state);
  path_.push_back({state, steps_.size()});
  if (const CoveringSteps* recorded = reachable_.steps()) {
    step(recorded->from(state));
    return true;
  }
  PassedList& states = reachable_.states();
  states.unpack(state, source.slots.data());
  graph_.unpack(states, state, source);
  ++explored_;
  ends_.begin(source, restriction_.avoided());
  if (ends_.idle()) return false;
  graph_.expand(source, Stepping{*this});
  return !ends_.end();
}

}  // namespace tachk::liveness
