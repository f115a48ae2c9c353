// Where a run may end that avoids a predicate: valuations of one symbolic state in which time can pass for ever, or
// from which nothing can happen any more, without the predicate becoming true. The possible actions are visited while
// the state is expanded: begin, pass for every possible action, end.
#pragma once

#include <optional>
#include <vector>

#include "liveness/avoidance.hpp"
#include "liveness/predicate.hpp"
#include "symbolic/dead_states.hpp"
#include "symbolic/deadlock.hpp"
#include "symbolic/zone_graph.hpp"

namespace tachk::liveness {

enum class EndKind {
  idle,   // time passes for ever
  stuck,  // no action is possible, now or after any delay, and time does not pass for ever
};

class Ends final {
 public:
  explicit Ends(symbolic::ZoneGraph& graph);

  // `avoided` is looked at in the state. Throws ModelFault.
  void begin(symbolic::SymbolicState& source, Predicate& avoided);
  // True if time can pass for ever, which is known from the beginning.
  bool idle() const { return idle_; }
  void pass(zones::ConstZoneRef guarded, const symbolic::Effect& effect);
  // An end in the state, if there is one. With bounds that widen zones in one direction only (LU) a valuation may seem
  // stuck that stands for true ones that are not; an idle one stands for idle ones. Throws ModelFault.
  std::optional<EndKind> end();

 private:
  bool may_idle(symbolic::Delay delay, const std::uint8_t* stopped) const;
  bool may_be_stuck(zones::ConstZoneRef zone, const zones::Federation& dead);
  bool is_stuck(zones::ConstZoneRef zone);

  symbolic::Semantics& semantics_;
  zones::ZoneOperations operations_;
  int dimension_;
  Avoidance avoidance_;
  symbolic::DeadlockFinder finder_;
  symbolic::DeadStates dead_;
  std::int32_t* slots_ = nullptr;
  std::vector<zones::Atom> invariant_;
  std::vector<zones::Atom> atoms_;
  const zones::Federation* never_ = nullptr;  // from where the predicate is not met
  bool idle_ = false;
};

}  // namespace tachk::liveness
