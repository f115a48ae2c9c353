// Searches by several threads: what they store and find is what one thread does. To be run under ThreadSanitizer as
// well.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "check.hpp"
#include "reachability/explorer.hpp"
#include "reachability/programs.hpp"

namespace {

using namespace tachk::order;
using namespace tachk::program;
using namespace tachk::reachability;
using namespace programs;

// A search to its end in slices of so many states.
void run(Explorer& explorer, Status last, std::uint64_t slice) {
  Status status = Status::running;
  while (status == Status::running) status = explorer.run(slice);
  CHECK(status == last);
}

void check_alike(const Program& program, Options options, Status last, const Limits& limits = {}) {
  options.threads_after = 0;
  options.threads = 1;
  Explorer alone(program, options, limits);
  run(alone, last, 1000);
  for (std::uint32_t threads = 2; threads <= 4; ++threads) {
    options.threads = threads;
    Explorer explorer(program, options, limits);
    run(explorer, last, threads == 3 ? 37 : 5000);
    CHECK(alone.threads() == 1 && explorer.threads() == threads);
    const Statistics one = alone.statistics();
    const Statistics other = explorer.statistics();
    CHECK(one.explored == other.explored);
    CHECK(one.stored == other.stored);
    CHECK(one.transitions == other.transitions);
    CHECK(one.bytes == other.bytes);
    CHECK(alone.taken() == explorer.taken());
    CHECK(alone.discrete_states() == explorer.discrete_states());
    for (std::size_t goal = 0; goal < program.goals.size(); ++goal) {
      CHECK(alone.reached(goal) == explorer.reached(goal));
      if (alone.reached(goal)) CHECK(alone.path(*alone.reached(goal)) == explorer.path(*explorer.reached(goal)));
    }
    CHECK(alone.fault().has_value() == explorer.fault().has_value());
  }
}

void test_all_states() {
  for (const SearchOrder order : {SearchOrder::automatic, SearchOrder::progress, SearchOrder::depth_first}) {
    Options options;
    options.order = order;
    check_alike(fischer(6, 2), options, Status::finished);
    options.subsumption = false;
    check_alike(fischer(4, 2), options, Status::finished);
  }
}

void test_a_goal() {
  for (const bool shortest : {false, true}) {
    Options options;
    options.shortest = shortest;
    for (int repetition = 0; repetition < 10; ++repetition) check_alike(fischer(5, 1), options, Status::finished);
  }
}

void test_deadlock() {
  Program program = fischer(5, 2);
  program.goals.push_back(goal({}, DeadlockLiteral::required));
  program.goals.push_back(goal(tests({{0, Comparison::equal, 3}}), DeadlockLiteral::forbidden));
  check_alike(program, {}, Status::finished);
}

void test_limits() {
  Limits limits;
  limits.states = 500;
  check_alike(fischer(6, 2), {}, Status::state_limit, limits);
  limits = {};
  Explorer whole(fischer(6, 2), {});
  run(whole, Status::finished, 1000);
  limits.memory_bytes = whole.statistics().bytes * 3 / 4;
  check_alike(fischer(6, 2), {}, Status::memory_limit, limits);
  limits = {};
  limits.depth = 9;
  check_alike(fischer(6, 2), {}, Status::depth_limit, limits);
}

void test_packed_zones_and_chunks() {
  Options options;
  options.pack_clocks = 0;
  options.chunk_words = 1;
  check_alike(fischer(6, 2), options, Status::finished);
}

}  // namespace

int main() {
  test_all_states();
  test_a_goal();
  test_deadlock();
  test_limits();
  test_packed_zones_and_chunks();
  std::puts("several threads find what one finds");
}
