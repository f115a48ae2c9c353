// Numbers of states in queues by a key: the least key first, among those of one key the oldest first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "states/store.hpp"

namespace tachk::order {

class Buckets final {
 public:
  void add(std::uint32_t node, std::uint32_t key) {
    queues_[key].nodes.push_back(node);
    ++waiting_;
  }

  // The next in order, with its key in `key`; no_node if none is left.
  std::uint32_t next(std::uint32_t& key) {
    while (!queues_.empty()) {
      const auto first = queues_.begin();
      Queue& queue = first->second;
      if (queue.taken < queue.nodes.size()) {
        key = first->first;
        --waiting_;
        return queue.nodes[queue.taken++];
      }
      queues_.erase(first);
    }
    return states::no_node;
  }

  std::size_t bytes() const { return waiting_ * sizeof(std::uint32_t); }

 private:
  struct Queue {
    std::vector<std::uint32_t> nodes;
    std::size_t taken = 0;
  };

  std::map<std::uint32_t, Queue> queues_;
  std::size_t waiting_ = 0;
};

}  // namespace tachk::order
