#include "zones/patience.hpp"

#include <utility>

namespace tachk::zones {
namespace {

constexpr std::chrono::milliseconds poll_interval{25};

thread_local Patience* own = nullptr;

}  // namespace

Patience::Patience(std::optional<Clock::time_point> end, std::function<bool()> is_wanted)
    : end_(end),
      is_wanted_(std::move(is_wanted)),
      next_(Clock::now() + poll_interval),
      before_(std::exchange(own, this)) {}

Patience::~Patience() { own = before_; }

void Patience::check() {
  if (own != nullptr) own->poll();
}

void Patience::poll() {
  const Clock::time_point now = Clock::now();
  if (now < next_ && (!end_ || now < *end_)) return;
  next_ = now + poll_interval;
  if ((end_ && now >= *end_) || !is_wanted_()) over_ = true;
  if (over_) throw GivenUp{};
}

}  // namespace tachk::zones
