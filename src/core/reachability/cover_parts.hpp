// Stored states for writing: grouped by discrete state, their zones by as few
// constraints as say it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "states/store.hpp"
#include "symbolic/zone_graph.hpp"

namespace tachk::reachability {

// Some of the states. The times are those of the program as it was given, and so are the numbers of clocks. That no
// clock is negative goes without saying.
struct CoverPart {
  std::vector<std::int32_t> discretes;    // of each group its discrete state
  std::vector<std::int64_t> zones;        // of each group how many zones it has
  std::vector<std::int64_t> ranks;        // of each zone its rank
  std::vector<std::int64_t> constraints;  // of each zone how many constraints it has
  std::vector<std::int64_t> places;       // of each constraint left * (clocks + 1) + right
  std::vector<std::int64_t> bounds;       // of each constraint its raw bound
};

class CoverParts final {
 public:
  // The states are those of a graph whose zones are stored whole.
  explicit CoverParts(symbolic::ZoneGraph& graph);

  bool empty() const { return entries_.empty(); }
  // Adds a node that has its zone still. All nodes of a list have ranks, or all have the rank 0.
  void add(states::PassedList& list, std::uint32_t node, std::int64_t rank);
  // How many groups there are: discrete states, once for each list.
  std::size_t groups();
  std::size_t zones() const { return entries_.size(); }
  // The groups from `first` on with about so many zones together.
  CoverPart part(std::size_t first, std::size_t zones);

 private:
  struct Entry {
    std::size_t list;
    std::uint32_t node;
    std::int64_t rank;
  };
  std::uint32_t discrete(const Entry& entry) const { return lists_[entry.list]->discrete(entry.node); }
  void append(zones::ConstZoneRef zone, CoverPart& part) const;

  symbolic::ZoneGraph& graph_;
  std::vector<states::PassedList*> lists_;
  std::vector<Entry> entries_;
  std::vector<std::size_t> first_;  // of each group, in them
};

}  // namespace tachk::reachability
