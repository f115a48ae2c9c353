#include "simulation/tables.hpp"

#include <algorithm>

#include "machine/code_accesses.hpp"

namespace tachk::simulation {

using program::Program;

namespace {

std::uint64_t clocks_of(const program::Condition& condition, const Program& program) {
  std::uint64_t clocks = 0;
  for (const zones::Atom& atom : condition.atoms) clocks |= clock_group(atom.left) | clock_group(atom.right);
  for (const program::ComputedConstraint& constraint : condition.computed) {
    if (constraint.left_code != program::no_code || constraint.right_code != program::no_code) return UINT64_MAX;
    clocks |= clock_group(static_cast<std::size_t>(constraint.left));
    clocks |= clock_group(static_cast<std::size_t>(constraint.right));
  }
  return program.has_stopwatches ? UINT64_MAX : clocks;
}

// Groups of slots with one that is read.
program::SlotSet slots_of(const machine::AccessSet& read, const Program& program) {
  program::SlotSet slots;
  for (std::size_t slot = 0; slot < program.state_slots; ++slot)
    if (read.has_slot(slot)) slots.add(slot);
  return slots;
}

bool may_be_urgent(const program::Edge& edge, const Program& program) {
  const auto first = program.channels.begin() + edge.channel;
  return std::any_of(first, first + edge.channels, [](const program::Channel& channel) { return channel.urgent; });
}

}  // namespace

Tables::Tables(const Program& program, const flow::Chances& chances) : receivers_of(program.channels.size()) {
  for (std::size_t p = 0; p < program.processes.size(); ++p) {
    first_place.push_back(places.size());
    const std::vector<program::Location>& locations = program.processes[p].locations;
    for (std::size_t n = 0; n < locations.size(); ++n)
      places.push_back({&locations[n], &chances.rates[p][n], {}, {}, {}, {}});
  }
  for (std::uint32_t number = 0; number < program.edges.size(); ++number) {
    const program::Edge& edge = program.edges[number];
    LocationTables& place = places[first_place[edge.process] + static_cast<std::size_t>(edge.source)];
    has_branches |= chances.choices[number] != number;
    if (!edge.internal() && !edge.sends) {
      place.receives.push_back({number, FirstTest(edge.guard), edge.channel, edge.channels});
      for (std::uint32_t n = 0; n < edge.channels; ++n) {
        std::vector<std::uint32_t>& receivers = receivers_of[static_cast<std::size_t>(edge.channel) + n];
        if (receivers.empty() || receivers.back() != edge.process) receivers.push_back(edge.process);
      }
      continue;
    }
    place.outputs.push_back({number, FirstTest(edge.guard)});
    if (!edge.internal() && may_be_urgent(edge, program)) {
      place.urgent.push_back(number);
      if (urgent_senders.empty() || urgent_senders.back() != edge.process) urgent_senders.push_back(edge.process);
    }
  }
  machine::CodeAccesses accesses(program);
  for (LocationTables& place : places) {
    Dependencies& dependencies = place.dependencies;
    accesses.clear();
    accesses.add(place.location->invariant);
    accesses.add(place.rate->code);
    dependencies.clocks = clocks_of(place.location->invariant, program);
    dependencies.depends_on_flow = !place.location->invariant.flow.empty();
    for (const Output& output : place.outputs) {
      const program::Condition& guard = program.edges[output.edge].guard;
      accesses.add(guard);
      dependencies.clocks |= clocks_of(guard, program);
      dependencies.depends_on_flow |= !guard.flow.empty();
    }
    dependencies.clocks &= ~clock_group(0) | (program.clocks >= 64 ? clock_group(0) : 0);
    dependencies.reads = slots_of(accesses.reads, program);
    dependencies.committed = place.location->committed;
    dependencies.urgent = place.location->urgent;
    dependencies.has_invariant = place.location->has_invariant;
    for (std::size_t process = 0; process < program.processes.size(); ++process)
      reads_locations |= accesses.reads.has_slot(process);
  }
  for (std::uint32_t slot = 0; slot < program.state_slots; ++slot)
    if (program.slots[slot].meta) meta_slots.push_back(slot);
}

}  // namespace tachk::simulation
