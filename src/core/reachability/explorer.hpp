// The search: one passed list, one order of waiting states, several goals at once.
#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "program/program.hpp"
#include "states/store.hpp"
#include "symbolic/active_clocks.hpp"
#include "symbolic/deadlock.hpp"
#include "symbolic/successor.hpp"
#include "zones/federation.hpp"
#include "zones/zone.hpp"

namespace tachk {

enum class SearchOrder { breadth_first, depth_first, random_depth_first };
enum class Extrapolation { none, max, lu };

struct Options {
  SearchOrder order = SearchOrder::breadth_first;
  std::uint32_t seed = 1;
  Extrapolation extrapolation = Extrapolation::lu;
  bool local_bounds = true;
  bool subsumption = true;
  Width least_width = Width::narrow;
  bool scale = true;
  bool vector = true;
  bool reclaim = true;
  // States with one process in a committed location are passed through, not stored, up to so many in a row.
  std::uint32_t passing = 0;
  std::uint32_t pack_clocks = 16;  // zones of more clocks are stored without those that do not matter
  bool shortest = false;           // breadth first only: no path to a goal is shorter than the one that is found
  std::size_t chunk_words = 8;     // of the parts in which large discrete states are held; 0: in one
  std::uint64_t state_limit = UINT64_MAX;
  std::uint64_t memory_limit = UINT64_MAX;
  std::uint32_t depth_limit = UINT32_MAX;
};

enum class Status {
  running,
  finished,  // every goal is reached, or there is nothing left to explore
  state_limit,
  memory_limit,
  depth_limit,     // finished, but some states were too deep to be explored
  fault,           // the model has a run-time error
  constant_limit,  // without extrapolation: clock values beyond what a bound can hold
};

struct Statistics {
  std::uint64_t explored = 0;
  std::uint64_t stored = 0;
  std::uint64_t transitions = 0;
  std::uint64_t bytes = 0;
};

struct FaultReport {
  FaultKind kind;
  std::int32_t position;                           // of the code word
  std::uint32_t node;                              // the last stored state before it; no_node for the initial state
  std::vector<std::vector<std::uint32_t>> passed;  // actions that lead on from there, through states not stored
  std::vector<std::uint32_t> edges;  // of the action; empty for an invariant of the initial state or a predicate
};

// Diagonal constraints make the usual extrapolations unsound (Bouyer 2004): with diagonals every zone is split along
// them, the pieces are extrapolated by Extra_M and cut back (Bengtsson, Yi 2003).
class Explorer {
 public:
  Explorer(Program program, const Options& options);
  Explorer(const Explorer&) = delete;
  Explorer& operator=(const Explorer&) = delete;

  // Explores at most `expansions` states. `running` asks for another call.
  Status run(std::uint64_t expansions);

  const Program& program() const { return program_; }
  const ZoneOperations& operations() const { return operations_; }
  Statistics statistics() const;
  // The node in which a goal was reached first.
  std::optional<std::uint32_t> reached(std::size_t goal) const;
  const std::optional<FaultReport>& fault() const { return fault_; }
  // The actions, as edge numbers, that lead from the initial state to a node. They are found by going the way again,
  // from one node of the chain of parents to the next.
  std::vector<std::vector<std::uint32_t>> path(std::uint32_t node);
  // Whether these actions, taken one after the other from the initial state, can end in a goal. Asked of an explorer
  // without extrapolation that has not run; false also if clock values become too large on the way.
  bool leads_to(const std::vector<std::vector<std::uint32_t>>& actions, std::size_t goal);

 private:
  // The clock bounds of the locations, each row in a buffer of its own, and a last row without any bound.
  struct Bounds {
    std::vector<BoundRowBuffer> lower;
    std::vector<BoundRowBuffer> upper;
    std::vector<bool> present;
  };
  // A disjunct of an open goal without deadlock.
  struct Watch {
    std::size_t goal;
    const Condition* condition;
  };

  // A state that is not stored.
  struct State {
    std::vector<std::int32_t> slots;
    ZoneBuffer zone;
  };

  // How a state that a path may lead through is reached.
  struct Step {
    std::vector<std::vector<std::uint32_t>> actions;  // more than one where states between were not stored
    std::size_t previous;                             // among the states one step before
  };

  struct Collector;
  struct Recogniser;
  struct Follower;
  struct Prober;

  // A state that is passed through, and the actions that lead to it from the last stored one.
  struct Passing {
    State state;
    std::vector<std::vector<std::uint32_t>> actions;
  };

