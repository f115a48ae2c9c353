// The search for a run that avoids a predicate q for ever and meets each of some other predicates infinitely often.
//
// Depth first through the zone graph without q (Restriction), in which states are the same only if their zones are
// equal. A strongly connected component that meets all predicates is such a run, and each such run stays in one at
// last: every path of the graph is that of a run.
//
// A state that contains a later one closes no loop here: the path between has to meet the predicates, and from the
// smaller state it may not. But what lies inside a state of a finished component is dropped: it has no such run,
// because the larger one has none (A. Laarman, M. Olesen, A. Dalsgaard, K. Larsen, J. van de Pol, "Multi-core emptiness
// checking of timed Buechi automata using inclusion abstraction", CAV 2013).
#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "liveness/components.hpp"
#include "liveness/ends.hpp"
#include "liveness/reachable.hpp"
#include "liveness/restriction.hpp"
#include "liveness/violation.hpp"
#include "reachability/explorer.hpp"
#include "states/store.hpp"
#include "symbolic/zone_graph.hpp"
#include "zones/patience.hpp"

namespace tachk::liveness {

class RecurrenceSearch final {
 public:
  // The goals of the program are q; where a run may end; if `begins`, where it may begin to avoid q, else that is the
  // initial state; and what it meets again and again, which are predicates without clocks, as is the second one. Zones
  // must not be widened in one direction only, lest a run seem stuck that is not.
  RecurrenceSearch(program::Program program, bool begins, const reachability::Options& options,
                   const reachability::Limits& limits = {});
  RecurrenceSearch(const RecurrenceSearch&) = delete;
  RecurrenceSearch& operator=(const RecurrenceSearch&) = delete;

  // Takes so many steps of the search. `running` asks for another call, `finished` without a violation says that there
  // is no such run.
  reachability::Status run(std::uint64_t steps);

  reachability::Statistics statistics() const;
  const std::optional<Violation>& violation() const { return violation_; }
  const std::optional<LivenessFault>& fault() const { return fault_; }
  // True if runs can begin in some state that has been reached.
  bool begins() const { return !question_.begins || !beginnings_.origins.empty(); }

 private:
  using State = Components::State;
  using Marks = Components::Marks;  // one bit for each predicate that is to be met again and again

  // Which runs count.
  struct Question {
    Predicate ending;
    std::optional<Predicate> begins;
    std::vector<Predicate> again;
  };
  // Where runs may begin: with `begins` everything is reached first.
  struct Beginnings {
    Reachable reachable;
    bool reaching;
    State next = 0;                                    // the next reached state that is looked at
    std::uint32_t origin = states::no_node;            // the one whose parts are being added
    std::unordered_map<State, std::uint32_t> origins;  // the reached state that a state is a part of
  };
  // On the path: a state, and the steps from it that have not been taken: those from `first` to the next one's.
  struct Visit {
    State state;
    std::size_t first;
  };
  struct Way {
    std::vector<Visit> path;
    std::vector<State> steps;
    State expanded = states::no_node;  // the state that is being expanded
    bool complete = true;              // whether the limit on depth has left nothing out
    zones::InPieces pieces = {};
  };
  struct Step {
    State state;
    symbolic::Edges edges;
  };
  struct Exploring;
  struct Listing;

  reachability::Status search(std::uint64_t steps);
  std::uint64_t stored() const;
  bool advance();
  void reach();
  bool start();
  void visit(State state);
  void open(State state);
  void expand(State state);
  void close();
  void join(State state);
  void retire(State state);
  bool is_hopeless(std::uint32_t discrete, states::ZoneView zone) const;
  void push(const symbolic::Successor& successor);
  void add(const symbolic::Successor& successor);
  Marks all_marks() const;
  Marks marks_of(const symbolic::Successor& successor);
  void unpack(State state, symbolic::SymbolicState& into);

  void found_end(EndKind ending);
  void found_loop(State entrance);
  // The steps from a state to states that have been seen.
  std::vector<Step> steps_from(State state);
  // Appends the actions of a short way within the newest component, of at least one step, to a state with some of these
  // marks; without marks to `target`. The state at its end.
  State go(State from, Marks wanted, State target, symbolic::Path& path);
  symbolic::Path path_to_state(State state, std::size_t& begins);
  symbolic::Path path_so_far();

  reachability::Options options_;
  reachability::Limits limits_;
  symbolic::ZoneGraph graph_;
  Restriction restriction_;
  Ends ends_;
  Question question_;
  Beginnings beginnings_;
  states::PassedList states_;
  Components components_;
  std::vector<std::vector<State>> hopeless_;  // for each discrete part: states of finished components, the largest
  Way way_;
  symbolic::SymbolicState source_;
  reachability::Statistics done_;  // without what is reached first
  std::optional<Violation> violation_;
  std::optional<LivenessFault> fault_;
};

}  // namespace tachk::liveness
