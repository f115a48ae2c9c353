// Symbolic states with how many events of each stream have happened, of which none covers another one. There are few of
// them, so they are kept as they are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "symbolic/zone_graph.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk::estimation {

class StateSet final {
 public:
  struct Node {
    std::vector<std::int32_t> slots;
    std::vector<std::uint32_t> positions;  // by stream, how many events have happened
    zones::ZoneBuffer zone;
    std::uint32_t lead;       // the number of the first event on the way to it
    std::vector<bool> taken;  // the marks of edges that were taken on the way to it
    bool covered = false;     // by another one
  };

  // Adds a state, unless another one covers it.
  void add(const symbolic::ZoneGraph& graph, const std::int32_t* slots, const std::vector<std::uint32_t>& positions,
           zones::ConstZoneRef zone, std::uint32_t lead, const std::vector<bool>& taken);
  std::size_t size() const { return nodes_.size(); }
  Node& operator[](std::size_t number) { return nodes_[number]; }
  std::vector<Node>& nodes() { return nodes_; }

 private:
  using Key = std::vector<std::int32_t>;  // slots and positions
  struct KeyHash {
    std::size_t operator()(const Key& key) const;
  };

  std::vector<Node> nodes_;
  std::unordered_map<Key, std::vector<std::uint32_t>, KeyHash> places_;
};

}  // namespace tachk::estimation
