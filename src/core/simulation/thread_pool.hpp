// Work that several threads share.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace tachk::simulation {

// Called now and then by any thread that works, and with the number of bytes before so many are taken at once: throws
// what ends the work, a `Stopped` in each thread. May be empty.
using Poll = std::function<void(std::size_t bytes)>;

// A thread or the caller has ended the work.
struct Stopped {};

// So many transitions, or values that are kept of them, lie between two looks of a thread.
inline constexpr std::uint64_t between_polls = 1 << 10;

// The thread that waits for others looks so often.
inline constexpr std::chrono::milliseconds between_waits{20};

// Does the pieces 0 .. count - 1, each once, in any order. `worker()` is called by each thread and gives what does a
// piece. The first exception ends the work and is thrown again. The calling thread looks also while it waits for
// others: only there Ctrl-C is seen.
template <class Worker>
void share_work(unsigned threads, std::uint64_t count, const Poll& poll, const Worker& worker) {
  std::atomic<std::uint64_t> next{0};
  std::exception_ptr failure;
  std::mutex guarding;
  std::condition_variable ready;
  const auto wanted = static_cast<unsigned>(std::min<std::uint64_t>(threads, count));
  unsigned at_work = std::max(wanted, 1U) - 1;  // beside this one
  const auto guarded = [&](const auto& part) {
    try {
      part();
    } catch (...) {
      const std::lock_guard lock(guarding);
      if (!failure) failure = std::current_exception();
      next = count;
    }
  };
  const auto work = [&] {
    guarded([&] {
      auto piece = worker();
      for (std::uint64_t n = next++; n < count; n = next++) piece(n);
    });
  };
  std::vector<std::thread> others;
  for (unsigned n = 1; n < wanted; ++n)
    others.emplace_back([&] {
      work();
      const std::lock_guard lock(guarding);
      --at_work;
      ready.notify_one();
    });
  work();
  std::unique_lock lock(guarding);
  while (!ready.wait_for(lock, between_waits, [&] { return at_work == 0; })) {
    lock.unlock();
    guarded([&] {
      if (poll) poll(0);
    });
    lock.lock();
  }
  lock.unlock();
  for (std::thread& other : others) other.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace tachk::simulation
