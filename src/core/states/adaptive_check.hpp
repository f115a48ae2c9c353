// An adaptive heuristic for a dearer check after a cheap one has said no. The check is made for a while, because it may
// say yes only once much is known, and goes on as long as it says yes often for what it costs. Otherwise it is tried
// again later, for a short time.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tachk::states {

class AdaptiveCheck final {
 public:
  static constexpr std::int64_t long_first = std::int64_t{1} << 18;
  static constexpr std::int64_t short_first = std::int64_t{1} << 15;

  // Not `allowed`: the check is never made. `first`: what it may cost before its answers are weighed.
  explicit AdaptiveCheck(bool allowed, std::int64_t first = long_first)
      : left_(allowed ? first : 0), allowed_(allowed) {}

  // True if the check is to be made this time.
  bool is_due() {
    if (left_ > 0) return true;
    if (!allowed_ || ++skipped_ < skip) return false;
    skipped_ = 0;
    left_ = window;
    return true;
  }
  // The same without counting this time.
  bool is_active() const { return left_ > 0; }
  // Records an answer and its cost: each yes saves as much as `worth` of that.
  void record(bool yes, std::size_t cost) {
    gained_ += (yes ? worth : 0) - static_cast<std::int64_t>(cost);
    left_ -= static_cast<std::int64_t>(cost);
    if (left_ > 0) return;
    left_ = gained_ >= 0 ? window : 0;
    gained_ = 0;
  }

 private:
  static constexpr std::int64_t window = std::int64_t{1} << 14;
  static constexpr std::int64_t worth = 128;
  static constexpr std::uint32_t skip = std::uint32_t{1} << 17;

  std::int64_t left_;  // what the check may cost before its answers are weighed; 0: it is not made now
  bool allowed_;
  std::uint32_t skipped_ = 0;
  std::int64_t gained_ = 0;
};

}  // namespace tachk::states
