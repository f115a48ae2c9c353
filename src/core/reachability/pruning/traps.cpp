#include "reachability/pruning/traps.hpp"

#include <algorithm>
#include <utility>

namespace tachk::reachability::pruning {
namespace {

using program::Program;
using zones::Atom;

Outside outside_of(std::int32_t value, const std::vector<Atom>& atoms) {
  Outside found{value, 0, Outside::for_ever};
  for (const Atom& atom : atoms) {
    const std::int64_t strict = (atom.raw & 1) == 0 ? 1 : 0;
    const std::int64_t bound = zones::raw_value(atom.raw);
    if (atom.right == 0)
      found.last = std::min(found.last, 2 * bound - strict);
    else
      found.first = std::max(found.first, -2 * bound + strict);
  }
  return found;
}

// The constraints in the clocks and the time unit of a program; weaker ones where these cannot say it.
std::vector<Atom> atoms_of(const Program& program, std::uint16_t clock, const Outside& outside) {
  std::vector<Atom> atoms;
  const auto number = static_cast<std::uint16_t>(program.renumbered(clock));
  if (number == 0) return atoms;
  const std::int64_t unit = program.time_unit;
  const std::int64_t low = outside.first / 2;
  if (outside.first > 0)
    atoms.push_back({0, number, zones::raw_bound(-(low / unit), outside.first % 2 != 0 || low % unit != 0)});
  if (outside.last == Outside::for_ever) return atoms;
  const std::int64_t high = (outside.last + 1) / 2;
  const bool is_whole = high % unit == 0;
  atoms.push_back({number, 0, zones::raw_bound(high / unit + (is_whole ? 0 : 1), outside.last % 2 != 0 || !is_whole)});
  return atoms;
}

Trap trap_of(const Places& places) {
  Trap trap{places.process, 0, {}};
  for (std::size_t location = 0; location < places.intervals.size(); ++location)
    for (const std::vector<Atom>& atoms : places.intervals[location]) {
      for (const Atom& atom : atoms) trap.clock = std::max(atom.left, atom.right);
      trap.outside.push_back(outside_of(static_cast<std::int32_t>(location), atoms));
    }
  return trap;
}

Trap trap_of(const ValueSet& values) {
  Trap trap{values.slot, 0, {}};
  for (std::size_t place = 0; place < values.members.size(); ++place)
    if (values.members[place])
      trap.outside.push_back({values.low + static_cast<std::int32_t>(place), 0, Outside::for_ever});
  return trap;
}

}  // namespace

std::vector<Trap> traps_of(const Program& program) {
  const Aims aims = aims_of(program);
  std::vector<Trap> traps;
  if (aims.none()) return traps;
  for (const Places& places : aims.places) traps.push_back(trap_of(places));
  for (const std::vector<Aim>& goal : aims.goals)
    for (const Aim& aim : goal)
      for (const ValueSet& values : aim.values) {
        const bool known = std::any_of(traps.begin(), traps.end(), [&, made = trap_of(values)](const Trap& trap) {
          return trap.slot == made.slot &&
                 std::equal(trap.outside.begin(), trap.outside.end(), made.outside.begin(), made.outside.end(),
                            [](const Outside& one, const Outside& other) { return one.value == other.value; });
        });
        if (!known) traps.push_back(trap_of(values));
      }
  return traps;
}

Aims aims_within(const Program& program, const std::vector<Trap>& traps,
                 const std::vector<std::vector<std::size_t>>& clauses) {
  Aims aims;
  if (clauses.empty()) return aims;
  std::vector<std::size_t> numbers(traps.size());  // of the places
  std::vector<ValueSet> values(traps.size());
  for (std::size_t number = 0; number < traps.size(); ++number) {
    const Trap& trap = traps[number];
    const program::Slot& slot = program.slots.at(trap.slot);
    const auto size = static_cast<std::size_t>(std::int64_t{slot.high} - slot.low + 1);
    const bool is_variable = trap.slot >= program.processes.size();
    Places places{trap.slot, std::vector<std::vector<std::vector<Atom>>>(is_variable ? 0 : size)};
    values[number] = {trap.slot, slot.low, std::vector<bool>(is_variable ? size : 0, false)};
    for (const Outside& outside : trap.outside) {
      if (outside.value < slot.low || outside.value > slot.high) continue;
      const auto place = static_cast<std::size_t>(std::int64_t{outside.value} - slot.low);
      if (is_variable)
        values[number].members[place] = true;
      else
        places.intervals[place].push_back(atoms_of(program, trap.clock, outside));
    }
    if (is_variable) continue;
    numbers[number] = aims.places.size();
    aims.places.push_back(std::move(places));
  }
  std::vector<Aim> disjuncts;
  for (const std::vector<std::size_t>& clause : clauses) {
    Aim& aim = disjuncts.emplace_back();
    for (const std::size_t number : clause)
      if (traps.at(number).slot < program.processes.size())
        aim.places.push_back(numbers[number]);
      else
        aim.values.push_back(values[number]);
  }
  aims.always = {std::any_of(disjuncts.begin(), disjuncts.end(), [](const Aim& aim) { return aim.is_trivial(); })};
  aims.goals = {std::move(disjuncts)};
  return aims;
}

}  // namespace tachk::reachability::pruning
