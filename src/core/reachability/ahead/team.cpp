#include "reachability/ahead/team.hpp"

#include <system_error>

namespace tachk {

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

void Team::share(const std::function<void(unsigned)>& work) {
  work_ = &work;
  busy_ = static_cast<std::uint32_t>(others_.size());
  ++round_;
  round_.notify_all();
  work(0);
  for (std::uint32_t busy = busy_; busy != 0; busy = busy_) busy_.wait(busy);
}

void Team::serve(unsigned member) {
  for (std::uint32_t round = 0;;) {
    round_.wait(round);
    ++round;
    if (over_) return;
    (*work_)(member);
    if (--busy_ == 0) busy_.notify_one();
  }
}

}  // namespace tachk
