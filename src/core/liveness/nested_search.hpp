// A search depth first for a run that avoids a predicate for ever: the states on the path, those that have finished,
// and what closes the path. Why dropping states is sound stands in liveness_search.hpp.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "liveness/ends.hpp"
#include "liveness/predicate.hpp"
#include "liveness/restriction.hpp"
#include "liveness/search_stack.hpp"
#include "liveness/violation.hpp"
#include "reachability/options.hpp"
#include "states/store.hpp"
#include "symbolic/zone_graph.hpp"

namespace tachk::liveness {

class NestedSearch final {
 public:
  NestedSearch(symbolic::ZoneGraph& graph, Restriction& restriction, Ends& ends, const reachability::Options& options,
               std::uint32_t depth_limit);

  // True if all states that have been pushed have finished.
  bool idle() const { return stack_.empty(); }
  // Pushes the initial states.
  void start();
  // Pushes those parts of a state in which runs begin.
  void start_in(symbolic::SymbolicState& state, Predicate& begins);
  // Keeps the search among the discrete states that it knows from now on: runs that leave them are not looked for. To
  // be called before anything is pushed.
  void know(const std::int32_t* slots);
  // Pushes those parts of a state in which the predicate does not hold.
  void start_among_known(symbolic::SymbolicState& state);
  // Looks at the state on top. Throws ModelFault, ConstantOverflow.
  void advance();

  // How the path is a run that avoids the predicate for ever, once it is one.
  const std::optional<ViolationKind>& found() const { return found_; }
  // The same run, behind the actions that lead to where the path begins.
  Violation violation(const symbolic::Path& stem);
  // The actions of the path.
  symbolic::Path path();

  // The later a state has finished, the larger is its number.
  states::PassedList& finished() { return passed_; }
  // True if the limit on depth has left nothing out.
  bool complete() const { return complete_; }
  std::uint64_t stored() const { return passed_.stored() + stack_.depth(); }
  std::uint64_t explored() const { return explored_; }
  std::uint64_t transitions() const { return transitions_; }
  std::size_t bytes() const { return passed_.bytes() + stack_.bytes(); }

 private:
  struct Descending;
  struct Finding;
  // An action that leads back to an open state.
  struct Closing {
    std::uint32_t state;
    symbolic::Edges edges;
  };

  void expand();
  void push(const symbolic::Successor& successor);
  // As `push`, where the slots are not those announced: those of a part, whose processes have been sorted.
  void push_sorted(const symbolic::Successor& part);
  void unpack(std::uint32_t number);
  symbolic::Edges edges_between(std::uint32_t from, std::uint32_t to);

  symbolic::ZoneGraph& graph_;
  Restriction& restriction_;
  Ends& ends_;
  bool subsumption_;
  std::uint32_t depth_limit_;
  std::uint32_t known_ = UINT32_MAX;  // discrete states with this number and larger ones are left out
  states::PassedList passed_;
  SearchStack stack_;
  symbolic::SymbolicState source_;
  std::optional<Closing> closing_;  // of the state being expanded
  std::optional<ViolationKind> found_;
  std::uint64_t explored_ = 0;
  std::uint64_t transitions_ = 0;
  bool complete_ = true;
};

}  // namespace tachk::liveness
