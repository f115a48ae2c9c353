// Work of the core that is given up in the midst: because its time is over, or because the caller wants it to end.
#pragma once

#include <chrono>
#include <exception>
#include <functional>
#include <optional>

namespace tachk::zones {

// The work is half done: its owner cannot go on from there.
struct GivenUp : std::exception {
  const char* what() const noexcept override { return "work was given up"; }
};

// The patience of a thread with what it does while this lives.
class Patience final {
 public:
  using Clock = std::chrono::steady_clock;

  // `is_wanted`: called a few times a second; whether the work is to go on.
  Patience(std::optional<Clock::time_point> end, std::function<bool()> is_wanted);
  ~Patience();
  Patience(const Patience&) = delete;
  Patience& operator=(const Patience&) = delete;

  // Meant for loops that may be long, every hundred steps or so. Throws GivenUp if this thread has no patience left.
  static void check();

 private:
  void poll();

  std::optional<Clock::time_point> end_;
  std::function<bool()> is_wanted_;
  Clock::time_point next_;
  bool over_ = false;
  Patience* before_;
};

// Work that is done in pieces, until one is given up: there are no others then.
class InPieces final {
 public:
  // Throws GivenUp, and whatever the work throws.
  template <class Work>
  auto operator()(const Work& work) {
    if (half_done_) throw GivenUp{};
    half_done_ = true;
    const auto result = work();
    half_done_ = false;
    return result;
  }

 private:
  bool half_done_ = false;
};

}  // namespace tachk::zones
