// Delays that avoid a union of zones: the mirror image of the timed predecessor of F. Cassez, A. David, E. Fleury,
// K. G. Larsen, D. Lime, "Efficient on-the-fly algorithms for the analysis of timed games", CONCUR 2005.
#pragma once

#include <cstdint>
#include <vector>

#include "liveness/predicate.hpp"
#include "symbolic/deadlock.hpp"
#include "symbolic/successor.hpp"
#include "zones/federation.hpp"
#include "zones/zone.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk {

// The constraints in which a zone is tighter than another one, appended to `atoms`: what they leave of the other one is
// what both have in common.
void constraints_beyond(const ZoneOperations& operations, int dimension, ConstZoneRef zone, ConstZoneRef other,
                        std::vector<Atom>& atoms);

class Avoidance final {
 public:
  Avoidance(Semantics& semantics, const ZoneOperations& operations);

  // What a zone, which lies within the invariant, becomes by delays within the invariant during which no zone of the
  // predicate is met, not even at their beginning or end. Where clocks stand still it may be too much. `avoided` has
  // been looked at in this discrete state. Valid until the next call. Throws ModelFault.
  const Federation& after_delay(std::int32_t* slots, ConstZoneRef entry, const std::vector<Atom>& invariant,
                                const Predicate& avoided);

  // The valuations of a zone from which no delay within the invariant meets a zone of the predicate. Where clocks stand
  // still, or time does, it is the whole zone: this is asked of zones that avoid the predicate.
  const Federation& never_met(ConstZoneRef zone, const std::vector<Atom>& invariant, Delay delay,
                              const Predicate& avoided);

 private:
  // The delays that avoid one zone, from `entry_` within `later_`, into `part_`.
  void avoid_one(ConstZoneRef entry, const std::vector<Atom>& invariant, const std::vector<Atom>& met);
  // What `result_` and `part_` have in common, into `result_`.
  void meet();

  Semantics& semantics_;
  ZoneOperations operations_;
  int dimension_;
  ZoneBuffer later_;
  ZoneBuffer met_;
  ZoneBuffer scratch_;
  std::vector<Atom> atoms_;
  Federation result_;
  Federation part_;
  Federation other_;
};

}  // namespace tachk
