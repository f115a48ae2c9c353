#include "liveness/ends.hpp"

#include <algorithm>

namespace tachk {

Ends::Ends(ZoneGraph& graph)
    : semantics_(graph.semantics()),
      operations_(graph.operations()),
      dimension_(graph.program().dimension()),
      avoidance_(semantics_, operations_),
      finder_(operations_, dimension_) {}

// Bounds on the difference of two running clocks do not change while time passes.
bool Ends::may_idle(Delay delay, const std::uint8_t* stopped) const {
  return delay != Delay::none && std::none_of(invariant_.begin(), invariant_.end(), [&](const Atom& atom) {
           return atom.left != 0 && atom.right == 0 && (stopped == nullptr || stopped[atom.left] == 0);
         });
}

void Ends::begin(SymbolicState& source, Predicate& avoided) {
  std::int32_t* slots = source.slots.data();
  invariant_.clear();
  semantics_.invariant(slots, invariant_);
  const Delay delay = delay_in(semantics_, slots);
  avoided.in(slots, source.zone.get());
  never_ = &avoidance_.never_met(source.zone.get(), invariant_, delay, avoided);
  idle_ = !never_->empty() && may_idle(delay, semantics_.stopped_clocks(slots));
  finder_.begin(source.zone.get(), invariant_, delay, false);
}

void Ends::pass(ConstZoneRef guarded, const Effect& effect) {
  if (idle_ || never_->empty() || !finder_.open()) return;
  atoms_.clear();
  if (semantics_.weakest_precondition(effect, atoms_)) finder_.add(guarded, atoms_);
}

std::optional<Ending> Ends::end() const {
  if (idle_) return Ending::idle;
  ZoneBuffer common(operations_);
  std::vector<Atom> atoms;
  for (std::size_t one = 0; one < never_->size(); ++one)
    for (std::size_t dead = 0; dead < finder_.dead().size(); ++dead) {
      common.assign((*never_)[one]);
      atoms.clear();
      constraints_beyond(operations_, dimension_, finder_.dead()[dead], common.get(), atoms);
      if (operations_.intersect(common.get(), dimension_, atoms.data(), atoms.size())) return Ending::stuck;
    }
  return std::nullopt;
}

}  // namespace tachk
