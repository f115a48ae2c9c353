// The search on programs built by hand: known state counts, all options alike, faults, deadlock, broadcast, priorities.
#include "reachability/explorer.hpp"

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "check.hpp"
#include "reachability/programs.hpp"

namespace {

using namespace tachk::machine;
using namespace tachk::order;
using namespace tachk::program;
using namespace tachk::reachability;
using namespace tachk::symbolic;
using namespace tachk::zones;
using namespace programs;

// Counts that TChecker's covering reachability reports for the same networks.
void test_known_state_counts() {
  struct Expected {
    std::uint32_t processes;
    std::uint64_t explored, stored, transitions;
  };
  for (const Expected& e : {Expected{6, 3458, 2378, 9132}, Expected{7, 11951, 7737, 35266}}) {
    Explorer explorer(fischer(e.processes, 2), Options{});
    CHECK(explorer.run(UINT64_MAX) == Status::finished);
    CHECK(!explorer.reached(0));
    const Statistics statistics = explorer.statistics();
    CHECK(statistics.explored == e.explored);
    CHECK(statistics.stored == e.stored);
    CHECK(statistics.transitions == e.transitions);
  }
}

void test_options_do_not_change_answers() {
  for (const Raw wait : {1, 2})
    for (const SearchOrder order : {SearchOrder::automatic, SearchOrder::breadth_first, SearchOrder::depth_first,
                                    SearchOrder::random_depth_first, SearchOrder::progress, SearchOrder::best_first})
      for (const Extrapolation extrapolation : {Extrapolation::lu, Extrapolation::max})
        for (int bits = 0; bits < 32; ++bits) {
          Options options;
          options.order = order;
          options.extrapolation = extrapolation;
          options.bounds = (bits & 1) != 0 ? BoundScope::local : BoundScope::global;
          options.subsumption = (bits & 2) != 0;
          options.width = (bits & 4) != 0 ? Width::narrow : (bits & 16) != 0 ? Width::wide : Width::widest;
          options.vector = (bits & 8) != 0;
          Explorer explorer(fischer(3, wait), options);
          CHECK(explorer.run(UINT64_MAX) == Status::finished);
          CHECK(explorer.reached(0).has_value() == (wait == 1));
          if (wait == 1) CHECK(explorer.path_to_goal(0).size() >= 6);
        }
}

// The states of Fischer's protocol in parts of one word, by giving every location and variable a word of its own.
void test_states_in_chunks_are_the_same_states() {
  Program program = fischer(5, 1);
  for (Slot& slot : program.slots) slot.low = INT32_MIN;
  program.slots.push_back(Slot{0, 9, 4, true});
  ++program.state_slots;
  for (const std::size_t chunk_words : {0u, 1u, 2u, 8u}) {
    Options options;
    options.chunk_words = chunk_words;
    Explorer chunked(program, options);
    Explorer whole(fischer(5, 1), Options{});
    CHECK(chunked.run(UINT64_MAX) == Status::finished);
    CHECK(whole.run(UINT64_MAX) == Status::finished);
    CHECK(chunked.statistics().stored == whole.statistics().stored);
    CHECK(chunked.statistics().transitions == whole.statistics().transitions);
    CHECK(chunked.path_to_goal(0) == whole.path_to_goal(0));
  }
}

// A clock that one location leaves alone while another one is set ever further back: the zones of that state do not
// contain each other, and a last one contains them all.
void test_long_antichains() {
  constexpr Raw length = 40;
  Program program;
  program.clocks = 2;
  program.state_slots = 1;
  program.slots = {Slot{0, length + 1, 0, false}};
  program.maximum_constants = {0, 100, 100};
  program.largest_constant = 100;
  Process process{0, {}};
  const std::vector<ClockBound> all{{1, 100}, {2, 100}};
  for (Raw n = 0; n < length; ++n) process.locations.push_back(location({}, all, all));
  process.locations.push_back(location({}, all, all));
  process.locations.push_back(location({}, all, all));
  // From location 0 to the one before the last with y - x = n, and at the end with any difference.
  for (Raw n = 0; n < length; ++n)
    program.edges.push_back(edge(0, 0, length, atoms({at_least(1, n), at_most(1, n)}), Update{{}, {{1, 0}}, no_code}));
  program.edges.push_back(edge(0, 0, length + 1));
  program.edges.push_back(edge(0, length + 1, length, {}, Update{{}, {{1, 0}}, no_code}));
  program.processes = {process};
  program.goals = {goal(tests({{0, Comparison::equal, 0}}), DeadlockLiteral::required)};
  for (const bool subsumption : {true, false}) {
    Options options;
    options.extrapolation = Extrapolation::max;
    options.subsumption = subsumption;
    Explorer explorer(program, options);
    CHECK(explorer.run(UINT64_MAX) == Status::finished);
    CHECK(!explorer.reached(0));
    CHECK(explorer.statistics().stored == (subsumption ? 3 : static_cast<std::uint64_t>(length) + 3));
    CHECK(explorer.statistics().explored ==
          (subsumption ? 3 : static_cast<std::uint64_t>(length)) + (subsumption ? length : 3));
  }
}

// A process that resets x, but not y, at least once in a time unit: each round the zone of location 0 contains the one
// before. The path to location 1 leads through states that are covered by then.
void test_zones_of_covered_states_are_given_back() {
  constexpr std::int32_t length = 20000;
  Program program;
  program.clocks = 2;
  program.state_slots = 1;
  program.slots = {Slot{0, 1, 0, false}};
  program.maximum_constants = {0, length, length};
  program.largest_constant = length;
  const std::vector<ClockBound> all{{1, length}, {2, length}};
  program.processes = {{0, {location(atoms({at_most(1, 1)}), all, all), location()}}};
  program.edges = {edge(0, 0, 0, {}, Update{{}, {{1, 0}}, no_code}), edge(0, 0, 1, atoms({at_least(2, 300)}))};
  Condition late = tests({{0, Comparison::equal, 0}});
  late.atoms = {more_than(1, 1)};
  program.goals = {goal(tests({{0, Comparison::equal, 1}})), goal(late)};
  std::vector<Statistics> statistics;
  std::vector<std::vector<std::vector<std::uint32_t>>> paths;
  for (const bool reclaim : {true, false}) {
    Options options;
    options.reclaim = reclaim;
    options.pruning = false;
    Explorer explorer(program, options);
    CHECK(explorer.run(UINT64_MAX) == Status::finished);
    statistics.push_back(explorer.statistics());
    paths.push_back(explorer.path_to_goal(0));
  }
  CHECK(statistics[0].stored == 2);
  CHECK(statistics[0].explored == statistics[1].explored);
  CHECK(statistics[0].explored >= length);
  CHECK(2 * statistics[0].bytes < statistics[1].bytes);
  CHECK(paths[0] == paths[1]);
  CHECK(paths[0].size() >= 300);
  CHECK(paths[0].back() == std::vector<std::uint32_t>{1});
}

// Zones without the clocks that do not matter where a process is: the same search, in less memory.
void test_packed_zones_are_the_same_zones() {
  for (const Width width : {Width::narrow, Width::wide, Width::widest})
    for (const std::uint32_t processes : {4u, 6u}) {
      std::vector<Statistics> statistics;
      for (const std::uint32_t pack_clocks : {0u, 16u}) {
        Options options;
        options.pack_clocks = pack_clocks;
        options.width = width;
        Explorer explorer(fischer(processes, 2), options);
        CHECK(explorer.run(UINT64_MAX) == Status::finished);
        statistics.push_back(explorer.statistics());
        Explorer found(fischer(processes, 1), options);
        CHECK(found.run(UINT64_MAX) == Status::finished);
        CHECK(found.path_to_goal(0).size() >= 6);
      }
      CHECK(statistics[0].explored == statistics[1].explored);
      CHECK(statistics[0].stored == statistics[1].stored);
      CHECK(statistics[0].transitions == statistics[1].transitions);
    }
}

// A process that goes through two committed locations and notes in two slots, each a word of its own, that it was
// there.
void test_committed_states_are_passed_through() {
  Program program;
  constexpr std::uint32_t first = 8;
  constexpr std::uint32_t second = 16;
  program.state_slots = second + 1;
  program.slots.assign(program.state_slots, Slot{INT32_MIN, 9, 0, false});
  program.slots[0] = Slot{0, 2, 0, false};
  program.maximum_constants = {0};
  Location committed = location();
  committed.committed = true;
  program.processes = {{0, {location(), committed, committed}}};
  for (const std::int32_t value : {0, 1})
    program.edges.push_back(
        edge(0, 0, 1, tests({{first, Comparison::equal, value}}), Update{{{first, 1 - value}}, {}, no_code}));
  program.edges.push_back(edge(0, 1, 2, {}, Update{{{second, 1}}, {}, no_code}));
  program.edges.push_back(edge(0, 2, 0));
  program.goals = {
      goal(tests({{0, Comparison::equal, 0}, {first, Comparison::equal, 1}, {second, Comparison::equal, 1}})),
      goal(tests({{0, Comparison::equal, 1}, {second, Comparison::equal, 1}})),
      goal(tests({{0, Comparison::equal, 2}, {second, Comparison::equal, 0}})),
  };
  std::vector<std::uint64_t> stored;
  for (const std::size_t chunk_words : {0u, 1u}) {
    Options options;
    options.chunk_words = chunk_words;
    Explorer explorer(program, options);
    CHECK(explorer.run(UINT64_MAX) == Status::finished);
    CHECK(explorer.path_to_goal(0).size() == 3);
    CHECK(explorer.path_to_goal(1).size() == 4);
    CHECK(!explorer.reached(2));
    stored.push_back(explorer.statistics().stored);
  }
  CHECK((stored == std::vector<std::uint64_t>{8, 8}));
}

// All constants of a network times 1000: the same search, in zones as narrow.
void test_times_in_the_largest_unit() {
  Program program = fischer(4, 1);
  const Program plain = program;
  program.computed_unit = 500;
  const auto scale_condition = [](Condition& condition) {
    for (Atom& atom : condition.atoms) atom.raw = raw_bound(1000 * raw_value(atom.raw), (atom.raw & 1) == 0);
  };
  for (Process& process : program.processes)
    for (Location& here : process.locations) {
      scale_condition(here.invariant);
      for (ClockBound& bound : here.lower) bound.value *= 1000;
      for (ClockBound& bound : here.upper) bound.value *= 1000;
    }
  for (Edge& each : program.edges) scale_condition(each.guard);
  for (Raw& constant : program.maximum_constants) constant *= 1000;
  program.largest_constant *= 1000;
  const Program reduced = in_largest_unit(program);
  CHECK(reduced.time_unit == 500);
  CHECK(reduced.largest_constant == 4);
  CHECK(reduced.edges[3].guard.atoms[0] == more_than(1, 2));
  CHECK(reduced.processes[0].locations[1].invariant.atoms[0] == at_most(1, 4));
  Explorer first(plain, Options{});
  CHECK(first.run(UINT64_MAX) == Status::finished);
  for (const bool scale : {true, false}) {
    Options options;
    options.scale = scale;
    Explorer explorer(program, options);
    CHECK(explorer.operations().largest_constant == BoundLimits<std::int16_t>::largest_constant || !scale);
    CHECK(explorer.run(UINT64_MAX) == Status::finished);
    CHECK(explorer.statistics().stored == first.statistics().stored);
    CHECK(explorer.path_to_goal(0) == first.path_to_goal(0));
  }
}

// Every edge of Fischer's protocol is taken at the end of the path to it, and beyond the end of another path.
void test_paths_to_edges() {
  for (const bool merging : {true, false})
    for (const SearchOrder order : {SearchOrder::breadth_first, SearchOrder::depth_first}) {
      Options options;
      options.order = order;
      options.merging = merging;
      Program program = fischer(3, 1);
      program.goals = {Goal{}};
      Explorer explorer(program, options);
      CHECK(explorer.run(UINT64_MAX) == Status::finished);
      CHECK(explorer.taken().size() == program.edges.size());
      const Path before = explorer.path_to_edge(explorer.taken().back());
      for (const std::uint32_t edge : explorer.taken()) {
        const Path path = explorer.path_to_edge(edge);
        CHECK(std::count(path.back().begin(), path.back().end(), edge) == 1);
        Explorer onward(program, options);
        CHECK(onward.begin_after(before));
        CHECK(onward.run(UINT64_MAX) == Status::finished);
        Path whole = before;
        for (const Edges& action : onward.path_to_edge(edge)) whole.push_back(action);
        CHECK(Explorer(program, options).begin_after(whole));
        whole.push_back(whole.back());  // no edge leads back to where it begins
        CHECK(!Explorer(program, options).begin_after(whole));
      }
    }
  Explorer fresh(fischer(2, 1), Options{});
  bool refused = false;
  try {
    fresh.path_to_edge(0);
  } catch (const std::invalid_argument&) {
    refused = true;
  }
  CHECK(refused);
}

void test_slices_and_limits() {
  Explorer whole(fischer(4, 2), Options{});
  CHECK(whole.run(UINT64_MAX) == Status::finished);
  Explorer sliced(fischer(4, 2), Options{});
  while (sliced.run(1) == Status::running) {
  }
  CHECK(sliced.statistics().stored == whole.statistics().stored);
  Limits few;
  few.states = 10;
  CHECK(Explorer(fischer(4, 2), {}, few).run(UINT64_MAX) == Status::state_limit);
  Limits shallow;
  shallow.depth = 3;
  CHECK(Explorer(fischer(4, 2), {}, shallow).run(UINT64_MAX) == Status::depth_limit);
  Limits small;
  small.memory_bytes = 1000;
  CHECK(Explorer(fischer(4, 2), {}, small).run(UINT64_MAX) == Status::memory_limit);
}

// One process that must leave `a` between 1 and 2 time units, and may stay in `b`, which nothing leaves.
Program two_locations() {
  Program program;
  program.clocks = 1;
  program.state_slots = 1;
  program.slots = {Slot{0, 1, 0, false}};
  program.maximum_constants = {0, 2};
  program.largest_constant = 2;
  program.processes = {{0, {location(atoms({at_most(1, 2)}), {{1, 1}}, {{1, 2}}), location()}}};
  program.edges = {edge(0, 0, 1, atoms({at_least(1, 1)}))};
  return program;
}

void test_deadlock() {
  Program program = two_locations();
  program.goals = {goal({}, DeadlockLiteral::required),
                   goal(tests({{0, Comparison::equal, 0}}), DeadlockLiteral::required),
                   goal(tests({{0, Comparison::equal, 1}}), DeadlockLiteral::forbidden)};
  Options options;
  options.extrapolation = Extrapolation::max;
  Explorer explorer(program, options);
  CHECK(explorer.run(UINT64_MAX) == Status::finished);
  CHECK(explorer.reached(0).has_value());
  CHECK(explorer.path_to_goal(0).size() == 1);
  CHECK(!explorer.reached(1));
  CHECK(!explorer.reached(2));
}

// The second clock is never reset and equals the first: with LU bounds it seems to have no upper bound.
void test_a_seeming_deadlock_has_no_run() {
  Program program = two_locations();
  program.clocks = 2;
  program.maximum_constants = {0, 2, 5};
  program.largest_constant = 5;
  program.processes = {{0, {location(atoms({at_most(1, 2)}), {}, {{1, 2}, {2, 5}}), location()}}};
  program.edges = {edge(0, 0, 0, atoms({at_most(2, 5)}))};
  program.goals = {goal({}, DeadlockLiteral::required), goal({}, DeadlockLiteral::forbidden)};
  Explorer widened(program, Options{});
  CHECK(widened.run(UINT64_MAX) == Status::finished);
  CHECK(widened.reached(0).has_value());
  Options exact;
  exact.extrapolation = Extrapolation::none;
  CHECK(!Explorer(program, exact).leads_to(widened.path_to_goal(0), 0));
  CHECK(Explorer(program, exact).leads_to({}, 1));
  CHECK(Explorer(program, exact).leads_to({{0}, {0}}, 1));
  CHECK(!Explorer(program, exact).leads_to({{1}}, 1));
}

// A clock that is set, stopped and never compared takes no part in the zones, by whichever way it is set.
void test_idle_clocks_are_left_out() {
  Program program = two_locations();
  program.clocks = 3;
  program.maximum_constants = {0, -1, 2, -1};
  program.has_stopwatches = true;
  program.processes = {{0, {location(atoms({at_most(2, 2)}), {{2, 2}}, {{2, 2}}), location()}}};
  program.processes[0].locations[1].stopped = {{3, no_code}};
  // Clock 3 := 7, clock 2 := 0.
  program.code = {1, 3, 1, 7, 9, 1, 2, 1, 0, 9, 0};
  program.edges = {edge(0, 0, 0, atoms({at_least(2, 1)}), Update{{}, {}, 0}),
                   edge(0, 0, 1, atoms({at_least(2, 1)}), Update{{}, {{1, 1}, {2, 0}}, no_code})};
  Condition late = tests({{0, Comparison::equal, 0}});
  late.atoms = {more_than(2, 2)};
  program.goals = {goal(tests({{0, Comparison::equal, 1}})), goal(late)};
  const Program reduced = without_idle_clocks(program);
  CHECK(reduced.clocks == 1);
  CHECK(reduced.renumbered(2) == 1);
  for (const bool reduce : {true, false}) {
    Options options;
    options.bounds = reduce ? BoundScope::local : BoundScope::global;
    Explorer explorer(program, options);
    CHECK(explorer.run(UINT64_MAX) == Status::finished);
    CHECK(explorer.reached(0).has_value());
    CHECK(!explorer.reached(1));
    CHECK(explorer.program().clocks == (reduce ? 1 : 3));
  }
}

void test_fault_reports_where_and_how() {
  Program program = two_locations();
  program.state_slots = 2;
  program.slots.push_back(Slot{0, 3, 0, false});
  // n = n + 2
  program.code = {2, 1, 1, 2, 20, 4, 1, 0};
  program.edges.push_back(edge(0, 1, 1, {}, Update{{}, {}, 0}));
  Explorer explorer(program, Options{});
  CHECK(explorer.run(UINT64_MAX) == Status::fault);
  CHECK(explorer.fault()->kind == FaultKind::range);
  CHECK(explorer.fault()->position == 5);
  CHECK(explorer.path(explorer.fault()->node).size() == 2);
  CHECK(explorer.fault()->edges == std::vector<std::uint32_t>{1});
}

// A broadcast that a receiver receives only while its clock is at most 3.
void test_broadcast_splits_on_the_receivers_clock() {
  Program program;
  program.clocks = 1;
  program.state_slots = 2;
  program.slots = {Slot{0, 1, 0, false}, Slot{0, 1, 0, false}};
  program.maximum_constants = {0, 3};
  program.largest_constant = 3;
  program.channels = {Channel{true, false, 0}};
  program.processes = {{0, {location(), location()}}, {0, {location({}, {{1, 3}}, {{1, 3}}), location()}}};
  program.edges = {synchronised(edge(0, 0, 1), 0, true), synchronised(edge(1, 0, 1, atoms({at_most(1, 3)})), 0, false)};
  Condition missed = tests({{0, Comparison::equal, 1}, {1, Comparison::equal, 0}});
  missed.atoms = {at_most(1, 3)};
  Condition late = tests({{0, Comparison::equal, 1}, {1, Comparison::equal, 0}});
  late.atoms = {more_than(1, 3)};
  program.goals = {goal(missed), goal(late), goal(tests({{0, Comparison::equal, 1}, {1, Comparison::equal, 1}}))};
  Options options;
  options.extrapolation = Extrapolation::max;
  Explorer explorer(program, options);
  CHECK(explorer.run(UINT64_MAX) == Status::finished);
  CHECK(!explorer.reached(0));
  CHECK(explorer.reached(1).has_value());
  CHECK(explorer.reached(2).has_value());
}

// The low edge 0 -> 1 may fire only before the high edge 0 -> 2 becomes possible at 2.
void test_priority_blocks_only_where_the_higher_action_is_possible() {
  Program program;
  program.clocks = 1;
  program.state_slots = 2;
  program.slots = {Slot{0, 1, 0, false}, Slot{0, 1, 0, false}};
  program.maximum_constants = {0, 2};
  program.largest_constant = 2;
  program.has_priorities = true;
  program.processes = {{0, {location(), location()}}, {1, {location({}, {{1, 2}}, {{1, 2}}), location()}}};
  program.edges = {edge(0, 0, 1), edge(1, 0, 1, atoms({at_least(1, 2)}))};
  Condition early = tests({{0, Comparison::equal, 1}, {1, Comparison::equal, 0}});
  Options options;
  options.extrapolation = Extrapolation::none;
  program.goals = {goal(early)};
  program.goals[0].disjuncts[0].condition.atoms = {Atom{0, 1, raw_bound(-5, true)}};
  program.largest_constant = 5;
  Explorer explorer(program, options);
  explorer.run(1);
  // Only the initial state is expanded: the successor over the low edge starts below 2, then time passes.
  CHECK(explorer.reached(0).has_value());
  CHECK(explorer.path_to_goal(0).front() == std::vector<std::uint32_t>{0});
  program.edges[1].guard = {};
  Explorer blocked(program, options);
  CHECK(blocked.run(UINT64_MAX) == Status::finished);
  CHECK(!blocked.reached(0));
}

void test_images_that_are_no_programs_are_rejected() {
  for (const std::vector<std::int64_t>& image :
       {std::vector<std::int64_t>{}, std::vector<std::int64_t>{1, 2}, std::vector<std::int64_t>{0, 0, -1},
        std::vector<std::int64_t>{0, 0, 0, 1000000000}, std::vector<std::int64_t>{0, 0, std::int64_t{1} << 32}}) {
    bool rejected = false;
    try {
      decode_program(image);
    } catch (const std::invalid_argument&) {
      rejected = true;
    }
    CHECK(rejected);
  }
}

}  // namespace

