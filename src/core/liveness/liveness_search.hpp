// The search for a run that avoids a predicate q for ever: depth first, with subsumption in both directions.
//
// The search goes through the zone graph without q (Restriction). A successor whose zone contains that of a state on
// the path to it closes a loop. A successor inside a finished state is dropped. Every state on the way is checked
// whether a run can end in it (Ends). Of `p --> q` the runs begin in each reachable state in which p holds and q does
// not, and share the finished states.
//
// A small part of the steps is taken depth first while the states are being reached: a run is found early.
//
// Before it, or once it has taken a while, a search breadth first looks for a proof that there is no run
// (CoveredGraph): depth first, runs are found soon, but to see that there is none takes several times as many states.
// Where the covered graph has circles, a search depth first among the discrete states of those completes the proof: a
// run stays there from some moment on, and its states from then on lie in states from which that search begins. What
// it finds is a run from a reachable state, but of p --> q none from where p holds: then the search goes on as without.
//
// A loop w ->+ v with w inside v is an infinite run: every valuation of v is simulated by one that a valuation of w
// leads to, hence for any number of rounds some valuation of w can go them all. Dropping is sound because a valuation
// that was expanded in a finished state has its successors in states that finished earlier: an infinite run would
// descend for ever. Which of the two tests comes first does not matter for the answer (docs/decisions/liveness.md).
// S. Wimmer and P. Lammich verified the algorithm, "Verified model checking of timed automata", TACAS 2018; A. Laarman,
// M. Olesen, A. Dalsgaard, K. Larsen, J. van de Pol, "Multi-core emptiness checking of timed Buechi automata using
// inclusion abstraction", CAV 2013, say when subsumption is sound.
#pragma once

#include <cstdint>
#include <optional>

#include "liveness/covered_graph.hpp"
#include "liveness/ends.hpp"
#include "liveness/nested_search.hpp"
#include "liveness/reachable.hpp"
#include "liveness/restriction.hpp"
#include "liveness/stuck_path.hpp"
#include "liveness/violation.hpp"
#include "reachability/cover_parts.hpp"
#include "reachability/explorer.hpp"
#include "states/store.hpp"
#include "symbolic/zone_graph.hpp"
#include "zones/patience.hpp"

namespace tachk::liveness {

class LivenessSearch final {
 public:
  // The first goal of the program is q, the second, if there is one, p.
  LivenessSearch(program::Program program, const reachability::Options& options,
                 const reachability::Limits& limits = {});
  LivenessSearch(const LivenessSearch&) = delete;
  LivenessSearch& operator=(const LivenessSearch&) = delete;

  // Takes so many steps of the search. `running` asks for another call, `finished` without a violation says that there
  // is none.
  reachability::Status run(std::uint64_t steps);

  reachability::Statistics statistics() const;
  const std::optional<Violation>& violation() const { return violation_; }
  const std::optional<LivenessFault>& fault() const { return fault_; }
  // Of p --> q: whether p holds in some state that has been reached. True where there is no p.
  bool begins() const { return !overview_.begins || overview_.met; }
  // Of a finished search without a violation: the finished states, whose ranks tell the order in which they finished,
  // and of p --> q all that are reachable, with the rank 0. It needs zones that are stored whole and not reclaimed,
  // and no search for another proof.
  reachability::CoverParts& cover();
  // True if these actions can end in a state that is stuck and avoid q from action number `begins` on. For a
  // search without extrapolation that has not run; false also if clock values become too large on the way.
  bool gets_stuck(const symbolic::Path& actions, std::size_t begins);

 private:
  enum class Stage { reaching, proving, circling, descending };
  // Where runs begin, and what is reachable: of p --> q all states, else those of the restricted graph.
  struct Overview {
    std::optional<Predicate> begins;  // none: the initial states
    Reachable reachable;
    std::optional<CoveredGraph> proof;  // being looked for
    Stage stage;
    bool proves;                            // whether a proof is still to be looked for
    std::uint32_t begun = states::no_node;  // the reached state in which the path begins
    std::uint32_t next = 0;                 // the next one that is looked at
    bool depth_first = false;               // reaching: whether the step at hand is depth first
    std::uint64_t explored_before = 0;      // reaching: how many states had been explored depth first before
    bool met = false;                       // whether p holds in one of the reached states
    bool complete = true;                   // reaching: whether the limit on depth has left nothing out
    zones::InPieces pieces = {};
  };
  Overview overview();
  reachability::Status search(std::uint64_t steps);
  std::uint64_t stored() const;
  bool advance();
  bool is_time_for_depth_first() const;
  void reach();
  void note_beginning();
  bool prove();
  bool follow_circles();
  bool circle();
  bool descend();
  bool start();
  bool complete() const { return proved_ || (overview_.complete && nested_.complete()); }
  symbolic::Path stem();
  symbolic::Path path_so_far();

  reachability::Options options_;
  reachability::Limits limits_;
  symbolic::ZoneGraph graph_;
  Restriction restriction_;
  Ends ends_;
  Overview overview_;
  NestedSearch nested_;
  std::optional<NestedSearch> among_circles_;
  std::size_t next_circular_ = 0;  // of the states on circles, the next one from which it begins
  symbolic::SymbolicState source_;
  bool proved_ = false;
  std::optional<Violation> violation_;
  std::optional<LivenessFault> fault_;
  reachability::CoverParts parts_;
};

}  // namespace tachk::liveness
