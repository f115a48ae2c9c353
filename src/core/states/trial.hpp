// Whether it pays to ask a dearer question after a cheap one has said no. It is asked for a while, because it may
// say yes only once much is known, and goes on being asked as long as it says yes often for what it costs. Otherwise it
// is tried again later, for a short time.
//
// The answers are weighed by `settle`. Until then it stays the same whether the question is asked, so that it does not
// matter in which order, or by which threads.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tachk {

// What came of asking, or of not asking.
class TrialAnswers final {
 public:
  // Not asked this time.
  void decline() { ++declined_; }
  // What the answer was, and what it cost: each yes saves as much as `worth` of that.
  void tell(bool yes, std::size_t cost) { gained_ += (yes ? worth : 0) - note(cost); }
  void add(const TrialAnswers& other) {
    declined_ += other.declined_;
    gained_ += other.gained_;
    cost_ += other.cost_;
  }

 private:
  friend class Trial;
  static constexpr std::int64_t worth = 128;

  std::int64_t note(std::size_t cost) {
    cost_ += static_cast<std::int64_t>(cost);
    return static_cast<std::int64_t>(cost);
  }

  std::uint64_t declined_ = 0;
  std::int64_t gained_ = 0;
  std::int64_t cost_ = 0;
};

class Trial final {
 public:
  static constexpr std::int64_t long_first = std::int64_t{1} << 18;
  static constexpr std::int64_t short_first = std::int64_t{1} << 15;

  // Not `allowed`: the question is never asked. `first`: what it may cost before its answers are weighed.
  explicit Trial(bool allowed, std::int64_t first = long_first) : left_(allowed ? first : 0), allowed_(allowed) {}

  // Whether the question is to be asked.
  bool asks() const { return left_ > 0; }
  // Weighs what came of it since this was called last.
  void settle(const TrialAnswers& answers) {
    if (!asks()) {
      skipped_ += answers.declined_;
      if (!allowed_ || skipped_ < skip) return;
      skipped_ = 0;
      left_ = window;
      return;
    }
    gained_ += answers.gained_;
    left_ -= answers.cost_;
    if (left_ > 0) return;
    left_ = gained_ >= 0 ? window : 0;
    gained_ = 0;
  }

 private:
  static constexpr std::int64_t window = std::int64_t{1} << 14;
  static constexpr std::uint64_t skip = std::uint64_t{1} << 17;

  std::int64_t left_;  // what the question may cost before its answers are weighed; 0: it is not asked now
  bool allowed_;
  std::uint64_t skipped_ = 0;
  std::int64_t gained_ = 0;
};

}  // namespace tachk
