// A short proof that no run avoids a predicate for ever, where it succeeds. Every reachable valuation is in a stored
// state, and every successor of a stored state in a stored state that covers it. If the graph of the stored states with
// these steps has no circle among those where the predicate can be false, and no run can end in them, then there is no
// such run. The converse is wrong: covering a state by a larger one can close a circle that no run goes through (F.
// Herbreteau, B. Srivathsan, T. Tran, I. Walukiewicz, "Why liveness for timed automata is hard, and what we can do
// about it", FSTTCS 2016, who search like this first, and then only where there are circles).
//
// A run that does not end takes a path of this graph: from some moment on it stays in one strongly connected component,
// and each of its states lies in a state on a circle. So it is enough to look for it there.
#pragma once

#include <cstdint>
#include <vector>

#include "liveness/circles.hpp"
#include "liveness/covering_steps.hpp"
#include "liveness/ends.hpp"
#include "liveness/predicate.hpp"
#include "liveness/reachable.hpp"
#include "liveness/restriction.hpp"
#include "symbolic/zone_graph.hpp"

namespace tachk::liveness {

class CoveredGraph final {
 public:
  enum class Answer {
    unknown_yet,
    proved,
    circles,  // each run comes to states on circles for ever
    open,     // there may be a run or not
  };

  // `reachable` has gone through all states, of the restricted graph if its own restriction is this one; if it has
  // recorded the steps, no run ends in a state. `begins`: the states where runs begin; without it those are the initial
  // ones.
  CoveredGraph(symbolic::ZoneGraph& graph, Restriction& restriction, Ends& ends, Reachable& reachable,
               Predicate* begins)
      : graph_(graph), restriction_(restriction), ends_(ends), reachable_(reachable), begins_(begins) {}

  // Looks at one more state. Throws ModelFault, ConstantOverflow; then too the question is open.
  Answer advance(symbolic::SymbolicState& source);

  // Behind the answer `circles`: the states that lie on one.
  const std::vector<std::uint32_t>& circular() const { return circles_.circular(); }
  // How many states have been looked at.
  std::uint32_t entered() const { return circles_.entered(); }

  std::uint64_t explored() const { return explored_; }
  std::uint64_t transitions() const { return transitions_; }
  std::size_t bytes() const { return circles_.bytes() + (steps_.capacity() + path_.capacity()) * sizeof(State); }

 private:
  using State = std::uint32_t;
  // A state on the path, with the steps from it that have not been taken: those from `first` to the next one's.
  struct Visit {
    State state;
    std::size_t first;
  };
  struct Stepping;

  bool begin(symbolic::SymbolicState& source);
  void step(State state);
  void step(CoveringSteps::Reader recorded);
  bool visit(State state, symbolic::SymbolicState& source);

  symbolic::ZoneGraph& graph_;
  Restriction& restriction_;
  Ends& ends_;
  Reachable& reachable_;
  Predicate* begins_;
  Circles circles_;
  std::vector<Visit> path_;
  std::vector<State> steps_;  // where those on the path and the initial ones lead
  State next_ = 0;
  bool open_ = false;
  std::uint64_t explored_ = 0;
  std::uint64_t transitions_ = 0;
};

}  // namespace tachk::liveness
