// The zone graph and the store by themselves: a search with a stack of its own, written here, finds the states that the
// explorer finds. What a second algorithm needs is no more than this.
#include "symbolic/zone_graph.hpp"

#include <cstdint>
#include <cstdio>
#include <utility>
#include <vector>

#include "check.hpp"
#include "reachability/explorer.hpp"
#include "states/store.hpp"

namespace {

using namespace tachk::order;
using namespace tachk::program;
using namespace tachk::reachability;
using namespace tachk::states;
using namespace tachk::symbolic;
using namespace tachk::zones;

// Two processes on one clock each: from `a` to `b` after 2, back before 5; the second has priority.
Program two_processes(bool priorities) {
  Program program;
  program.clocks = 2;
  program.state_slots = 2;
  program.slots.assign(2, Slot{0, 1, 0, false});
  program.maximum_constants = {0, 5, 5};
  program.largest_constant = 5;
  program.has_priorities = priorities;
  for (std::uint32_t p = 0; p < 2; ++p) {
    const auto clock = static_cast<std::uint16_t>(p + 1);
    Location a{};
    a.lower = a.upper = {{clock, 5}};
    Location b = a;
    b.has_invariant = true;
    b.invariant.atoms = {{clock, 0, raw_bound(5, false)}};
    program.processes.push_back({static_cast<std::int32_t>(p), {a, b}});
    Condition late;
    late.atoms = {{0, clock, raw_bound(-2, false)}};
    program.edges.push_back({p, 0, 1, late, -1, no_code, false, {{}, {{clock, 0}}, no_code}});
    program.edges.push_back({p, 1, 0, {}, -1, no_code, false, {{}, {{clock, 0}}, no_code}});
  }
  return program;
}

struct Keeping {
  ZoneGraph& graph;
  PassedList& passed;
  std::vector<std::uint32_t>& stack;
  std::uint32_t parent = no_node;
  int transitions = 0;

  void possible(ConstZoneRef, const Effect&) const {}
  void expect(const Effect& effect) const { passed.announce(effect.slots.data(), SlotSet::all()); }
  bool wants(const Successor&) const { return true; }
  void take(const Successor& successor) {
    ++transitions;
    const ZoneView zone = graph.packed(successor.slots, successor.zone);
    const std::uint32_t node = passed.add(passed.locate(), zone, parent, false);
    if (node != no_node) stack.push_back(node);
  }
};

void test_a_search_of_its_own(bool priorities) {
  ZoneGraph graph(two_processes(priorities), {});
  PassedList passed(graph.program(), graph.operations(), {});
  std::vector<std::uint32_t> stack;
  int transitions = 0;
  graph.start(Keeping{graph, passed, stack});
  SymbolicState source = graph.blank();
  while (!stack.empty()) {
    const std::uint32_t node = stack.back();
    Keeping keeping{graph, passed, stack, node};
    stack.pop_back();
    passed.unpack(node, source.slots.data());
    graph.unpack(passed, node, source);
    graph.expand(source, keeping);
    transitions += keeping.transitions;
  }
  Options options;
  options.order = SearchOrder::depth_first;
  options.subsumption = false;
  Explorer explorer(two_processes(priorities), options);
  CHECK(explorer.run(UINT64_MAX) == Status::finished);
  CHECK(explorer.statistics().stored == passed.stored());
  CHECK(explorer.statistics().transitions == static_cast<std::uint64_t>(transitions));
  CHECK(passed.stored() > 4);
}

// Without extrapolation the search ends where a bound can hold no more; what it has reached by then can be told.
void test_a_path_to_a_state_whose_sibling_is_too_large() {
  Program program;
  program.clocks = 1;
  program.state_slots = 1;
  program.slots = {Slot{0, 2, 0, false}};
  program.maximum_constants = {0, 0};
  Location location{};
  location.lower = {{1, 0}};
  program.processes.push_back({0, {location, location, location}});
  program.largest_constant = BoundLimits<std::int64_t>::largest_constant;
  program.edges.push_back({0, 0, 1, {}, -1, no_code, false, {}});
  Condition far;
  far.atoms = {{0, 1, -(BoundLimits<std::int64_t>::legal / 2)}};
  program.edges.push_back({0, 0, 2, far, -1, no_code, false, {}});
  Condition at_one;
  at_one.tests = {{0, Comparison::equal, 1}};
  Condition nowhere;
  nowhere.tests = {{0, Comparison::equal, 2}};
  program.goals = {{{{at_one, DeadlockLiteral::absent}}}, {{{nowhere, DeadlockLiteral::absent}}}};
  Options options;
  options.extrapolation = Extrapolation::none;
  options.scale = false;
  Explorer explorer(program, options);
  CHECK(explorer.run(UINT64_MAX) == Status::constant_limit);
  CHECK(explorer.reached(0).has_value());
  CHECK(explorer.path(*explorer.reached(0)) == Path{Edges{0}});
}

}  // namespace

int main() {
  test_a_search_of_its_own(false);
  test_a_search_of_its_own(true);
  test_a_path_to_a_state_whose_sibling_is_too_large();
  std::puts("the zone graph can be searched in more ways than one");
}
