// What one thread finds: the successors of states, but for those that a stored state covers.
//
// A state is expanded, and then its successors are looked up among the stored states. The first part needs no stored
// state but this one: so it may be done early, while another thread stores.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "reachability/ahead/harvest.hpp"
#include "reachability/deadlock_watch.hpp"
#include "reachability/goals.hpp"
#include "states/store.hpp"
#include "symbolic/zone_graph.hpp"

namespace tachk::reachability::ahead {

class Finder final {
 public:
  Finder(const symbolic::ZoneGraph& graph, const states::PassedList& passed, bool subsumption, std::uint32_t number);

  // Begins a block of states: no edge of `taken` need be told. What has been done early is kept unless goals have been
  // settled since.
  void begin(const GoalWatch& goals, const std::vector<std::uint8_t>& taken);
  void expand(std::uint32_t node);
  // Whether this is enough for one block.
  bool full() const { return (now().zones() + 1) * graph_.operations().bytes > most_bytes; }

  // Notes states of the next block, as long as nobody stores any. Then they may be expanded early, one at a time: false
  // if none is left.
  void note(std::span<const std::uint32_t> nodes);
  bool expand_early();
  // Those that have been expanded early, in order. Each is to be looked up in place of `expand`.
  std::span<const std::uint32_t> early() const { return {early_.nodes.data(), early_.done}; }
  void look_up(std::size_t early);

  Harvest& harvest() { return now(); }
  const Harvest& harvest() const { return now(); }

 private:
  struct Receiving;
  struct Stepping;
  // States of the next block, and how many of them have been expanded; what was found is in the next harvest.
  struct Early {
    std::vector<std::uint32_t> nodes;
    std::vector<symbolic::SymbolicState> sources;  // at least as many
    std::size_t done = 0;
    std::vector<Expansion> expansions;
  };
  static constexpr std::size_t most_bytes = std::size_t{1} << 22;
  static constexpr std::size_t places = std::size_t{1} << 12;

  Harvest& now() { return harvests_[now_]; }
  const Harvest& now() const { return harvests_[now_]; }
  Harvest& next() { return harvests_[1 - now_]; }
  // One that was found before for the same discrete state and covers the zone. It may belong to a state that comes
  // later; then it is not stored yet when the search asks for it, and does not count.
  std::uint32_t own_coverer(const Found& found) const;
  void look(Found& found, const symbolic::Successor& successor);
  // Notes the edges of a transition.
  void count(std::span<const std::uint32_t> edges, Expansion& expansion, Harvest& harvest) const;
  template <class R>
  void expand(symbolic::SymbolicState& source, std::uint32_t node, Harvest& harvest, Expansion& expansion,
              R&& receiver);

  const states::PassedList& passed_;
  bool subsumption_;
  bool whole_;  // zones have one abstraction each
  std::uint32_t number_;
  symbolic::ZoneGraph graph_;
  GoalWatch goals_;
  std::uint64_t goals_then_ = 0;
  DeadlockWatch deadlocks_;
  states::DiscreteStates::Reader reader_;
  symbolic::SymbolicState source_;
  std::vector<std::uint8_t> taken_;
  Harvest harvests_[2];
  std::size_t now_ = 0;
  std::vector<std::uint32_t> latest_;  // the last found of a discrete state, among those that share a place; by keys
  Early early_;
};

}  // namespace tachk::reachability::ahead
