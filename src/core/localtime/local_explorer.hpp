// The search over local times: independent actions that happen in several orders lead to one zone, where the ordinary
// search has one for each order. Finds the same goals.
//
// A state that waits has a zone over local times. What is stored of it is the part in which all agents have the same
// time, which is an ordinary zone of states of the network; a state is covered by a stored one whose abstracted zone
// contains that part (sync-subsumption: Govind, Herbreteau, Srivathsan, Walukiewicz 2019, section 5).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "localtime/local_graph.hpp"
#include "localtime/stuck_states.hpp"
#include "order/waiting.hpp"
#include "program/program.hpp"
#include "reachability/explorer.hpp"
#include "reachability/goals.hpp"
#include "reachability/options.hpp"
#include "states/store.hpp"
#include "zones/patience.hpp"

namespace tachk::localtime {

// The action that led to each node first.
class ActionsTaken final {
 public:
  // Of the next node.
  void add(const symbolic::Edges& action);
  const symbolic::Edges& of(std::uint32_t node) const { return *actions_[numbers_[node]]; }
  std::size_t bytes() const { return numbers_.capacity() * sizeof(std::uint32_t); }

 private:
  std::map<symbolic::Edges, std::uint32_t> known_;
  std::vector<const symbolic::Edges*> actions_;
  std::vector<std::uint32_t> numbers_;
};

// The zones of the nodes that wait.
class WaitingZones final {
 public:
  explicit WaitingZones(std::size_t entries) : entries_(entries) {}

  void add(std::uint32_t node, const std::vector<LocalEntry>& zone);
  std::vector<LocalEntry> take(std::uint32_t node);
  // The memory when most were waiting.
  std::size_t bytes() const {
    return zones_.capacity() * sizeof(decltype(zones_)::value_type) + most_ * entries_ * sizeof(LocalEntry);
  }

 private:
  std::size_t entries_;
  std::size_t count_ = 0;
  std::size_t most_ = 0;
  std::vector<std::vector<LocalEntry>> zones_;
};

class LocalExplorer final {
 public:
  // Throws std::invalid_argument where a LocalGraph does, for options and limits that count steps, and where goals ask
  // for deadlock but bounds are LU.
  LocalExplorer(program::Program program, const reachability::Options& options,
                const reachability::Limits& limits = {});
  LocalExplorer(const LocalExplorer&) = delete;
  LocalExplorer& operator=(const LocalExplorer&) = delete;

  // Explores at most `expansions` stored states. `running` asks for another call. After a run-time error (`fault`) and
  // at a `constant_limit` nothing is known: an ordinary search has to decide.
  reachability::Status run(std::uint64_t expansions);

  reachability::Statistics statistics() const;
  // As `reachability::Explorer::effort`.
  std::uint64_t effort() const;
  // How many discrete states have been seen.
  std::uint32_t discrete_states() const { return passed_.discrete_states(); }
  // True if interchangeable processes are permuted.
  bool permutes() { return graph_.symmetry().active(); }
  // The node in which a goal was reached.
  std::optional<std::uint32_t> reached(std::size_t goal) const;
  // The actions of a run of the network to a goal that has been reached.
  symbolic::Path path_to_goal(std::size_t goal);

 private:
  reachability::Status search(std::uint64_t expansions);
  std::uint32_t next();
  void expand(std::uint32_t node);
  void store(const LocalSuccessor& successor, std::uint32_t parent);
  // The end that a path, without permutations, must have to meet a disjunct.
  std::vector<program::Condition> ends(const program::Disjunct& disjunct, const symbolic::Path& actions);

  reachability::Limits limits_;
  bool subsumption_;
  LocalGraph graph_;
  states::PassedList passed_;
  order::Waiting waiting_;
  WaitingZones zones_;
  ActionsTaken actions_;
  reachability::GoalWatch goals_;
  std::optional<StuckStates> stuck_;  // where goals ask for deadlock
  std::vector<std::int32_t> slots_;   // of the state being expanded
  zones::ZoneBuffer exact_;           // of a successor, before it is abstracted
  std::uint64_t explored_ = 0;
  std::uint64_t transitions_ = 0;
  bool started_ = false;
  zones::InPieces in_pieces_;
};

}  // namespace tachk::localtime