  Status explore(std::uint64_t expansions);
  // Whether a state is not stored: time cannot pass in it, and it will soon be left.
  bool is_passing(const std::int32_t* slots, std::size_t actions) const;
  void pass_through(std::int32_t* slots, ConstZoneRef zone);
  bool meets_an_open_goal(std::int32_t* slots, ConstZoneRef zone);
  std::vector<std::vector<std::uint32_t>> actions_so_far() const;
  template <class MakeSink>
  void expand_passing(MakeSink&& make_sink);
  template <class Sink>
  void start(Sink&& sink);
  std::uint32_t next_waiting();
  void add(std::uint32_t discrete, std::int32_t* slots, ConstZoneRef zone, std::uint32_t parent);
  void watch_goals();
  // A goal is reached in a node. It may stay open until the end of the layer, for a deadlock one step nearer.
  void settle(std::size_t goal, std::uint32_t node);
  void begin_layer();
  void check(const Watch& watch, std::uint32_t node, std::int32_t* slots, ConstZoneRef zone);
  void check_goals(std::uint32_t node, std::int32_t* slots, ConstZoneRef zone);
  bool meets(const Condition& condition, std::int32_t* slots, ConstZoneRef zone, std::vector<Atom>& atoms);
  // Deadlock check of the state in `source_`. Call `begin_deadlock`, then `expand` (the sink calls `pass_to_deadlock`
  // for each action), then `end_deadlock`.
  void begin_deadlock(ConstZoneRef zone);
  void pass_to_deadlock(ConstZoneRef guarded, const Effect& effect);
  void end_deadlock(std::uint32_t node);
  bool all_reached() const;

  // Goes through the actions of the state in source_ with this zone. Calls sink.possible(guarded, effect) for each that
  // breaks no integer part of an invariant, sink.expect(effect) before the zone of a successor is computed, and
  // sink.take(slots, zone) for every successor, unless sink.wants(slots, zone) has said no to the zone before its
  // abstraction.
  template <class Sink>
  void expand(ConstZoneRef zone, Sink&& sink);
  template <class Sink>
  void expand_by_priority(ConstZoneRef zone, Sink&& sink);
  // The successor of the guarded zone `zone` under `effect`.
  template <class Sink>
  void finish(ConstZoneRef zone, Effect& effect, Sink&& sink);
  template <class Sink>
  void abstract(Effect& effect, ZoneBuffer& zone, Sink&& sink);
  template <class Sink>
  void split(std::size_t diagonal, Effect& effect, const ZoneBuffer& zone, std::vector<Atom>& sides, Sink&& sink);

  void prepare_bounds();
  void collect_bounds(const std::int32_t* slots);
  void check_magnitude(ConstZoneRef zone) const;

  Program program_;
  Options options_;
  ZoneOperations operations_;
  int dimension_;
  Semantics semantics_;
  ActiveClocks active_;
  PassedList passed_;

  std::vector<std::uint32_t> stack_;  // waiting states of the depth-first orders
  std::uint32_t cursor_ = 0;          // next node of the breadth-first order
  std::uint32_t layer_end_ = 0;       // the first node that is one step further from the initial state
  std::vector<Passing> passing_;      // states to be expanded with the current one
  std::vector<std::vector<std::uint32_t>> current_actions_;  // from the current node to the state being expanded
  bool passes_ = false;
  std::vector<std::uint32_t> fresh_;  // nodes added by the current expansion
  std::vector<std::uint32_t> depth_;  // of each node; kept only if there is a limit
  bool too_deep_ = false;
  std::mt19937 random_;

  std::vector<std::uint32_t> reached_;
  std::vector<std::size_t> open_goals_;
  std::vector<bool> asks_deadlock_;                                  // of each goal
  bool deadlock_open_ = false;                                       // some open goal asks for deadlock
  std::vector<std::pair<std::size_t, const Disjunct*>> candidates_;  // for a deadlock in the state being expanded
  DeadlockFinder deadlocks_;
  std::vector<std::vector<Watch>> watches_at_;  // for each location, the disjuncts that ask for it
  std::vector<Watch> watches_anywhere_;

  Bounds bounds_;
  BoundRowBuffer lower_;
  BoundRowBuffer upper_;

  std::vector<std::int32_t> source_;
  ZoneBuffer source_zone_;  // a copy: the state may be covered while it is being expanded
  Effect effect_;
  ZoneBuffer target_;
  ZoneBuffer scratch_;
  std::vector<Atom> goal_atoms_;
  std::vector<Atom> deadlock_atoms_;
  std::vector<ConstBoundRow> lower_rows_;
  std::vector<ConstBoundRow> upper_rows_;
  const std::vector<std::uint32_t>* current_edges_ = nullptr;
  std::uint32_t current_node_ = no_node;

  std::optional<FaultReport> fault_;
  bool started_ = false;
  std::uint64_t explored_ = 0;
  std::uint64_t transitions_ = 0;
};

}  // namespace tachk
