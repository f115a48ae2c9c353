#include "liveness/predicate.hpp"

namespace tachk {

Truth Predicate::in(std::int32_t* slots) {
  count_ = 0;
  for (const Disjunct& disjunct : goal_.disjuncts) {
    if (!semantics_.holds(disjunct.condition, slots)) continue;
    if (count_ == zones_.size()) zones_.emplace_back();
    std::vector<Atom>& atoms = zones_[count_];
    atoms.clear();
    semantics_.resolve(disjunct.condition, slots, atoms);
    if (atoms.empty()) {
      count_ = 0;
      return Truth::always;
    }
    ++count_;
  }
  return count_ == 0 ? Truth::never : Truth::by_clocks;
}

}  // namespace tachk
