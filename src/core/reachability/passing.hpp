// States that are passed through: explored as soon as the state that leads to them, and not stored. Time cannot pass in
// them, and they are soon left, because exactly one process is in a committed location.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "symbolic/zone_graph.hpp"

namespace tachk::reachability {

class PassingStates final {
 public:
  // Up to `most` in a row are passed through.
  PassingStates(symbolic::ZoneGraph& graph, std::uint32_t most) : graph_(graph), most_(most) {}

  // A stored state is going to be expanded; `allowed`: whether any may be passed through on the way from there.
  void begin(bool allowed) {
    waiting_.clear();
    actions_.clear();
    seen_.clear();
    allowed_ = allowed && most_ != 0;
  }

  // Whether a successor of the state being expanded is to be passed through.
  bool passes(const symbolic::Successor& successor) const {
    return allowed_ && !successor.edges.empty() && actions_.size() < most_ && will_be_left(successor.slots);
  }
  // Unless it has been added before, with as few actions.
  void add(const symbolic::Successor& successor);
  bool any() const { return !waiting_.empty(); }
  std::size_t bytes() const { return seen_.size() * bytes_each_; }

  // Moves one of those that have been added into `state`, to be expanded next; false if there is none.
  bool next(symbolic::SymbolicState& state);

  // The actions that lead from the stored state to the one being expanded, and to a successor of it.
  const symbolic::Path& actions() const { return actions_; }
  symbolic::Path actions_to(const symbolic::Successor& successor) const;

 private:
  struct Passing {
    symbolic::SymbolicState state;
    symbolic::Path actions;
  };

  bool will_be_left(const std::int32_t* slots) const;

  symbolic::ZoneGraph& graph_;
  std::uint32_t most_;
  bool allowed_ = false;
  std::vector<Passing> waiting_;
  std::unordered_map<std::string, std::size_t> seen_;  // states, and with how few actions
  std::size_t bytes_each_ = 0;
  symbolic::Path actions_;
};

}  // namespace tachk::reachability
