// Random numbers, and the runs of a race made by hand: the same for any number of threads, won as often as rates say.
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "check.hpp"
#include "program/program.hpp"
#include "simulation/random.hpp"
#include "simulation/runs.hpp"

namespace {

using namespace tachk::program;
using namespace tachk::simulation;

void test_random_numbers_depend_on_seed_and_run() {
  Random first(1, 0);
  Random same(1, 0);
  Random other_run(1, 1);
  Random other_seed(2, 0);
  const std::uint64_t number = first.next();
  CHECK(number == same.next());
  CHECK(number != other_run.next());
  CHECK(number != other_seed.next());
}

void test_numbers_below_a_limit_are_uniform() {
  Random random(3, 0);
  std::vector<int> counts(6, 0);
  constexpr int draws = 60'000;
  for (int n = 0; n < draws; ++n) ++counts[random.below(6)];
  for (const int count : counts) CHECK(std::abs(count - draws / 6) < 450);  // five standard deviations
}

// Two processes that wait exponentially, with the rates 1 and 3, and then stop.
Program race() {
  Program program;
  for (std::uint32_t p = 0; p < 2; ++p) {
    program.processes.push_back({0, {Location{}, Location{}}});
    Edge edge{p, 0, 1, {}, -1, no_code, false, {}};
    edge.channels = 0;
    edge.guard.tests.push_back({1 - p, Comparison::equal, 0});
    program.edges.push_back(edge);
    program.slots.push_back({0, 1, 0, false});
  }
  program.state_slots = 2;
  return program;
}

std::int64_t bits(double number) { return std::bit_cast<std::int64_t>(number); }

std::vector<std::int64_t> chances() {
  return {0, bits(1.0), 0,         bits(1.0), 0, bits(3.0), 0, bits(1.0),  // rates
          0, 0,         bits(1.0), 1,         0, bits(1.0),                // choices and weights
          0,                                                               // no hybrid clocks
          0,                                                               // no random initial values
          3, 1};                                                           // the second slot is observed
}

void test_a_race_is_won_as_often_as_rates_say() {
  const Simulation simulation(race(), chances());
  RunRequest request;
  request.seed = 5;
  request.runs = 40'000;
  request.recording = {true, true, false};
  const std::vector<RunRecord> runs = simulation.run(request);
  std::int64_t won = 0;
  for (const RunRecord& run : runs) {
    CHECK(run.transitions == 1);
    CHECK(run.observed.size() == 2);
    won += run.observed.back();
  }
  CHECK(std::abs(static_cast<double>(won) - 30'000) < 4.5 * std::sqrt(40'000 * 0.75 * 0.25));
  request.threads = 4;
  const std::vector<RunRecord> again = simulation.run(request);
  for (std::size_t n = 0; n < runs.size(); ++n) {
    CHECK(runs[n].times == again[n].times);
    CHECK(runs[n].edges == again[n].edges);
  }
}

}  // namespace

int main() {
  test_random_numbers_depend_on_seed_and_run();
  test_numbers_below_a_limit_are_uniform();
  test_a_race_is_won_as_often_as_rates_say();
}
