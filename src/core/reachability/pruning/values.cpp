#include "reachability/pruning/values.hpp"

#include <algorithm>
#include <utility>

namespace tachk::reachability::pruning {
namespace {

using machine::EdgeEffects;
using program::Program;
using program::Test;

constexpr std::int64_t most_values = 4096;

struct Change {
  EdgeEffects::Kind kind;
  std::int64_t number;
  std::vector<Test> tests;  // on the variable
};

// Satisfied by the value of the only variable that they are about.
bool hold(const std::vector<Test>& tests, std::int32_t value) {
  return std::all_of(tests.begin(), tests.end(), [&](Test test) {
    test.slot = 0;
    return test.holds(&value);
  });
}

// What edges do to a variable; none if one sets it to anything. The guard of a receiver is about the value before the
// sender, so that it does not count.
std::optional<std::vector<Change>> changes_of(const Program& program, const std::vector<EdgeEffects>& effects,
                                              std::uint32_t slot) {
  std::vector<Change> changes;
  for (std::size_t number = 0; number < effects.size(); ++number) {
    const auto& slots = effects[number].slots;
    const auto last = std::find_if(slots.rbegin(), slots.rend(), [&](const auto& each) { return each.slot == slot; });
    if (last == slots.rend()) continue;
    if (last->kind == EdgeEffects::Kind::anything) return std::nullopt;
    const program::Edge& edge = program.edges[number];
    Change change{last->kind, last->number, {}};
    if (edge.internal() || edge.sends)
      for (const Test& test : edge.guard.tests)
        if (test.slot == slot) change.tests.push_back(test);
    changes.push_back(std::move(change));
  }
  return changes;
}

}  // namespace

std::optional<ValueSet> values_before(const Program& program, const std::vector<EdgeEffects>& effects,
                                      std::uint32_t slot, const std::vector<Test>& tests) {
  const program::Slot& variable = program.slots[slot];
  const std::int64_t count = std::int64_t{variable.high} - variable.low + 1;
  if (variable.meta || slot >= program.state_slots || count > most_values) return std::nullopt;
  const std::optional<std::vector<Change>> changes = changes_of(program, effects, slot);
  if (!changes) return std::nullopt;

  // Where a change leads from a value; none if it is not possible, or an error.
  const auto after = [&](const Change& change, std::int64_t place) -> std::optional<std::size_t> {
    if (!hold(change.tests, static_cast<std::int32_t>(variable.low + place))) return std::nullopt;
    const std::int64_t next =
        change.kind == EdgeEffects::Kind::set ? change.number - variable.low : place + change.number;
    return next >= 0 && next < count ? std::optional(static_cast<std::size_t>(next)) : std::nullopt;
  };
  ValueSet values{slot, variable.low, std::vector<bool>(static_cast<std::size_t>(count), false)};
  for (std::int64_t place = 0; place < count; ++place)
    values.members[static_cast<std::size_t>(place)] = hold(tests, static_cast<std::int32_t>(variable.low + place));
  for (bool changed = true; changed;) {
    changed = false;
    for (std::int64_t place = count - 1; place >= 0; --place) {
      const auto here = static_cast<std::size_t>(place);
      if (values.members[here]) continue;
      const bool leads = std::any_of(changes->begin(), changes->end(), [&](const Change& change) {
        const std::optional<std::size_t> next = after(change, place);
        return next && values.members[*next];
      });
      if (leads) values.members[here] = changed = true;
    }
  }

  std::vector<bool> seen(static_cast<std::size_t>(count), false);
  std::vector<std::int64_t> open{std::int64_t{variable.initial} - variable.low};
  while (!open.empty()) {
    const std::int64_t place = open.back();
    open.pop_back();
    if (seen[static_cast<std::size_t>(place)]) continue;
    seen[static_cast<std::size_t>(place)] = true;
    if (!values.members[static_cast<std::size_t>(place)]) return values;
    for (const Change& change : *changes)
      if (const std::optional<std::size_t> next = after(change, place))
        open.push_back(static_cast<std::int64_t>(*next));
  }
  return std::nullopt;
}

}  // namespace tachk::reachability::pruning
