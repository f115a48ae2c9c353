// The states that wait, those that have come least far first (Progress), among them the oldest first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "order/buckets.hpp"
#include "order/orders.hpp"
#include "order/progress.hpp"

namespace tachk::order {

class ByProgress final : public Order {
 public:
  explicit ByProgress(const Beginning& at) : progress_(at.program) {}

  void start(const Beginning& at) override;

  void begin(const std::int32_t* slots) override { locations_.assign(slots, slots + progress_.processes()); }
  void add(const NewState& state) override {
    waiting_.add(state.node, beyond(far_, progress_.between(locations_.data(), state.slots)));
  }
  std::uint32_t next() override { return waiting_.next(far_); }
  std::size_t bytes() const override { return waiting_.bytes(); }

 private:
  static std::uint32_t beyond(std::uint32_t far, std::uint32_t step) {
    return far > UINT32_MAX - step ? UINT32_MAX : far + step;
  }

  Progress progress_;
  Buckets waiting_;        // by how far the states have come
  std::uint32_t far_ = 0;  // of the state taken last
  std::vector<std::int32_t> locations_;
};

}  // namespace tachk::order
