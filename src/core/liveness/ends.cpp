#include "liveness/ends.hpp"

#include <algorithm>

namespace tachk::liveness {

using symbolic::Delay;
using zones::ConstZoneRef;

Ends::Ends(symbolic::ZoneGraph& graph)
    : semantics_(graph.semantics()),
      operations_(graph.operations()),
      dimension_(graph.program().dimension()),
      avoidance_(semantics_, operations_),
      finder_(operations_, dimension_),
      dead_(graph.program(), operations_) {}

// Bounds on the difference of two running clocks do not change while time passes.
bool Ends::may_idle(Delay delay, const std::uint8_t* stopped) const {
  return delay != Delay::none && std::none_of(invariant_.begin(), invariant_.end(), [&](const zones::Atom& atom) {
           return atom.left != 0 && atom.right == 0 && (stopped == nullptr || stopped[atom.left] == 0);
         });
}

void Ends::begin(symbolic::SymbolicState& source, Predicate& avoided) {
  std::int32_t* slots = slots_ = source.slots.data();
  invariant_.clear();
  semantics_.invariant(slots, invariant_);
  const Delay delay = symbolic::delay_in(semantics_, slots);
  avoided.in(slots, source.zone.get());
  never_ = &avoidance_.never_met(source.zone.get(), invariant_, delay, avoided);
  idle_ = !never_->empty() && may_idle(delay, semantics_.stopped_clocks(slots));
  finder_.begin(source.zone.get(), invariant_, delay, false);
}

void Ends::pass(ConstZoneRef guarded, const symbolic::Effect& effect) {
  if (idle_ || never_->empty() || !finder_.open()) return;
  atoms_.clear();
  if (semantics_.weakest_precondition(effect, atoms_)) finder_.add(guarded, atoms_);
}

std::optional<EndKind> Ends::end() {
  if (idle_) return EndKind::idle;
  for (std::size_t part = 0; part < never_->size(); ++part)
    if (may_be_stuck((*never_)[part], finder_.dead()) && is_stuck((*never_)[part])) return EndKind::stuck;
  return std::nullopt;
}

// True if some valuation of a zone is dead.
bool Ends::may_be_stuck(ConstZoneRef zone, const zones::Federation& dead) {
  zones::ZoneBuffer common(operations_);
  for (std::size_t part = 0; part < dead.size(); ++part) {
    common.assign(zone);
    zones::tighter_constraints(operations_, dimension_, dead[part], common.get(), atoms_);
    if (operations_.intersect(common.get(), dimension_, atoms_.data(), atoms_.size())) return true;
  }
  return false;
}

// The states that avoid a predicate may come in parts, and delays lead from one part to another: all that they lead to
// counts.
bool Ends::is_stuck(ConstZoneRef zone) {
  dead_.compute(slots_, zone);
  return may_be_stuck(zone, dead_.dead());
}

}  // namespace tachk::liveness
