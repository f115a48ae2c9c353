// Some discrete states, told apart from all others: a search may be made to stay among them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <unordered_set>
#include <vector>

namespace tachk::reachability::merging {

class Corridor final {
 public:
  explicit Corridor(std::size_t slots) : slots_(slots) {}

  void add(const std::int32_t* slots) { states_.emplace(slots, slots + slots_); }
  bool contains(const std::int32_t* slots) {
    sought_.assign(slots, slots + slots_);
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
