// Searches over local times: zones that do not know orders, the search itself, and runs in the order of time.
#include "localtime/local_explorer.hpp"

#include <array>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

#include "check.hpp"
#include "localtime/agents.hpp"
#include "localtime/local_zone.hpp"
#include "reachability/explorer.hpp"

namespace {

using namespace tachk::localtime;
using namespace tachk::program;
using namespace tachk::reachability;
using namespace tachk::symbolic;
using namespace tachk::zones;

// Process p leaves `a` when its clock is in [2, 3 + p], and stays in `b`.
Program apart(std::uint32_t processes) {
  Program program;
  program.clocks = static_cast<int>(processes);
  program.state_slots = processes;
  program.slots.assign(processes, Slot{0, 1, 0, false});
  program.maximum_constants.push_back(0);
  program.largest_constant = 2 + static_cast<Raw>(processes);
  for (std::uint32_t p = 0; p < processes; ++p) {
    const auto clock = static_cast<std::uint16_t>(p + 1);
    const Raw last = 3 + static_cast<Raw>(p);
    program.maximum_constants.push_back(last);
    Location a{};
    a.lower = a.upper = {{clock, last}};
    a.has_invariant = true;
    a.invariant.atoms = {{clock, 0, raw_bound(last, false)}};
    program.processes.push_back({0, {a, Location{}}});
    Condition late;
    late.atoms = {{0, clock, raw_bound(-2, false)}};
    program.edges.push_back({p, 0, 1, late, -1, no_code, false, {{}, {{clock, 0}}, no_code}});
  }
  return program;
}

Condition all_there(std::uint32_t processes) {
  Condition condition;
  for (std::uint32_t p = 0; p < processes; ++p) condition.tests.push_back({p, Comparison::equal, 1});
  return condition;
}

void test_zones_do_not_know_the_order_of_independent_actions() {
  LocalZones zones(2, {0, 0, 1});
  const auto step = [&](std::vector<LocalEntry>& zone, std::uint16_t clock) {
    CHECK(zones.constrain(zone.data(), {0, clock, raw_bound(-clock, false)}));
    zones.reset(zone.data(), {clock, 0});
    zones.elapse(zone.data(), clock - 1U);
  };
  std::vector<LocalEntry> first(zones.size());
  zones.make_zero(first.data());
  zones.elapse(first.data(), 0);
  zones.elapse(first.data(), 1);
  std::vector<LocalEntry> second = first;
  step(first, 1);
  step(first, 2);
  step(second, 2);
  step(second, 1);
  CHECK(first == second);
  // Where both have the same time, either clock may be the older one.
  std::array<LocalEntry, 9> clocks{};
  CHECK(zones.synchronised(first.data(), clocks.data()));
  CHECK(clocks[1 * 3 + 2] == LocalZones::infinity && clocks[2 * 3 + 1] == LocalZones::infinity);
  CHECK(clocks[1] == raw_zero && clocks[2] == raw_zero);
}

void test_what_is_synchronised_keeps_constraints() {
  LocalZones zones(2, {0, 0, 1});
  std::vector<LocalEntry> zone(zones.size());
  zones.make_zero(zone.data());
  zones.elapse(zone.data(), 0);
  CHECK(zones.constrain(zone.data(), {1, 0, raw_bound(4, true)}));
  CHECK(zones.constrain(zone.data(), {0, 1, raw_bound(-3, false)}));
  std::array<LocalEntry, 9> clocks{};
  CHECK(!zones.synchronised(zone.data(), clocks.data()));  // the other one is still at 0
  zones.elapse(zone.data(), 1);
  CHECK(zones.synchronised(zone.data(), clocks.data()));
  CHECK(clocks[1 * 3] == raw_bound(4, true) && clocks[1] == raw_bound(-3, false));
  CHECK(clocks[2 * 3] == raw_bound(4, true) && clocks[1 * 3 + 2] == raw_zero);
  const std::array<std::uint32_t, 2> both{0, 1};
  CHECK(zones.meet(zone.data(), both));
  CHECK(!zones.constrain(zone.data(), {2, 0, raw_bound(3, true)}));
}

void test_the_search_needs_one_zone_for_each_discrete_state() {
  constexpr std::uint32_t processes = 5;
  Program program = apart(processes);
  for (std::uint32_t p = 0; p < processes; ++p) {  // and comes back after 2
    Location& b = program.processes[p].locations[1];
    b.lower = b.upper = {{static_cast<std::uint16_t>(p + 1), 2}};
    Edge back = program.edges[p];
    std::swap(back.source, back.target);
    program.edges.push_back(back);
  }
  LocalExplorer local(program, {});
  CHECK(local.run(UINT64_MAX) == Status::finished);
  CHECK(local.statistics().stored == 1U << processes);
  Explorer ordinary(program, {});
  CHECK(ordinary.run(UINT64_MAX) == Status::finished);
  CHECK(ordinary.statistics().stored > 1U << processes);
}

void test_runs_come_in_the_order_of_time() {
  // The second leaves late enough for the goal only if the first has left long before.
  Program program = apart(2);
  Condition end = all_there(2);
  end.atoms = {{0, 1, raw_bound(-2, false)}, {2, 0, raw_bound(0, false)}};
  program.goals.push_back({{{end, DeadlockLiteral::absent}}});
  program.processes[0].locations[1].lower = program.processes[0].locations[1].upper = {{1, 2}};
  program.processes[1].locations[1].lower = program.processes[1].locations[1].upper = {{2, 0}};
  LocalExplorer local(program, {});
  CHECK(local.run(UINT64_MAX) == Status::finished);
  CHECK((local.path_to_goal(0) == Path{{0}, {1}}));
  std::vector<Atom>& atoms = program.goals[0].disjuncts[0].condition.atoms;
  atoms = {{0, 2, raw_bound(-2, false)}, {1, 0, raw_bound(0, false)}};
  program.processes[0].locations[1].lower = program.processes[0].locations[1].upper = {{1, 0}};
  program.processes[1].locations[1].lower = program.processes[1].locations[1].upper = {{2, 2}};
  // The first has to leave at 3 at the latest: the second cannot have waited for two by then.
  LocalExplorer too_late(program, {});
  CHECK(too_late.run(UINT64_MAX) == Status::finished);
  CHECK(!too_late.reached(0));
  atoms[0].raw = raw_bound(-1, false);
  LocalExplorer other(program, {});
  CHECK(other.run(UINT64_MAX) == Status::finished);
  CHECK((other.path_to_goal(0) == Path{{1}, {0}}));
}

void test_deadlocks_are_found_with_equal_bounds_only() {
  // Once all have left nothing is possible, and before that something is.
  Program program = apart(3);
  program.goals.push_back({{{all_there(3), DeadlockLiteral::required}}});
  Condition first_stays;
  first_stays.tests.push_back({0, Comparison::equal, 0});
  program.goals.push_back({{{first_stays, DeadlockLiteral::required}}});
  Options options;
  options.extrapolation = Extrapolation::max;
  LocalExplorer local(program, options);
  CHECK(local.run(UINT64_MAX) == Status::finished);
  CHECK(local.path_to_goal(0).size() == 3);
  CHECK(!local.reached(1));
  options.extrapolation = Extrapolation::lu;
  bool rejected = false;
  try {
    LocalExplorer other(program, options);
  } catch (const std::invalid_argument&) {
    rejected = true;
  }
  CHECK(rejected);
}

void test_what_is_shared() {
  Program program = apart(2);
  CHECK(find_agents(program).obstacle == nullptr && find_agents(program).count == 2);
  Program reading = program;
  reading.edges[1].guard.tests.push_back({0, Comparison::equal, 1});
  const Agents agents = find_agents(reading);  // the location of the first process is a variable that both use
  CHECK(agents.count == 3);
  CHECK(
      (agents.of_edge[0] == std::vector<std::uint32_t>{0, 2} && agents.of_edge[1] == std::vector<std::uint32_t>{1, 2}));
  Program waiting = program;
  waiting.processes[1].locations[0].invariant.tests.push_back({0, Comparison::equal, 0});
  CHECK(find_agents(waiting).obstacle != nullptr);
  Program shared = program;
  shared.edges[1].update.resets.push_back({1, 0});
  CHECK(find_agents(shared).obstacle != nullptr);  // the first has an invariant about that clock
  shared.processes[0].locations[0].invariant = {};
  CHECK(find_agents(shared).obstacle == nullptr && find_agents(shared).of_clock[1] == 2);
}

}  // namespace

int main() {
  test_zones_do_not_know_the_order_of_independent_actions();
  test_what_is_synchronised_keeps_constraints();
  test_the_search_needs_one_zone_for_each_discrete_state();
  test_runs_come_in_the_order_of_time();
  test_deadlocks_are_found_with_equal_bounds_only();
  test_what_is_shared();
}
