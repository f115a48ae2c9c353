// The search for infinite runs on its own, on small programs whose answers follow from their definition.
#include "liveness/liveness_search.hpp"

#include <cstdint>
#include <cstdio>
#include <random>
#include <vector>

#include "check.hpp"
#include "liveness/avoidance.hpp"
#include "liveness/covering_steps.hpp"

namespace {

using namespace tachk::liveness;
using namespace tachk::program;
using namespace tachk::reachability;
using namespace tachk::symbolic;
using namespace tachk::zones;

constexpr std::int32_t nowhere = 9;

Condition at(std::int32_t location) {
  Condition condition;
  condition.tests = {{0, Comparison::equal, location}};
  return condition;
}

Condition clock_at_least(std::int64_t bound) {
  Condition condition;
  condition.atoms = {{0, 1, raw_bound(-bound, false)}};
  return condition;
}

// One process with locations 0, 1, 2 and one clock. All constants up to 5 count everywhere.
Program one_process() {
  Program program;
  program.clocks = 1;
  program.state_slots = 1;
  program.slots = {Slot{0, 2, 0, false}};
  program.maximum_constants = {0, 5};
  program.largest_constant = 5;
  Location location{};
  location.lower = location.upper = {{1, 5}};
  program.processes.push_back({0, {location, location, location}});
  return program;
}

void limit_stay(Program& program, std::size_t location, std::int64_t bound) {
  Location& place = program.processes[0].locations[location];
  place.has_invariant = true;
  place.invariant.atoms = {{1, 0, raw_bound(bound, false)}};
}

void add_edge(Program& program, std::int32_t source, std::int32_t target, const Condition& guard, bool resets) {
  Update update;
  if (resets) update.resets = {{1, 0}};
  program.edges.push_back({0, source, target, guard, -1, no_code, false, update});
}

void avoid(Program& program, const Condition& condition) { program.goals = {{{{condition, DeadlockLiteral::absent}}}}; }

std::optional<Violation> violation(const Program& program, const Options& options = {}) {
  LivenessSearch search(program, options);
  CHECK(search.run(UINT64_MAX) == Status::finished);
  return search.violation();
}

void test_a_loop_that_avoids_the_predicate() {
  Program program = one_process();
  for (const std::size_t location : {0u, 1u}) limit_stay(program, location, 5);
  add_edge(program, 0, 1, clock_at_least(2), true);
  add_edge(program, 1, 0, {}, true);
  avoid(program, at(2));
  const auto found = violation(program);
  CHECK(found && found->kind == ViolationKind::loop);
  CHECK(found->stem.size() + found->loop.size() >= 2 && found->loop.size() == 2);
  avoid(program, at(1));
  CHECK(!violation(program));
}

void test_time_that_passes_for_ever() {
  Program program = one_process();
  add_edge(program, 0, 1, {}, true);
  limit_stay(program, 1, 5);
  avoid(program, at(1));
  CHECK(violation(program)->kind == ViolationKind::idle);
  limit_stay(program, 0, 5);
  CHECK(!violation(program));
  // The clock becomes large by itself, unless it must not.
  avoid(program, clock_at_least(4));
  CHECK(!violation(program));
  limit_stay(program, 1, 3);
  CHECK(violation(program)->kind == ViolationKind::stuck);
}

// Actions of a run before the predicate becomes true count, those afterwards do not.
void test_a_predicate_that_becomes_true_while_time_passes() {
  Program program = one_process();
  limit_stay(program, 0, 5);
  add_edge(program, 0, 2, clock_at_least(3), false);
  Condition at_two = clock_at_least(2);
  at_two.atoms.push_back({1, 0, raw_bound(2, false)});
  avoid(program, at_two);
  CHECK(!violation(program));
  program.edges.clear();
  add_edge(program, 0, 2, clock_at_least(1), true);
  add_edge(program, 2, 2, {}, true);
  CHECK(violation(program)->kind != ViolationKind::stuck);
}

void test_runs_that_begin_in_a_state() {
  Program program = one_process();
  limit_stay(program, 0, 5);
  limit_stay(program, 1, 5);
  add_edge(program, 0, 1, {}, true);
  add_edge(program, 0, 2, {}, true);
  add_edge(program, 1, 0, {}, true);
  const auto answer = [&](const Condition& begins, const Condition& avoided) {
    program.goals = {{{{avoided, DeadlockLiteral::absent}}}, {{{begins, DeadlockLiteral::absent}}}};
    return violation(program);
  };
  CHECK(answer(at(1), at(2)));
  CHECK(answer(at(1), at(1)) == std::nullopt);
  CHECK(answer(at(nowhere), at(nowhere)) == std::nullopt);
  const auto idle = answer(at(2), at(0));
  CHECK(idle && idle->kind == ViolationKind::idle && idle->begins == idle->stem.size());
}

void test_delays_that_avoid_two_zones() {
  const Program program = one_process();
  const ZoneOperations operations = select_operations(2, Width::narrow, false);
  Semantics semantics(program, operations);
  Goal goal;
  for (const std::int64_t value : {2, 4}) {
    Condition exactly = clock_at_least(value);
    exactly.atoms.push_back({1, 0, raw_bound(value, false)});
    goal.disjuncts.push_back({exactly, DeadlockLiteral::absent});
  }
  Predicate predicate(goal, semantics, operations);
  std::int32_t slots[] = {0};
  CHECK(predicate.in(slots, ConstZoneRef{}) == TruthInZone::by_clocks && predicate.size() == 2);
  Avoidance avoidance(semantics, operations);
  ZoneBuffer entry(operations);
  operations.make_zero(entry.get(), 2);
  const Federation& before = avoidance.after_delay(slots, entry.get(), {}, predicate);
  CHECK(before.size() == 1 && operations.entry(before[0], 2, 1, 0) == raw_bound(2, true));
  const ClockReset three{1, 3};
  operations.reset(entry.get(), 2, &three, 1);
  const Federation& between = avoidance.after_delay(slots, entry.get(), {}, predicate);
  CHECK(between.size() == 1 && operations.entry(between[0], 2, 1, 0) == raw_bound(4, true));
  CHECK(operations.entry(between[0], 2, 0, 1) == raw_bound(-3, false));
}

// Steps come back as they were added, near and far, forwards and backwards, also behind states that were not expanded.
void test_steps_are_kept() {
  std::mt19937 random(7);
  CoveringSteps steps;
  std::vector<std::vector<std::uint32_t>> expected(5001);
  steps.begin(tachk::states::no_node);
  steps.add(0);
  steps.add(4000000000U);
  steps.end();
  for (std::uint32_t state = 0; state <= 5000; state += 1 + static_cast<std::uint32_t>(random() % 3)) {
    steps.begin(state);
    for (auto count = random() % 40; count != 0; --count) {
      expected[state].push_back(random() % 2 != 0 ? static_cast<std::uint32_t>(random())
                                                  : state + static_cast<std::uint32_t>(random() % 100));
      steps.add(expected[state].back());
    }
    steps.end();
  }
  for (std::uint32_t state = 0, target; state <= 5000; ++state) {
    if (expected[state].empty()) continue;
    CoveringSteps::Reader reader = steps.from(state);
    for (const std::uint32_t step : expected[state]) CHECK(reader.next(target) && target == step);
    CHECK(!reader.next(target));
  }
  std::uint32_t target;
  CoveringSteps::Reader initial = steps.initial();
  CHECK(initial.next(target) && target == 0 && initial.next(target) && target == 4000000000U && !initial.next(target));
}

}  // namespace

int main() {
  test_steps_are_kept();
  test_a_loop_that_avoids_the_predicate();
  test_time_that_passes_for_ever();
  test_a_predicate_that_becomes_true_while_time_passes();
  test_runs_that_begin_in_a_state();
  test_delays_that_avoid_two_zones();
  std::puts("runs that go on for ever are found where there are any");
}
