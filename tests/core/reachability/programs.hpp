// Programs built by hand, and what they are made of.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "program/program.hpp"
#include "zones/bound.hpp"

namespace programs {

using namespace tachk::program;
using namespace tachk::zones;

inline Condition tests(std::vector<Test> items) {
  Condition condition;
  condition.tests = std::move(items);
  return condition;
}

inline Condition atoms(std::vector<Atom> items) {
  Condition condition;
  condition.atoms = std::move(items);
  return condition;
}

inline Atom at_most(std::uint16_t clock, Raw bound) { return {clock, 0, raw_bound(bound, false)}; }
inline Atom more_than(std::uint16_t clock, Raw bound) { return {0, clock, raw_bound(-bound, true)}; }
inline Atom at_least(std::uint16_t clock, Raw bound) { return {0, clock, raw_bound(-bound, false)}; }

inline Location location(Condition invariant = {}, std::vector<ClockBound> lower = {},
                         std::vector<ClockBound> upper = {}) {
  Location result{};
  result.has_invariant = !invariant.trivial();
  result.invariant = std::move(invariant);
  result.lower = std::move(lower);
  result.upper = std::move(upper);
  return result;
}

inline Edge edge(std::uint32_t process, std::int32_t source, std::int32_t target, Condition guard = {},
                 Update update = {}) {
  return {process, source, target, std::move(guard), -1, no_code, false, std::move(update)};
}

inline Edge synchronised(Edge base, std::int32_t channel, bool sends) {
  base.channel = channel;
  base.sends = sends;
  return base;
}

inline Goal goal(Condition condition, DeadlockLiteral deadlock = DeadlockLiteral::absent) {
  return {{{std::move(condition), deadlock}}};
}

// Fischer's protocol with n processes: the slot behind the locations is the shared variable.
inline Program fischer(std::uint32_t n, Raw wait) {
  Program program;
  program.clocks = static_cast<int>(n);
  program.state_slots = n + 1;
  program.slots.assign(n, Slot{0, 3, 0, false});
  program.slots.push_back(Slot{0, static_cast<std::int32_t>(n), 0, false});
  program.maximum_constants.assign(n + 1, 2);
  program.largest_constant = 2;
  Goal both;
  for (std::uint32_t p = 0; p < n; ++p) {
    const auto clock = static_cast<std::uint16_t>(p + 1);
    const auto id = static_cast<std::int32_t>(p + 1);
    const Update reset{{}, {{clock, 0}}, no_code};
    program.processes.push_back({0,
                                 {location(), location(atoms({at_most(clock, 2)}), {}, {{clock, 2}}),
                                  location({}, {{clock, wait}}, {}), location()}});
    program.edges.push_back(edge(p, 0, 1, tests({{n, Comparison::equal, 0}}), reset));
    program.edges.push_back(edge(p, 1, 2, atoms({at_most(clock, 2)}), {{{n, id}}, {{clock, 0}}, no_code}));
    program.edges.push_back(edge(p, 2, 1, tests({{n, Comparison::equal, 0}}), reset));
    Condition enter = tests({{n, Comparison::equal, id}});
    enter.atoms = {more_than(clock, wait)};
    program.edges.push_back(edge(p, 2, 3, enter));
    program.edges.push_back(edge(p, 3, 0, {}, {{{n, 0}}, {}, no_code}));
    for (std::uint32_t q = 0; q < p; ++q)
      both.disjuncts.push_back(
          {tests({{p, Comparison::equal, 3}, {q, Comparison::equal, 3}}), DeadlockLiteral::absent});
  }
  program.goals.push_back(both);
  return program;
}

}  // namespace programs
