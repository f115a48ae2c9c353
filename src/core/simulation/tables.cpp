#include "simulation/tables.hpp"

#include <algorithm>
#include <optional>

namespace tachk::simulation {

using program::Program;

namespace {

// The clocks that a condition depends on; none: all.
std::optional<std::vector<std::size_t>> clocks_of(const program::Condition& condition, const Program& program) {
  if (program.has_stopwatches) return std::nullopt;
  std::vector<std::size_t> clocks;
  const auto add = [&](std::size_t clock) {
    if (clock != 0) clocks.push_back(clock);
  };
  for (const zones::Atom& atom : condition.atoms) {
    add(atom.left);
    add(atom.right);
  }
  for (const program::ComputedConstraint& constraint : condition.computed) {
    if (constraint.left_code != program::no_code || constraint.right_code != program::no_code) return std::nullopt;
    add(static_cast<std::size_t>(constraint.left));
    add(static_cast<std::size_t>(constraint.right));
  }
  return clocks;
}

bool may_be_urgent(const program::Edge& edge, const Program& program) {
  const auto first = program.channels.begin() + edge.channel;
  return std::any_of(first, first + edge.channels, [](const program::Channel& channel) { return channel.urgent; });
}

}  // namespace

Tables::Tables(const Program& program, const flow::Chances& chances) : receivers_of(program.channels.size()) {
  const std::size_t processes = program.processes.size();
  for (std::size_t p = 0; p < processes; ++p) {
    first_place.push_back(places.size());
    const std::vector<program::Location>& locations = program.processes[p].locations;
    for (std::size_t n = 0; n < locations.size(); ++n)
      places.push_back({&locations[n], &chances.rates[p][n], {}, {}, {}, {}});
  }
  for (std::uint32_t number = 0; number < program.edges.size(); ++number) {
    has_branches |= chances.choices[number] != number;
    add_edge(program, number);
  }
  readers.of_clock.assign(static_cast<std::size_t>(program.dimension()), ProcessSet(processes));
  readers.of_slots.assign(program::SlotSet::group_of(program.state_slots) + 1, ProcessSet(processes));
  readers.of_flow = ProcessSet(processes);
  machine::CodeAccesses accesses(program);
  for (std::size_t p = 0; p < processes; ++p)
    for (std::size_t n = 0; n < program.processes[p].locations.size(); ++n)
      add_dependencies(program, p, places[first_place[p] + n], accesses);
  for (std::uint32_t slot = 0; slot < program.state_slots; ++slot)
    if (program.slots[slot].meta) meta_slots.push_back(slot);
}

void Tables::add_edge(const Program& program, std::uint32_t number) {
  const program::Edge& edge = program.edges[number];
  LocationTables& place = places[first_place[edge.process] + static_cast<std::size_t>(edge.source)];
  if (!edge.internal() && !edge.sends) {
    place.receives.push_back({number, FirstTest(edge.guard), edge.channel, edge.channels});
    for (std::uint32_t n = 0; n < edge.channels; ++n) {
      std::vector<std::uint32_t>& receivers = receivers_of[static_cast<std::size_t>(edge.channel) + n];
      if (receivers.empty() || receivers.back() != edge.process) receivers.push_back(edge.process);
    }
    return;
  }
  place.outputs.push_back({number, FirstTest(edge.guard)});
  if (!edge.internal() && may_be_urgent(edge, program)) {
    place.urgent.push_back(number);
    if (urgent_senders.empty() || urgent_senders.back() != edge.process) urgent_senders.push_back(edge.process);
  }
}

// Notes on what a location of a process depends, and that the process does.
void Tables::add_dependencies(const Program& program, std::size_t process, LocationTables& place,
                              machine::CodeAccesses& accesses) {
  Dependencies& dependencies = place.dependencies;
  accesses.clear();
  const auto depend_on = [&](const program::Condition& condition) {
    accesses.add(condition);
    dependencies.depends_on_flow |= !condition.flow.empty();
    const auto clocks = clocks_of(condition, program);
    if (!clocks) {
      dependencies.clocks = UINT64_MAX;
      for (ProcessSet& all : readers.of_clock) all.add(process);
      return;
    }
    for (const std::size_t clock : *clocks) {
      dependencies.clocks |= clock_group(clock);
      readers.of_clock[clock].add(process);
    }
  };
  depend_on(place.location->invariant);
  accesses.add(place.rate->code);
  for (const Output& output : place.outputs) depend_on(program.edges[output.edge].guard);
  if (dependencies.depends_on_flow) readers.of_flow.add(process);
  dependencies.committed = place.location->committed;
  dependencies.urgent = place.location->urgent;
  dependencies.has_invariant = place.location->has_invariant;
  for (std::size_t slot = 0; slot < program.state_slots; ++slot) {
    if (!accesses.reads.has_slot(slot)) continue;
    dependencies.reads.add(slot);
    readers.of_slots[program::SlotSet::group_of(slot)].add(process);
    reads_locations |= slot < program.processes.size();
  }
}

}  // namespace tachk::simulation
