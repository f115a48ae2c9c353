// Successors of the states that the search is going to expand next, found by several threads before it asks for them.
//
// The threads change nothing: they look at the states stored so far, each with a zone graph of its own, and drop the
// successors that one of these covers. The search then takes what is left, state by state in its own order, and does
// with it what it does with successors that it finds itself. So it stores the same states in the same order however
// many threads there are and whatever each of them does. What has been found stays right while states are added,
// because a state that is covered remains covered.
//
// While the search stores, the other threads expand the first states of the next block, for which they need no store.
#pragma once

#include <atomic>
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

namespace tachk::reachability::ahead {

class Ahead final {
 public:
  Ahead(const symbolic::ZoneGraph& graph, const states::PassedList& passed, bool subsumption, unsigned threads);

  // What was found of a state; nothing if it was not among those that were looked at, or if other goals are open by
  // now. States are asked for in the order in which they were given.
  struct Result {
    Harvest* harvest;
    const Expansion* expansion;
  };
  std::optional<Result> result(std::uint32_t node, const GoalWatch& goals);
  // Whether what was found of a discrete state says how its successors compare with all stored states: with those
  // stored since only as long as none of them was taken to be covered.
  bool knows(std::uint32_t discrete) const {
    return !block_.doubtful || !passed_.has_since(discrete, block_.first_unknown);
  }
  // A state is stored that was taken to be covered, or one that is more than was found.
  void doubt() { block_.doubtful = true; }

  // Looks for the successors of the first `block` of these states, or of fewer. The others are likely to be next.
  // Threads are started unless there are some.
  void look(std::vector<std::uint32_t> nodes, std::size_t block, const GoalWatch& goals,
            const std::vector<std::uint8_t>& taken);
  // The most threads that have looked at the same time.
  unsigned threads() const { return threads_; }
  // Ends the threads until there is more to look for.
  void rest();

 private:
  struct Place {
    std::uint32_t finder;
    std::uint32_t expansion;
  };
  // The states that are looked at together.
  struct Block {
    std::vector<std::uint32_t> nodes;
    std::vector<Place> places = {};   // of their expansions
    std::vector<Place> early = {};    // of those that have been expanded early, among these
    std::size_t next = 0;             // among the nodes
    std::uint32_t first_unknown = 0;  // the first state stored since
    bool doubtful = false;
    std::uint64_t goals_then = 0;
  };
  static constexpr std::uint32_t nobody = UINT32_MAX;
  static constexpr std::size_t fewest_early = 16;
  static constexpr std::size_t most_early = 512;

  // The others end what they do early.
  void interrupt();
  // Finds what has been expanded early in the block; how many states the others have expanded.
  std::size_t place_early();
  void find(const GoalWatch& goals, const std::vector<std::uint8_t>& taken);
  void find(unsigned member, std::atomic<std::size_t>& next);
  // Sifts, and lets the others go on with these states.
  void sift_and_go_on(std::vector<std::uint32_t> further);
  // Of the successors whose keys fall to this share: which ones earlier ones cover.
  void sift(std::uint64_t share, std::uint64_t shares, std::vector<Found*>& latest);
  void compare(Found& found, Found* before) const;
  const Harvest& harvest(const Found& found) const { return finders_[found.finder]->harvest(); }
  bool same_discrete(const Found& one, const Found& other) const;

  const states::PassedList& passed_;
  const symbolic::ZoneGraph& graph_;
  std::vector<std::unique_ptr<Finder>> finders_;
  std::vector<std::vector<Found*>> latest_;  // of each thread: the last one with a discrete state, by keys
  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> share_{0};
  std::atomic<std::uint32_t> sifting_{0};  // how many of the others
  std::size_t early_ = fewest_early;       // how many states each of the others notes
  unsigned threads_ = 1;
  Block block_;
  std::optional<Team> team_;  // ends before what it works on
};

}  // namespace tachk::reachability::ahead