// Two processes that can take their only edge when 1, and when 2, time units have passed, and to wait for ever: who
// waits longer is lost.
void test_who_misses_a_moment_is_lost() {
  Program program;
  program.clocks = 2;
  program.state_slots = 2;
  program.slots = {Slot{0, 1, 0, false}, Slot{0, 1, 0, false}};
  program.maximum_constants = {0, 1, 2};
  program.largest_constant = 2;
  for (std::uint32_t process = 0; process < 2; ++process) {
    const auto clock = static_cast<std::uint16_t>(process + 1);
    program.processes.push_back({0, {location({}, {{clock, clock}}, {{clock, clock}}), location()}});
    program.edges.push_back(edge(process, 0, 1, atoms({at_most(clock, clock), at_least(clock, clock)})));
  }
  program.goals = {goal(tests({{0, Comparison::equal, 1}, {1, Comparison::equal, 1}}))};
  for (const bool pruning : {true, false}) {
    Options options;
    options.pruning = pruning;
    Explorer explorer(program, options);
    CHECK(explorer.run(UINT64_MAX) == Status::finished);
    CHECK(explorer.reached(0).has_value());
    CHECK(explorer.lost() == (pruning ? 1 : 0));  // the second process has gone first
    CHECK(explorer.statistics().stored == (pruning ? 3 : 4));
  }
}

int main() {
  test_known_state_counts();
  test_options_do_not_change_answers();
  test_states_in_chunks_are_the_same_states();
  test_long_antichains();
  test_zones_of_covered_states_are_given_back();
  test_committed_states_are_passed_through();
  test_packed_zones_are_the_same_zones();
  test_times_in_the_largest_unit();
  test_paths_to_edges();
  test_slices_and_limits();
  test_deadlock();
  test_a_seeming_deadlock_has_no_run();
  test_idle_clocks_are_left_out();
  test_fault_reports_where_and_how();
  test_broadcast_splits_on_the_receivers_clock();
  test_priority_blocks_only_where_the_higher_action_is_possible();
  test_images_that_are_no_programs_are_rejected();
  test_who_misses_a_moment_is_lost();
  std::puts("the explorer gives the known answers");
}
