#include "runs/concrete_semantics.hpp"

namespace tachk::runs {

using program::no_code;
ConcreteSemantics::ConcreteSemantics(const program::Program& program)
    : program_(program), machine_(program, machine::largest_exact_reset) {
  for (std::uint32_t slot = 0; slot < program.state_slots; ++slot)
    if (program.slots[slot].meta) metas_.push_back(slot);
  for (const program::Process& process : program.processes) leaving_.emplace_back(process.locations.size());
  for (std::uint32_t number = 0; number < program.edges.size(); ++number) {
    const program::Edge& edge = program.edges[number];
    leaving_[edge.process][static_cast<std::size_t>(edge.source)].push_back(number);
  }
  begin();
}

void ConcreteSemantics::begin() {
  slots_.clear();
  for (const program::Slot& slot : program_.slots) slots_.push_back(slot.initial);
}

bool ConcreteSemantics::holds(const program::Condition& condition, std::vector<zones::Atom>& constraints) {
  for (const program::Test& test : condition.tests)
    if (!test.holds(slots_.data())) return false;
  if (condition.code != no_code && machine_.value(condition.code, slots_.data()) == 0) return false;
  constraints.insert(constraints.end(), condition.atoms.begin(), condition.atoms.end());
  const auto number = [&](std::int32_t code, std::int64_t given) {
    return code == no_code ? given : machine_.value(code, slots_.data());
  };
  for (const program::ComputedConstraint& each : condition.computed) {
    if (number(each.condition, 1) == 0) continue;
    const auto left = static_cast<std::uint16_t>(number(each.left_code, each.left));
    const auto right = static_cast<std::uint16_t>(number(each.right_code, each.right));
    constraints.push_back({left, right, zones::raw_bound(number(each.bound_code, each.bound), each.strict)});
  }
  return true;
}

bool ConcreteSemantics::invariants(std::vector<zones::Atom>& constraints) {
  for (std::size_t p = 0; p < program_.processes.size(); ++p)
    if (const program::Location& here = location(p); here.has_invariant && !holds(here.invariant, constraints))
      return false;
  return true;
}

bool ConcreteSemantics::waits() const {
  for (std::size_t p = 0; p < program_.processes.size(); ++p)
    if (location(p).urgent || location(p).committed) return false;
  return true;
}

std::int32_t ConcreteSemantics::channel(const program::Edge& edge) {
  if (edge.internal() || edge.channel_code == no_code) return edge.channel;
  return static_cast<std::int32_t>(machine_.value(edge.channel_code, slots_.data()));
}

void ConcreteSemantics::take(std::span<const std::uint32_t> edges, std::vector<zones::ClockReset>& resets) {
  for (const std::uint32_t number : edges) {
    const program::Update& update = program_.edges[number].update;
    for (const program::Update::Store& store : update.stores) slots_[store.slot] = store.value;
    resets.insert(resets.end(), update.resets.begin(), update.resets.end());
    if (update.code != no_code) machine_.update(update.code, slots_.data(), written_, resets);
  }
  for (const std::uint32_t number : edges) slots_[program_.edges[number].process] = program_.edges[number].target;
  for (const std::uint32_t slot : metas_) slots_[slot] = program_.slots[slot].initial;
}

}  // namespace tachk::runs
