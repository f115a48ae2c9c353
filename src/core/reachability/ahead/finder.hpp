// What one thread finds: the successors of states, but for those that a stored state covers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <utility>
#include <vector>

#include "reachability/deadlock_watch.hpp"
#include "reachability/goals.hpp"
#include "states/store.hpp"
#include "symbolic/zone_graph.hpp"

namespace tachk {

// A successor that no stored state covered when it was found.
struct Found {
  std::uint32_t discrete;     // HashIndex::absent where that discrete state was not known
  std::uint32_t slots;        // where its slots begin
  std::uint32_t zone;         // as the step leads to it
  std::uint32_t abstract;     // abstracted
  std::uint32_t transitions;  // of the state, up to here
  std::uint32_t finder;       // who found it
  std::uint64_t key;          // equal for equal discrete states
  std::uint64_t hash;         // of the abstracted zone as it is stored
  bool further;               // one more abstracted zone of the successor before this one
  bool meets;                 // it may meet a goal
  // That it covers none of the stored states, nor of those found for earlier states, and none of these covers it.
  bool apart;
  const Found* coverer = nullptr;  // found for an earlier state, or earlier for this one; nullptr: none covers it
  Found* before = nullptr;         // the one with the same discrete state that was found before
  std::uint32_t node = no_node;    // its number, once it is stored
};

class Finder final {
 public:
  Finder(const ZoneGraph& graph, const PassedList& passed, bool subsumption, std::uint32_t number);

  // Begins a block of states: no edge of `taken` need be told.
  void begin(const GoalWatch& goals, const std::vector<std::uint8_t>& taken);
  void expand(std::uint32_t node);
  // Whether this is enough for one block.
  bool full() const { return (zones_used_ + 1) * graph_.operations().bytes > most_bytes; }

  // What was found of a state.
  struct Expansion {
    std::size_t first = 0;  // of its successors
    std::size_t last = 0;
    std::size_t first_edge = 0;  // of those taken
    std::size_t last_edge = 0;
    std::uint32_t transitions = 0;
    std::vector<std::size_t> stuck;  // goals that the state satisfies, being stuck or not as they ask
    std::exception_ptr failure;      // behind all this
  };
  // In the order of the calls of `expand`.
  const Expansion& expansion(std::size_t number) const { return expansions_[number]; }
  std::size_t expansions() const { return expansions_.size(); }
  Found& found(std::size_t number) { return found_[number]; }
  const std::int32_t* slots(const Found& found) const { return slots_.data() + found.slots; }
  ConstZoneRef zone(std::uint32_t number) const { return zones_[number].get(); }
  // An edge that was taken, and by which of the transitions of its state.
  std::pair<std::uint32_t, std::uint32_t> edge(std::size_t number) const { return edges_[number]; }

 private:
  struct Receiving;
  static constexpr std::size_t most_bytes = std::size_t{1} << 22;

  std::uint32_t keep(ConstZoneRef zone);
  void look(Found& found, const Successor& successor);

  const PassedList& passed_;
  bool subsumption_;
  std::uint32_t number_;
  ZoneGraph graph_;
  GoalWatch goals_;
  DeadlockWatch deadlocks_;
  DiscreteStates::Reader reader_;
  SymbolicState source_;
  const std::vector<std::uint8_t>* taken_ = nullptr;
  std::size_t zones_used_ = 0;
  // What was found.
  std::vector<ZoneBuffer> zones_;
  std::vector<std::int32_t> slots_;
  std::vector<Found> found_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges_;
  std::vector<Expansion> expansions_;
};

}  // namespace tachk
