// Where nothing is possible any more: the valuations of one symbolic state from which no action can be taken, now or
// after any delay, found while the actions of the state are gone through.
#pragma once

#include <cstdint>
#include <vector>

#include "symbolic/successor.hpp"
#include "zones/federation.hpp"
#include "zones/zone.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk::symbolic {

// How time goes on in a state.
enum class Delay {
  none,
  free,
  // Some clocks stand still: the past of a zone is no zone then. Too few valuations count as live, and too many as
  // perhaps live, so that both answers stay over-approximated.
  partial,
};

// Throws ModelFault.
Delay delay_in(Semantics& semantics, std::int32_t* slots);

class DeadlockFinder {
 public:
  DeadlockFinder(const zones::ZoneOperations& operations, int dimension);

  // Begins with a state. The zone may have been widened beyond its invariant, and is cut back to it: what can happen
  // outside is of no use to a valuation inside. `wants_live`: whether `live` will be needed.
  void begin(zones::ConstZoneRef zone, const std::vector<zones::Atom>& invariant, Delay delay, bool wants_live);

  // False once further actions cannot change the result.
  bool open() const { return wants_live_ || !dead_.empty(); }

  // An action that is possible where `guarded`, a part of the zone, satisfies the precondition of the invariant behind
  // it.
  void add(zones::ConstZoneRef guarded, const std::vector<zones::Atom>& precondition);

  const zones::Federation& dead() {
    if (!deferred_.empty()) settle();
    return dead_;
  }
  const zones::Federation& live() const { return live_; }

 private:
  // Subtracts the actions that were deferred.
  void settle();
  // Whether the conjunction of some cuts covers a part of the whole zone, or meets it.
  bool covers(const std::vector<zones::Atom>& cuts, zones::ConstZoneRef piece) const;
  bool meets(const std::vector<zones::Atom>& cuts, zones::ConstZoneRef piece);

  zones::ZoneOperations operations_;
  int dimension_;
  Delay delay_ = Delay::none;
  bool wants_live_ = false;
  std::vector<zones::Atom> invariant_;
  zones::ZoneBuffer whole_;        // the zone within the invariant
  zones::ZoneBuffer possible_;     // the valuations from which the action at hand can be taken
  std::vector<zones::Atom> cuts_;  // what `possible_` asks for beyond `whole_`
  zones::Federation dead_;
  zones::Federation live_;
  // The cuts of actions that are subtracted later: one after the other, actions of many processes may cut what is dead
  // into exponentially many pieces, each of which some later action covers.
  std::vector<std::vector<zones::Atom>> deferred_;
  zones::Federation waiting_;  // pieces from which not all deferred actions are subtracted
  zones::Federation parts_;    // of one of them
  zones::ZoneBuffer scratch_;
};

}  // namespace tachk::symbolic
