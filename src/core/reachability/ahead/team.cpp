#include "reachability/ahead/team.hpp"

#include <system_error>
#include <utility>

namespace tachk::reachability::ahead {
namespace {

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

}  // namespace

void await_change(const std::atomic<std::uint32_t>& number, std::uint32_t from) {
  constexpr int looks = 4000;
  for (int look = 0; look < looks; ++look) {
    if (number.load(std::memory_order_acquire) != from) return;
    pause();
  }
  number.wait(from);
}

Team::Team(unsigned members) {
  others_.reserve(members);
  try {
    for (unsigned member = 1; member < members; ++member) others_.emplace_back([this, member] { serve(member); });
  } catch (const std::system_error&) {  // as many as there are
  }
}

Team::~Team() {
  finish();
  over_ = true;
  ++round_;
  round_.notify_all();
  for (std::thread& other : others_) other.join();
}

void Team::begin(std::function<void(unsigned)> work) {
  finish();
  work_ = std::move(work);
  busy_ = static_cast<std::uint32_t>(others_.size());
  ++round_;
  round_.notify_all();
}

void Team::finish() {
  for (std::uint32_t busy = busy_; busy != 0; busy = busy_) await_change(busy_, busy);
}

void Team::share(std::function<void(unsigned)> work) {
  begin(std::move(work));
  work_(0);
  finish();
}

void Team::serve(unsigned member) {
  for (std::uint32_t round = 0;;) {
    await_change(round_, round);
    ++round;
    if (over_) return;
    work_(member);
    if (--busy_ == 0) busy_.notify_one();
  }
}

}  // namespace tachk::reachability::ahead
