// Which open goals a deadlock in the state being expanded satisfies. Whether valuations of a state are stuck follows
// from its actions, so that the watch observes each of them (Observers).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "program/program.hpp"
#include "reachability/goals.hpp"
#include "symbolic/deadlock.hpp"
#include "symbolic/zone_graph.hpp"

namespace tachk::reachability {

class DeadlockWatch final {
 public:
  DeadlockWatch(symbolic::ZoneGraph& graph, GoalWatch& goals);

  // True if some open goal may contain deadlock; otherwise the rest does nothing.
  bool open() const { return open_; }

  // True if the actions of the state being expanded matter.
  bool counts() const { return !candidates_.empty(); }

  // Goals whose predicates are a run-time error fail. Throws ModelFault. `node` is the number of the state.
  void before_expand(std::uint32_t node, symbolic::SymbolicState& source);
  void possible(zones::ConstZoneRef guarded, const symbolic::Effect& effect);
  // Throws ModelFault.
  void after_expand(std::uint32_t node, symbolic::SymbolicState& source);

 private:
  struct Candidate {
    std::size_t goal;
    const program::Disjunct* disjunct;
  };

  // True if the state, where it is stuck or not as the goal says, satisfies the rest.
  bool meets(const Candidate& candidate, std::uint32_t node, symbolic::SymbolicState& source);
  // The open disjuncts whose predicates the state satisfies.
  void find_candidates(std::uint32_t node, symbolic::SymbolicState& source);

  const program::Program& program_;
  symbolic::Semantics& semantics_;
  GoalWatch& goals_;
  symbolic::DeadlockFinder finder_;
  std::vector<Candidate> candidates_;
  std::vector<zones::Atom> atoms_;
  bool has_deadlock_;  // of some goal
  bool open_;
};

}  // namespace tachk::reachability
