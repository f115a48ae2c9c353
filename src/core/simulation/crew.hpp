// Work that several threads share.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace tachk::simulation {

// Does the pieces 0 .. count - 1, each once, in any order. `worker()` is called by each thread and gives what does a
// piece. The first exception ends the work and is thrown again.
template <class Worker>
void share_work(unsigned threads, std::uint64_t count, const Worker& worker) {
  std::atomic<std::uint64_t> next{0};
  std::exception_ptr failure;
  std::mutex failing;
  const auto work = [&] {
    try {
      auto piece = worker();
      for (std::uint64_t n = next++; n < count; n = next++) piece(n);
    } catch (...) {
      const std::lock_guard lock(failing);
      if (!failure) failure = std::current_exception();
      next = count;
    }
  };
  std::vector<std::thread> others;
  const auto wanted = static_cast<unsigned>(std::min<std::uint64_t>(threads, count));
  for (unsigned n = 1; n < wanted; ++n) others.emplace_back(work);
  work();
  for (std::thread& other : others) other.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace tachk::simulation
