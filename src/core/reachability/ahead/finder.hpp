// What one thread finds: the successors of states, but for those that a stored state covers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "reachability/ahead/harvest.hpp"
#include "reachability/deadlock_watch.hpp"
#include "reachability/goals.hpp"
#include "reachability/measures.hpp"
#include "states/store.hpp"
#include "symbolic/zone_graph.hpp"

namespace tachk {

class Finder final {
 public:
  // How successors are looked at.
  struct Manner {
    bool subsumption;  // not: no state is covered by another one
    bool simulation;   // whether states are dropped for those that simulate them: then it is told also what is covered
    bool slots;        // whether all slots of successors are kept, or their locations only
  };

  Finder(const ZoneGraph& graph, const PassedList& passed, std::uint32_t number);

  // Begins a batch of states: no edge of `taken` need be told.
  void begin(const GoalWatch& goals, const std::vector<std::uint8_t>& taken, const Manner& manner);
  // `place`: of the state in the batch; those that one finder expands come in their order.
  void expand(std::uint32_t node, std::uint32_t place, Expansion& expansion);
  // Whether this is enough for one batch.
  bool full() const { return harvest_.bytes() > most_bytes; }
  // Whether something was found of which parts are not known.
  bool has_unknown() const { return has_unknown_; }
  // Divides what was found into shares, once all of it is known.
  void divide();

  Harvest& harvest() { return harvest_; }
  const Harvest& harvest() const { return harvest_; }
  ZoneGraph& graph() { return graph_; }

 private:
  struct Receiving;
  static constexpr std::size_t most_bytes = std::size_t{1} << 22;
  static constexpr std::size_t places = std::size_t{1} << 12;
  static constexpr std::uint32_t none = UINT32_MAX;

  // Whether one that was found before for the announced state covers the zone.
  bool covers_itself(std::uint32_t discrete, ConstZoneRef zone) const;
  std::uint32_t share(const Found& found) const;

  const PassedList& passed_;
  std::uint32_t number_;
  ZoneGraph graph_;
  GoalWatch goals_;
  DeadlockWatch deadlocks_;
  MeasureWatch measures_;
  DiscreteStates::Reader reader_;
  SymbolicState source_;
  std::vector<std::uint8_t> taken_;
  Manner manner_{};
  Harvest harvest_;
  bool has_unknown_ = false;
  std::vector<std::uint32_t> latest_;  // the last found of a discrete state, among those that share a place
};

}  // namespace tachk
