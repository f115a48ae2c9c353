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

namespace tachk::liveness {

class Avoidance final {
 public:
  Avoidance(symbolic::Semantics& semantics, const zones::ZoneOperations& operations);

  // The states that a zone, which lies within the invariant, reaches by delays within the invariant during which no
  // zone of the predicate is met, not even at their beginning or end. Where clocks stand still it may be too much.
  // `avoided` has been looked at in this discrete state. Valid until the next call. Throws ModelFault.
  const zones::Federation& after_delay(std::int32_t* slots, zones::ConstZoneRef entry,
                                       const std::vector<zones::Atom>& invariant, const Predicate& avoided);

  // The valuations of a zone from which no delay within the invariant meets a zone of the predicate. Where clocks stand
  // still, or time does, it is the whole zone: the argument is a zone that avoids the predicate.
  const zones::Federation& never_met(zones::ConstZoneRef zone, const std::vector<zones::Atom>& invariant,
                                     symbolic::Delay delay, const Predicate& avoided);

 private:
  // The delays that avoid one zone, from `entry_` within `later_`, into `part_`.
  void avoid_one(zones::ConstZoneRef entry, const std::vector<zones::Atom>& invariant,
                 const std::vector<zones::Atom>& met);
  // The intersection of `result_` and `part_`, into `result_`.
  void meet();

  symbolic::Semantics& semantics_;
  zones::ZoneOperations operations_;
  int dimension_;
  zones::ZoneBuffer later_;
  zones::ZoneBuffer met_;
  zones::ZoneBuffer scratch_;
  std::vector<zones::Atom> atoms_;
  zones::Federation result_;
  zones::Federation part_;
  zones::Federation other_;
};

}  // namespace tachk::liveness
