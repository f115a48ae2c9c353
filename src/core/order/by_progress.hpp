// The states that wait, those that have come least far first (Progress), among them the oldest first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "order/progress.hpp"
#include "states/store.hpp"

namespace tachk::order {

class ByProgress final {
 public:
  // Those with numbers from `first_waiting` on wait, unless they are covered.
  ByProgress(const program::Program& program, states::PassedList& states, std::uint32_t first_waiting);

  // The state taken last is going to be expanded; its slots.
  void begin(const std::int32_t* slots) { locations_.assign(slots, slots + progress_.processes()); }
  // A new state that follows from that one.
  void add(std::uint32_t node, const std::int32_t* slots) {
    wait(node, beyond(far_, progress_.between(locations_.data(), slots)));
  }
  // The next in order; no_node if none is left.
  std::uint32_t next();

  std::size_t bytes() const { return waiting_ * sizeof(std::uint32_t); }

 private:
  struct Queue {
    std::vector<std::uint32_t> nodes;
    std::size_t taken = 0;
  };

  static std::uint32_t beyond(std::uint32_t far, std::uint32_t step) {
    return far > UINT32_MAX - step ? UINT32_MAX : far + step;
  }
  void wait(std::uint32_t node, std::uint32_t far) {
    queues_[far].nodes.push_back(node);
    ++waiting_;
  }

  Progress progress_;
  std::map<std::uint32_t, Queue> queues_;  // by how far their states have come
  std::size_t waiting_ = 0;
  std::uint32_t far_ = 0;  // of the state taken last
  std::vector<std::int32_t> locations_;
};

}  // namespace tachk::order
