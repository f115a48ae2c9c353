// Successors of the states that the search is going to expand next, found by several threads before it asks for them.
//
// The threads change nothing: they look at the states stored so far, each with a zone graph of its own, and drop the
// successors that one of these covers. The search then takes what is left, state by state in its own order, and does
// with it what it does with successors that it finds itself. So it stores the same states in the same order however
// many threads there are and whatever each of them does. What has been found stays right while states are added,
// because a state that is covered remains covered.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "reachability/ahead/finder.hpp"
#include "reachability/ahead/team.hpp"
#include "reachability/goals.hpp"
#include "states/store.hpp"
#include "symbolic/zone_graph.hpp"

namespace tachk {

class Ahead final {
 public:
  Ahead(const ZoneGraph& graph, const PassedList& passed, bool subsumption, unsigned threads);

  // What was found of a state, and by whom; nothing if it was not among those that were looked at, or if other goals
  // are open by now. States are asked for in the order in which they were given.
  struct Result {
    Finder* finder;
    const Finder::Expansion* expansion;
  };
  std::optional<Result> result(std::uint32_t node, const GoalWatch& goals);
  // Whether what was found of a discrete state says how its successors compare with all stored states: with those
  // stored since only as long as none of them was taken to be covered.
  bool knows(std::uint32_t discrete) const { return !doubtful_ || !passed_.has_since(discrete, first_unknown_); }
  // A state is stored that was taken to be covered, or one that is more than was found.
  void doubt() { doubtful_ = true; }

  // Looks for the successors of these states, or of the first of them. Threads are started unless there are some.
  void look(std::vector<std::uint32_t> nodes, const GoalWatch& goals, const std::vector<std::uint8_t>& taken);
  // The most threads that have looked at the same time.
  unsigned threads() const { return threads_; }
  // Ends the threads until there is more to look for.
  void rest() { team_.reset(); }

 private:
  struct Place {
    std::uint32_t finder;
    std::uint32_t expansion;
  };
  static constexpr std::uint32_t nobody = UINT32_MAX;

  // Of the successors whose keys fall to this share: which ones earlier ones cover.
  void sift(std::uint64_t share, std::uint64_t shares, std::vector<Found*>& latest);
  void compare(Found& found, Found* before) const;
  bool same_discrete(const Found& one, const Found& other) const;

  const PassedList& passed_;
  const ZoneGraph& graph_;
  std::vector<std::unique_ptr<Finder>> finders_;
  std::vector<std::vector<Found*>> latest_;  // of each thread: the last one with a discrete state, by keys
  std::optional<Team> team_;
  unsigned threads_ = 1;
  std::vector<std::uint32_t> nodes_;
  std::vector<Place> places_;        // of their expansions
  std::size_t next_ = 0;             // among them
  std::uint32_t first_unknown_ = 0;  // the first state stored since
  bool doubtful_ = false;
  std::uint64_t goals_then_ = 0;
};

}  // namespace tachk
