// The states that wait, those that have come least far first (Progress), among them the oldest first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "order/orders.hpp"
#include "order/progress.hpp"

namespace tachk::order {

class ByProgress final : public Order {
 public:
  explicit ByProgress(const Beginning& at) : progress_(at.program) {}

  void start(const Beginning& at) override;

  void begin(const std::int32_t* slots) override { locations_.assign(slots, slots + progress_.processes()); }
  void add(const NewState& state) override {
    wait(state.node, beyond(far_, progress_.between(locations_.data(), state.slots)));
  }
  std::uint32_t next() override;
  std::size_t bytes() const override { return waiting_ * sizeof(std::uint32_t); }

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
