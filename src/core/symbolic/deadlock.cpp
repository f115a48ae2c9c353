#include "symbolic/deadlock.hpp"

#include <algorithm>
#include <utility>

#include "zones/patience.hpp"

namespace tachk::symbolic {

Delay delay_in(Semantics& semantics, std::int32_t* slots) {
  const bool passes = semantics.time_passes(slots);
  const std::uint8_t* stopped = semantics.stopped_clocks(slots);
  const int dimension = semantics.program().dimension();
  if (stopped != nullptr && std::find(stopped, stopped + dimension, 1) != stopped + dimension) return Delay::partial;
  return passes ? Delay::free : Delay::none;
}

namespace {

constexpr std::size_t most_pieces = 16;  // from which actions are subtracted as they come

}  // namespace

DeadlockFinder::DeadlockFinder(const zones::ZoneOperations& operations, int dimension)
    : operations_(operations),
      dimension_(dimension),
      whole_(operations),
      possible_(operations),
      dead_(operations, dimension),
      live_(operations, dimension),
      waiting_(operations, dimension),
      parts_(operations, dimension),
      scratch_(operations) {}

void DeadlockFinder::begin(zones::ConstZoneRef zone, const std::vector<zones::Atom>& invariant, Delay delay,
                           bool wants_live) {
  delay_ = delay;
  invariant_ = invariant;
  dead_.clear();
  live_.clear();
  deferred_.clear();
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
    deferred_.clear();
  } else {
    zones::tighter_constraints(operations_, dimension_, possible_.get(), whole_.get(), cuts_);
    if (dead_.size() > most_pieces)
      deferred_.push_back(cuts_);
    else
      dead_.subtract(cuts_);
  }
  if (!wants_live_) return;
  possible_.assign(whole_.get());
  if (delay_ == Delay::partial || operations_.intersect(possible_.get(), dimension_, cuts_.data(), cuts_.size()))
    live_.add(possible_.get());
}

// Piece by piece, so that a piece that any of the actions covers is gone before others cut it up.
void DeadlockFinder::settle() {
  std::swap(dead_, waiting_);
  dead_.clear();
  while (!waiting_.empty()) {
    zones::Patience::check();
    possible_.assign(waiting_[waiting_.size() - 1]);
    waiting_.remove_last();
    const zones::ConstZoneRef piece = possible_.get();
    const auto is_covered_by = [&](const std::vector<zones::Atom>& cuts) { return covers(cuts, piece); };
    if (std::any_of(deferred_.begin(), deferred_.end(), is_covered_by)) continue;
    const auto next = std::find_if(deferred_.begin(), deferred_.end(),
                                   [&](const std::vector<zones::Atom>& cuts) { return meets(cuts, piece); });
    if (next == deferred_.end()) {
      dead_.add(piece);
      continue;
    }
    parts_.clear();
    parts_.add(piece);
    parts_.subtract(*next);
    for (std::size_t part = 0; part < parts_.size(); ++part) waiting_.add(parts_[part]);
  }
  deferred_.clear();
}

bool DeadlockFinder::covers(const std::vector<zones::Atom>& cuts, zones::ConstZoneRef piece) const {
  return std::all_of(cuts.begin(), cuts.end(), [&](const zones::Atom& cut) {
    return operations_.entry(piece, dimension_, cut.left, cut.right) <= cut.raw;
  });
}

bool DeadlockFinder::meets(const std::vector<zones::Atom>& cuts, zones::ConstZoneRef piece) {
  scratch_.assign(piece);
  return operations_.intersect(scratch_.get(), dimension_, cuts.data(), cuts.size());
}

}  // namespace tachk::symbolic
