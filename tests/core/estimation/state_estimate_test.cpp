// The states of a lamp that is followed: a press is received when it is off, and 3 to 5 units later it lights up.
#include "estimation/state_estimate.hpp"

#include <cstdint>
#include <cstdio>
#include <optional>
#include <vector>

#include "check.hpp"
#include "reachability/programs.hpp"

namespace {

using namespace tachk::estimation;
using namespace tachk::program;
using namespace programs;
using tachk::reachability::Limits;
using tachk::reachability::Options;
using tachk::reachability::Status;

constexpr Raw longest = 1000;
constexpr std::int32_t press = 0, light = 1;  // channels, and streams

// Clock 1 is the time since the present moment, clock 2 that of the lamp. The slot behind the locations says how bright
// the lamp was.
Program lamp() {
  Program program;
  program.clocks = 2;
  program.state_slots = 4;
  program.slots = {Slot{0, 0, 0, false}, Slot{0, 1, 0, false}, Slot{0, 0, 0, false}, Slot{0, 9, 0, false}};
  program.maximum_constants = {0, longest, 5};
  program.largest_constant = longest;
  program.channels = {{false, false, 0}, {true, false, 0}};
  const std::vector<ClockBound> now = {{1, longest}};
  program.processes.push_back({0, {location(atoms({at_most(1, longest)}), now, now)}});
  program.processes.push_back({0, {location(), location(atoms({at_most(2, 5)}), {{2, 3}}, {{2, 5}})}});
  program.processes.push_back({0, {location()}});
  program.edges.push_back(synchronised(edge(2, 0, 0), press, true));
  program.edges.push_back(synchronised(edge(1, 0, 1, {}, {{}, {{2, 0}}, no_code}), press, false));
  program.edges.push_back(synchronised(edge(1, 1, 0, atoms({at_least(2, 3)}), {{{3, 7}}, {}, no_code}), light, true));
  return program;
}

// The edges of the lamp have the marks 0 and 1.
StateEstimate followed() {
  std::vector<VisibleChannel> channels = {{press, press, true, {}}, {light, light, false, {{3, 0}, {std::nullopt, 4}}}};
  return {lamp(), Options{}, Limits{}, std::move(channels), 2, {std::nullopt, 0, 1}};
}

void advance(StateEstimate& estimate, Raw until) {
  estimate.advance(until);
  CHECK(estimate.run(UINT64_MAX) == Status::finished);
}

const Prediction& predict(StateEstimate& estimate, Raw until) {
  estimate.predict(until);
  CHECK(estimate.run(UINT64_MAX) == Status::finished);
  return estimate.prediction();
}

void test_the_windows_of_an_answer() {
  StateEstimate estimate = followed();
  advance(estimate, 0);
  CHECK(estimate.size() == 1);
  CHECK(predict(estimate, 20).events.size() == 1);
  CHECK(estimate.prediction().silent_until == 20);
  estimate.observe(press, {{}, 10, 11});
  advance(estimate, 12);
  CHECK(estimate.covered() == std::vector<std::uint32_t>{0});
  const Prediction& next = predict(estimate, 20);
  CHECK(next.events.size() == 1);
  CHECK(next.events[0].channel == light);
  CHECK(next.events[0].values == (std::vector<std::int32_t>{7, 4}));
  CHECK(next.events[0].windows.size() == 1);
  CHECK(next.events[0].windows[0].low == 1 && next.events[0].windows[0].high == 4);
  CHECK(next.silent_until == 4);
  CHECK(!next.blocked.empty() && next.blocked[0].channel == press);
  estimate.observe(light, {{7, std::nullopt}, 4, 4});
  estimate.watch({2});
  CHECK(!estimate.passed());
  advance(estimate, 5);
  CHECK(estimate.passed());
  CHECK(estimate.size() == 1);
  CHECK(estimate.covered() == (std::vector<std::uint32_t>{0, 1}));
}

void test_what_is_not_as_modelled() {
  for (const Observation& wrong : {Observation{{7, 4}, 1, 1}, Observation{{7, 4}, 6, 6}, Observation{{6, 4}, 4, 4}}) {
    StateEstimate estimate = followed();
    estimate.observe(press, {{}, 0, 0});
    estimate.observe(light, wrong);
    advance(estimate, 10);
    CHECK(estimate.size() == 0);
  }
  StateEstimate silent = followed();
  silent.observe(press, {{}, 0, 0});
  advance(silent, 5);
  CHECK(silent.size() == 1);
  advance(silent, 1);
  CHECK(silent.size() == 0);
}

void test_events_that_may_not_have_happened() {
  StateEstimate estimate = followed();
  estimate.observe(press, {{}, 0, 0, true});
  advance(estimate, 10);
  CHECK(estimate.size() == 1);  // it was not pressed, since it is dark
}

void test_the_end_and_the_way_to_an_edge() {
  StateEstimate estimate = followed();
  advance(estimate, 0);
  estimate.seek(100, {2}, 1000);
  CHECK(estimate.run(UINT64_MAX) == Status::finished);
  CHECK(estimate.found() && estimate.lead() && estimate.lead()->channel == press);
  estimate.observe(press, {{}, 0, 0});
  estimate.observe(light, {{7, 4}, 4, 8});
  estimate.conclude();
  CHECK(estimate.run(UINT64_MAX) == Status::finished);
  CHECK(estimate.found());
  estimate.observe(light, {{7, 4}, 8, 8});
  estimate.conclude();
  CHECK(estimate.run(UINT64_MAX) == Status::finished);
  CHECK(!estimate.found());  // nobody has pressed a second time
}

}  // namespace

int main() {
  test_the_windows_of_an_answer();
  test_what_is_not_as_modelled();
  test_events_that_may_not_have_happened();
  test_the_end_and_the_way_to_an_edge();
  std::puts("the lamp is followed");
}
