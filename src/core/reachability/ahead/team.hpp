// Threads that do the same work together, again and again. They begin with the first piece of work and end with the
// team: a team lives as long as one call of a search, so that nothing runs, and nothing can be lost in a process that
// is forked, while nobody searches.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

namespace tachk::reachability::ahead {

class Team final {
 public:
  // Of at most so many members, whoever asks included; there are fewer if the machine gives no more threads.
  explicit Team(unsigned members);
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  unsigned members() const { return static_cast<unsigned>(others_.size()) + 1; }

  // Calls work(n) for each member, by a thread each, and returns when all are done. It must not throw.
  void share(std::function<void(unsigned)> work);
  // Calls work(n) for each member but 0, and does not wait for them; `finish` does, and so does the next call.
  void begin(std::function<void(unsigned)> work);
  void finish();

 private:
  void serve(unsigned member);

  std::function<void(unsigned)> work_;
  std::atomic<std::uint32_t> round_{0};
  std::atomic<std::uint32_t> busy_{0};
  bool over_ = false;
  std::vector<std::thread> others_;
};

// Waits until a number is no longer the given one: most often that takes less time than to fall asleep.
void await_change(const std::atomic<std::uint32_t>& number, std::uint32_t from);

}  // namespace tachk::reachability::ahead
