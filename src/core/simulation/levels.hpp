// How near a discrete state is to a goal: the more, the nearer.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

namespace tachk::simulation {

class Levels {
 public:
  using Key = std::vector<std::int32_t>;

  // These slots identify a state.
  explicit Levels(std::vector<std::uint32_t> slots) : slots_(std::move(slots)) {}

  Key key(const std::int32_t* slots) const {
    Key result;
    result.reserve(slots_.size());
    for (const std::uint32_t slot : slots_) result.push_back(slots[slot]);
    return result;
  }
  void set(Key key, std::uint32_t level) {
    top_ = std::max(top_, level);
    if (level > 0) levels_[std::move(key)] = level;
  }

  // 0 for a state of which nothing is known.
  std::uint32_t of(const std::int32_t* slots) const {
    const auto found = levels_.find(key(slots));
    return found == levels_.end() ? 0 : found->second;
  }
  std::uint32_t top() const { return top_; }

  struct Hash {
    std::size_t operator()(const Key& key) const {
      std::uint64_t hash = 0x9E3779B97F4A7C15u;
      for (const std::int32_t value : key) {
        hash = (hash ^ static_cast<std::uint32_t>(value)) * 0xBF58476D1CE4E5B9u;
        hash ^= hash >> 29;
      }
      return static_cast<std::size_t>(hash);
    }
  };

 private:
  std::vector<std::uint32_t> slots_;
  std::unordered_map<Key, std::uint32_t, Hash> levels_;
  std::uint32_t top_ = 0;
};

}  // namespace tachk::simulation
