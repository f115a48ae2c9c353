#include "symbolic/deadlock.hpp"

#include <algorithm>

namespace tachk::symbolic {

Delay delay_in(Semantics& semantics, std::int32_t* slots) {
  const bool passes = semantics.time_passes(slots);
  const std::uint8_t* stopped = semantics.stopped_clocks(slots);
  const int dimension = semantics.program().dimension();
  if (stopped != nullptr && std::find(stopped, stopped + dimension, 1) != stopped + dimension) return Delay::partial;
  return passes ? Delay::free : Delay::none;
}

DeadlockFinder::DeadlockFinder(const zones::ZoneOperations& operations, int dimension)
    : operations_(operations),
      dimension_(dimension),
      whole_(operations),
      possible_(operations),
      dead_(operations, dimension),
      live_(operations, dimension) {}

void DeadlockFinder::begin(zones::ConstZoneRef zone, const std::vector<zones::Atom>& invariant, Delay delay,
                           bool wants_live) {
  delay_ = delay;
  invariant_ = invariant;
  dead_.clear();
  live_.clear();
  whole_.assign(zone);
  const bool inhabited = operations_.intersect(whole_.get(), dimension_, invariant.data(), invariant.size());
  wants_live_ = wants_live && inhabited;
  if (inhabited) dead_.add(whole_.get());
}

void DeadlockFinder::add(zones::ConstZoneRef guarded, const std::vector<zones::Atom>& precondition) {
  possible_.assign(guarded);
  if (!operations_.intersect(possible_.get(), dimension_, precondition.data(), precondition.size()) ||
      !operations_.intersect(possible_.get(), dimension_, invariant_.data(), invariant_.size()))
    return;
  if (delay_ == Delay::free) operations_.down(possible_.get(), dimension_);
  cuts_.clear();
  if (operations_.includes(possible_.get(), whole_.get(), dimension_)) {
    dead_.clear();
  } else {
    find_cuts();
    dead_.subtract(cuts_);
  }
  if (!wants_live_) return;
  possible_.assign(whole_.get());
  if (delay_ == Delay::partial || operations_.intersect(possible_.get(), dimension_, cuts_.data(), cuts_.size()))
    live_.add(possible_.get());
}

// Upper bounds come first: with them many of the differences follow, and subtracting those leaves nothing.
void DeadlockFinder::find_cuts() {
  for (int j = 0; j < dimension_; ++j)
    for (int i = 0; i < dimension_; ++i) {
      const zones::Raw raw = operations_.entry(possible_.get(), dimension_, i, j);
      if (i != j && raw < operations_.entry(whole_.get(), dimension_, i, j))
        cuts_.push_back({static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j), raw});
    }
}

}  // namespace tachk::symbolic
