#include "reachability/ahead/team.hpp"

#include <system_error>
#include <utility>

namespace tachk {
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
  over_ = true;
  ++round_;
  round_.notify_all();
  for (std::thread& other : others_) other.join();
}

void Team::share(std::function<void(unsigned)> work) {
  work_ = std::move(work);
  busy_ = static_cast<std::uint32_t>(others_.size());
  ++round_;
  round_.notify_all();
  perform(0);
  for (std::uint32_t busy = busy_; busy != 0; busy = busy_) await_change(busy_, busy);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

// Memory may run out in any thread; that ends the search, not the program.
void Team::perform(unsigned member) {
  try {
    work_(member);
  } catch (...) {
    const std::scoped_lock lock(failing_);
    failure_ = std::current_exception();
  }
}

void Team::serve(unsigned member) {
  for (std::uint32_t round = 0;;) {
    await_change(round_, round);
    ++round;
    if (over_) return;
    perform(member);
    if (--busy_ == 0) busy_.notify_one();
  }
}

}  // namespace tachk
