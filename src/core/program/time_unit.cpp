// Times in a coarser unit: smaller constants need narrower zones, and mean the same.
#include <numeric>
#include <utility>

#include "program/program.hpp"

namespace tachk::program {

using zones::Atom;
using zones::ClockReset;

namespace {

// Calls visit(item) for everything that holds a time known before the search, but for the clock bounds, which are the
// largest of these or more.
template <class Visit>
void for_each_time(Program& program, Visit&& visit) {
  const auto visit_condition = [&](Condition& condition) {
    for (Atom& atom : condition.atoms) visit(atom);
    for (ComputedConstraint& constraint : condition.computed) visit(constraint);
  };
  for (Process& process : program.processes)
    for (Location& location : process.locations) visit_condition(location.invariant);
  for (Edge& edge : program.edges) {
    visit_condition(edge.guard);
    for (ClockReset& reset : edge.update.resets) visit(reset);
  }
  for (ClockReset& start : program.starts) visit(start);
  for (Goal& goal : program.goals)
    for (Disjunct& disjunct : goal.disjuncts) visit_condition(disjunct.condition);
  for (Measure& measure : program.measures)
    for (Disjunct& disjunct : measure.where.disjuncts) visit_condition(disjunct.condition);
  for (Atom& diagonal : program.diagonals) visit(diagonal);
}

struct Gcd {
  std::int64_t result;

  void add(std::int64_t time) { result = std::gcd(result, time); }
  void operator()(const Atom& atom) { add(zones::raw_value(atom.raw)); }
  void operator()(const ComputedConstraint& constraint) { add(constraint.bound); }
  void operator()(const ClockReset& reset) { add(reset.value); }
};

struct Divider {
  std::int64_t unit;

  void operator()(Atom& atom) const {
    atom.raw = zones::raw_bound(zones::raw_value(atom.raw) / unit, (atom.raw & 1) == 0);
  }
  void operator()(ComputedConstraint& constraint) const {
    constraint.bound = static_cast<std::int32_t>(constraint.bound / unit);
  }
  void operator()(ClockReset& reset) const { reset.value = static_cast<std::int32_t>(reset.value / unit); }
  // A bound may be rounded up: the abstraction is then finer.
  void round_up(zones::Raw& bound) const {
    if (bound > 0) bound = (bound + unit - 1) / unit;
  }
};

}  // namespace

Program in_largest_unit(Program program) {
  Gcd gcd{program.computed_unit};
  for_each_time(program, gcd);
  if (gcd.result <= 1) return program;
  const Divider divider{gcd.result};
  for_each_time(program, divider);
  for (Process& process : program.processes)
    for (Location& location : process.locations)
      for (std::vector<ClockBound>* bounds : {&location.lower, &location.upper})
        for (ClockBound& bound : *bounds) divider.round_up(bound.value);
  for (zones::Raw& constant : program.maximum_constants) divider.round_up(constant);
  divider.round_up(program.largest_constant);
  program.time_unit = gcd.result;
  return program;
}

}  // namespace tachk::program
