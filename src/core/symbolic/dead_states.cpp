#include "symbolic/dead_states.hpp"

namespace tachk::symbolic {

DeadStates::DeadStates(const program::Program& program, const zones::ZoneOperations& operations)
    : semantics_(program, operations),
      operations_(operations),
      dimension_(program.dimension()),
      finder_(operations, dimension_),
      later_(operations) {}

void DeadStates::compute(std::int32_t* slots, zones::ConstZoneRef zone) {
  const Delay delay = delay_in(semantics_, slots);
  invariant_.clear();
  semantics_.invariant(slots, invariant_);
  later_.assign(zone);
  const bool inhabited = operations_.intersect(later_.get(), dimension_, invariant_.data(), invariant_.size());
  finder_.begin(zone, invariant_, delay, true);
  if (!inhabited) return;
  if (delay != Delay::none)
    operations_.up_within(later_.get(), dimension_, semantics_.stopped_clocks(slots), invariant_.data(),
                          invariant_.size());
  finder_.begin(later_.get(), invariant_, delay, true);
  semantics_.for_each_action(slots, later_.get(), [&](const Action& action, zones::ConstZoneRef guarded) {
    if (!semantics_.apply(action.edges, slots, effect_)) return;
    atoms_.clear();
    if (semantics_.weakest_precondition(effect_, atoms_)) finder_.add(guarded, atoms_);
  });
}

}  // namespace tachk::symbolic
