// Whether several threads are faster than one: now and then a stretch of the search is gone through by one, and what
// was faster goes on. Nothing but the time depends on it.
#pragma once

#include <chrono>
#include <cstdint>

namespace tachk::reachability::ahead {

class Pace final {
 public:
  // Whether several threads are to go on, when so many states have been explored.
  bool several(std::uint64_t explored) {
    if (explored < end_) return several_;
    const auto now = Clock::now();
    const double each = std::chrono::duration<double>(now - began_).count() / static_cast<double>(explored - first_);
    switch (stage_) {
      case Stage::begin:
      case Stage::go_on:
        stage_ = Stage::by_several;
        several_ = true;
        break;
      case Stage::by_several:
        stage_ = Stage::by_one;
        several_ = false;
        seconds_by_several_ = each;
        break;
      case Stage::by_one:
        stage_ = Stage::go_on;
        several_ = seconds_by_several_ < each;
        break;
    }
    began_ = now;
    first_ = explored;
    end_ = explored + (stage_ == Stage::go_on ? 32 * stretch : stretch);
    return several_;
  }

 private:
  using Clock = std::chrono::steady_clock;
  enum class Stage : std::uint8_t { begin, by_several, by_one, go_on };
  static constexpr std::uint64_t stretch = 8192;

  Stage stage_ = Stage::begin;
  bool several_ = true;
  std::uint64_t first_ = 0;
  std::uint64_t end_ = 0;
  Clock::time_point began_{};
  double seconds_by_several_ = 0;  // for a state
};

}  // namespace tachk::reachability::ahead
