#include "simulation/present.hpp"

#include <algorithm>

namespace tachk::simulation {

using flow::Crossings;
using flow::never;
using flow::Ticks;
using flow::Window;
using program::Condition;
using program::Edge;
using program::no_code;

Present::Present(const program::Program& of, const flow::Chances& with, const Tables& found, Policy waits,
                 Ticks ticks_per_unit)
    : program(of),
      chances(with),
      tables(found),
      policy(waits),
      machine(of, machine::largest_exact_reset),
      random(0, 0),
      values{{}, flow::ClockValues(of.dimension(), ticks_per_unit)},
      flow(with, ticks_per_unit),
      dependencies(of.processes.size()) {}

void Present::start(const Random& source) {
  random = source;
  draw_from_own();
  now = 0;
  values.slots.clear();
  for (const program::Slot& slot : program.slots) values.slots.push_back(slot.initial);
  for (const std::int32_t code : chances.starts) {
    program::SlotSet drawn;
    std::vector<zones::ClockReset> none;
    machine.update(code, values.slots.data(), drawn, none);
  }
  values.clocks.start();
  for (const zones::ClockReset& start : program.starts) values.clocks.set(start.clock, Ticks{start.value} * unit(), 0);
}

void Present::update_all_dependencies() {
  values.committed = 0;
  values.urgent = 0;
  for (std::size_t p = 0; p < processes(); ++p) {
    update_dependencies(p);
    values.committed += dependencies[p].committed ? 1 : 0;
    values.urgent += dependencies[p].urgent ? 1 : 0;
  }
}

// ---- conditions -----------------------------------------------------------------------------------------------------

bool Present::integers_hold(const Condition& condition) {
  for (const program::Test& test : condition.tests)
    if (!test.holds(values.slots.data())) return false;
  return condition.code == no_code || machine.value(condition.code, values.slots.data()) != 0;
}

Window Present::clock_window(const Condition& condition, zones::Raw closure) {
  Window result;
  for (const zones::Atom& atom : condition.atoms)
    values.clocks.narrow(atom.left, atom.right, atom.raw | closure, result);
  std::int32_t* slots = values.slots.data();
  for (const program::ComputedConstraint& c : condition.computed) {
    if (c.condition != no_code && machine.value(c.condition, slots) == 0) continue;
    const std::int64_t left = c.left_code == no_code ? c.left : machine.value(c.left_code, slots);
    const std::int64_t right = c.right_code == no_code ? c.right : machine.value(c.right_code, slots);
    const std::int64_t bound = c.bound_code == no_code ? c.bound : machine.value(c.bound_code, slots);
    values.clocks.narrow(static_cast<std::uint16_t>(left), static_cast<std::uint16_t>(right),
                         zones::raw_bound(bound, c.strict) | closure, result);
  }
  return result;
}

Window Present::window(const Condition& condition, Ticks from) {
  Window result = clock_window(condition);
  result.first = std::max(result.first, from);
  if (condition.flow.empty() || result.empty()) return result;
  Crossings hybrid = crossings();
  const Crossings::Found found =
      hybrid.opening(condition.flow, result.first, result.last, now + first_lookahead * unit());
  lookahead = std::min(lookahead, found.seen);
  result.first = found.moment;
  if (found.moment < never && policy != Policy::stochastic)
    result.last = std::min(result.last,
                           hybrid.ending(condition.flow, found.moment, found.moment + first_lookahead * unit()).moment);
  flow.show(now, machine, values.slots.data());
  return result;
}

Ticks Present::end_of(const Condition& invariant, Ticks up_to) {
  const Ticks last = clock_window(invariant).last;
  if (invariant.flow.empty()) return last;
  const Crossings::Found found = crossings().ending(invariant.flow, now, std::min(last, up_to));
  flow.show(now, machine, values.slots.data());
  if (found.moment == never && found.seen < last) lookahead = std::min(lookahead, found.seen);
  return std::min(last, found.moment);
}

// ---- edges ----------------------------------------------------------------------------------------------------------

std::int32_t Present::channel_of(const Edge& edge) {
  return edge.channel_code == no_code
             ? edge.channel
             : static_cast<std::int32_t>(machine.value(edge.channel_code, values.slots.data()));
}

bool Present::receives(const ReceivingEdge& receiving, std::int32_t number) {
  return receiving.may_name(number) && may_hold(receiving.first_test) && open(receiving.edge) &&
         channel_of(program.edges[receiving.edge]) == number;
}

bool Present::has_receiver(std::size_t sender, std::int32_t number, bool committed_only) {
  for (const std::uint32_t q : receivers_of(number)) {
    if (q == sender) continue;
    const LocationTables& there = place(q);
    if (committed_only && !there.location->committed) continue;
    for (const ReceivingEdge& other : there.receives)
      if (receives(other, number)) return true;
  }
  return false;
}

void Present::open_receives(std::size_t process, std::int32_t number, std::vector<std::uint32_t>& found) {
  found.clear();
  for (const ReceivingEdge& other : place(process).receives)
    if (receives(other, number)) found.push_back(other.edge);
}

bool Present::is_enabled_alone(std::size_t process, std::uint32_t number) {
  const Edge& edge = program.edges[number];
  if (edge.internal()) return admits(process);
  return !channel(channel_of(edge)).broadcast || is_enabled(process, number);
}

bool Present::is_enabled(std::size_t process, std::uint32_t number) {
  const Edge& edge = program.edges[number];
  if (edge.internal()) return admits(process);
  const std::int32_t over = channel_of(edge);
  if (channel(over).broadcast && admits(process)) return true;
  return has_receiver(process, over, !admits(process));
}

bool Present::sends_urgently(std::size_t process) {
  for (const std::uint32_t number : place(process).urgent) {
    if (!open(number)) continue;
    const std::int32_t over = channel_of(program.edges[number]);
    if (channel(over).urgent && (channel(over).broadcast || has_receiver(process, over, false))) return true;
  }
  return false;
}

}  // namespace tachk::simulation
