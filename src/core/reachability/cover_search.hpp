// A proof that no goal can be reached: symbolic states that together cover whatever is reachable, as few as possible.
//
// The search keeps for each discrete state the hull of all zones that arrive there, a larger set than is reachable. If
// it meets a goal, that may be due to hulls: the discrete states on the way whose zones were widened keep all their
// zones from then on, and the search begins again. What is found is closed under successors by construction, but
// a proof is checked by other means (certificates/). States from which traps keep every run away from the goal are left
// out, where the proof is to carry these traps.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_set>
#include <vector>

#include "order/waiting.hpp"
#include "program/program.hpp"
#include "reachability/cover_parts.hpp"
#include "reachability/deadlock_watch.hpp"
#include "reachability/explorer.hpp"
#include "reachability/goals.hpp"
#include "reachability/options.hpp"
#include "reachability/pruning/lost_states.hpp"
#include "reachability/pruning/traps.hpp"
#include "states/store.hpp"
#include "symbolic/zone_graph.hpp"
#include "zones/patience.hpp"

namespace tachk::reachability {

class CoverSearch final {
 public:
  // `hulls`: off, every zone is kept, and the cover is what an Explorer stores. States are left out that lie in one of
  // the traps of each clause, if there are clauses.
  CoverSearch(program::Program program, const Options& options, const Limits& limits, bool hulls,
              const std::vector<pruning::Trap>& traps, const std::vector<std::vector<std::size_t>>& clauses);
  CoverSearch(const CoverSearch&) = delete;
  CoverSearch& operator=(const CoverSearch&) = delete;

  // Explores at most so many states. `running` asks for another call; `finished`: there is a cover unless `reached`.
  Status run(std::uint64_t expansions);
  // A goal is reached, and no hull is to blame.
  bool reached() const { return reached_; }
  Statistics statistics() const;

  // Of a finished search: what covers all that can be reached.
  CoverParts& cover();

 private:
  using Key = std::vector<std::int32_t>;
  struct KeyHash {
    std::size_t operator()(const Key& key) const;
  };
  enum class Mode : std::uint8_t { unknown, hull, exact };

  // All that is given up when the search begins again.
  struct Search {
    Search(symbolic::ZoneGraph& graph, const Options& options, const pruning::Aims& aims);

    states::PassedList passed;
    order::Waiting waiting;
    GoalWatch goals;
    DeadlockWatch deadlocks;
    pruning::LostStates lost;
    std::vector<Mode> modes;            // of each discrete state
    std::vector<std::uint32_t> latest;  // of each discrete state with hulls: the node that has it
    std::vector<bool> widened;          // of each node: its zone is a hull
    bool started = false;
  };
  struct Keeping;

  Status search(std::uint64_t expansions);
  void expand(std::uint32_t node);
  void keep(const symbolic::Successor& successor, std::uint32_t discrete);
  Mode mode(std::uint32_t discrete, const std::int32_t* slots);
  // Begins again with fewer hulls; false if there are none on the way to the node.
  bool refine(std::uint32_t node);
  void keep_all_zones_of(const std::int32_t* slots);
  Key locations(const std::int32_t* slots) const;
  Key state(const std::int32_t* slots) const;

  Options options_;
  Limits limits_;
  symbolic::ZoneGraph graph_;
  bool hulls_;
  std::unique_ptr<Search> search_;
  std::unordered_set<Key, KeyHash> exact_;  // discrete states, or locations only, that keep all zones
  int searches_ = 1;
  symbolic::SymbolicState source_;
  zones::ZoneBuffer hull_;
  std::uint32_t node_ = states::no_node;
  std::uint64_t explored_ = 0;
  std::uint64_t transitions_ = 0;
  bool reached_ = false;
  CoverParts parts_;
  zones::InPieces in_pieces_;
};

}  // namespace tachk::reachability
