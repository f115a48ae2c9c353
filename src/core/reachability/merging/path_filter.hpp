// Keeps a search among some discrete states.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <unordered_set>
#include <vector>

#include "symbolic/zone_graph.hpp"

namespace tachk::reachability::merging {

class PathFilter final {
 public:
  explicit PathFilter(std::size_t slots) : slots_(slots) {}

  // From the first call on the search stays among the states that have been added.
  void add(const std::int32_t* slots) { states_.emplace(slots, slots + slots_); }

  bool on_successor(const symbolic::Successor& successor) {
    if (states_.empty()) return true;
    sought_.assign(successor.slots, successor.slots + slots_);
    return states_.contains(sought_);
  }

 private:
  struct Hash {
    std::size_t operator()(const std::vector<std::int32_t>& slots) const {
      std::uint64_t hash = 0xCBF29CE484222325u;
      for (const std::int32_t slot : slots) hash = (hash ^ static_cast<std::uint32_t>(slot)) * 0x100000001B3u;
      return static_cast<std::size_t>(hash ^ (hash >> 32));
    }
  };

  std::size_t slots_;
  std::vector<std::int32_t> sought_;
  std::unordered_set<std::vector<std::int32_t>, Hash> states_;
};

}  // namespace tachk::reachability::merging
