#include "localtime/agents.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include "machine/code_accesses.hpp"

namespace tachk::localtime {

using program::Edge;
using program::Program;

namespace {

using Members = std::vector<std::uint32_t>;  // in ascending order

bool holds(const Members& members, std::uint32_t member) {
  return std::binary_search(members.begin(), members.end(), member);
}

// Something that parts of the program touch: a slot of the state or a clock.
struct Resource {
  Members edges;                             // that touch it
  std::optional<Members> always;             // the processes that take part whenever an edge does
  std::optional<std::uint32_t> constrained;  // the process with an invariant about it
  bool contested = false;                    // by several such processes
  bool changes = false;                      // else it is as good as a constant

  void add_edge(std::uint32_t edge, const Members& participants) {
    edges.push_back(edge);
    if (!always) {
      always = participants;
      return;
    }
    std::erase_if(*always, [&](std::uint32_t process) { return !holds(participants, process); });
  }
  void add_invariant(std::uint32_t process) {
    contested |= constrained && *constrained != process;
    constrained = process;
  }
  // The process that takes part whenever it is touched; none if there is no such process.
  std::optional<std::uint32_t> owner() const {
    if (contested) return std::nullopt;
    if (constrained) return !always || holds(*always, *constrained) ? constrained : std::nullopt;
    if (always && !always->empty()) return always->front();
    return std::nullopt;
  }
};

const char* global_obstacle(const Program& program) {
  if (program.has_priorities) return "there are priorities";
  if (program.has_stopwatches) return "clocks are stopped";
  if (program.copies_clocks) return "clocks are set to the values of others";
  if (!program.diagonals.empty()) return "clocks are compared with one another";
  if (!program.measures.empty()) return "values are measured";
  for (const program::Process& process : program.processes)
    for (const program::Location& location : process.locations)
      if (location.committed) return "there are committed locations";
  for (const program::Channel& channel : program.channels) {
    if (channel.urgent) return "there are urgent channels";
    if (channel.broadcast) return "there are broadcast channels";
  }
  return nullptr;
}

// The processes that take part in each action of an edge: its own, and its partner's if there is only one.
Members participants_of(const Program& program, const Edge& edge) {
  Members participants{edge.process};
  if (edge.internal()) return participants;
  Members partners;
  for (const Edge& other : program.edges) {
    if (other.process == edge.process || !edge.may_meet(other)) continue;
    if (std::find(partners.begin(), partners.end(), other.process) == partners.end()) partners.push_back(other.process);
  }
  if (partners.size() == 1) participants.push_back(partners.front());
  std::sort(participants.begin(), participants.end());
  return participants;
}

struct Resources {
  std::vector<Resource> slots;
  std::vector<Resource> clocks;
};

Resources find_resources(const Program& program) {
  Resources found{std::vector<Resource>(program.state_slots),
                  std::vector<Resource>(static_cast<std::size_t>(program.dimension()))};
  machine::CodeAccesses accesses(program);
  for (std::uint32_t number = 0; number < program.edges.size(); ++number) {
    const Edge& edge = program.edges[number];
    const Members participants = participants_of(program, edge);
    accesses.clear();
    accesses.add(edge.guard);
    accesses.add(edge.channel_code);
    accesses.add(edge.update);
    accesses.writes.add_slots(edge.process, edge.process);
    for (std::size_t slot = 0; slot < found.slots.size(); ++slot) {
      const bool changes = accesses.writes.has_slot(slot);
      if (changes || accesses.reads.has_slot(slot)) found.slots[slot].add_edge(number, participants);
      found.slots[slot].changes |= changes;
    }
    for (std::size_t clock = 1; clock < found.clocks.size(); ++clock)
      if (accesses.reads.has_clock(clock) || accesses.writes.has_clock(clock))
        found.clocks[clock].add_edge(number, participants);
  }
  for (std::uint32_t process = 0; process < program.processes.size(); ++process)
    for (const program::Location& location : program.processes[process].locations) {
      accesses.clear();
      accesses.add(location.invariant);
      for (std::size_t slot = 0; slot < found.slots.size(); ++slot)
        if (accesses.reads.has_slot(slot)) found.slots[slot].add_invariant(process);
      for (std::size_t clock = 1; clock < found.clocks.size(); ++clock)
        if (accesses.reads.has_clock(clock)) found.clocks[clock].add_invariant(process);
    }
  return found;
}

}  // namespace

Agents find_agents(const Program& program) {
  Agents agents;
  agents.obstacle = global_obstacle(program);
  if (agents.obstacle != nullptr) return agents;
  const Resources resources = find_resources(program);
  agents.count = agents.processes = program.processes.size();
  for (const Edge& edge : program.edges) agents.of_edge.push_back({edge.process});
  agents.of_clock.assign(1, 0);

  std::map<Members, std::uint32_t> groups;  // what the same edges share has one time
  const auto shared = [&](const Members& edges) {
    const auto [group, fresh] = groups.try_emplace(edges, static_cast<std::uint32_t>(agents.count));
    if (!fresh) return group->second;
    ++agents.count;
    for (const std::uint32_t edge : edges) agents.of_edge[edge].push_back(group->second);
    return group->second;
  };
  agents.of_slot.assign(resources.slots.size(), Agents::no_agent);
  for (std::size_t number = 0; number < resources.slots.size(); ++number) {
    const Resource& slot = resources.slots[number];
    if (!slot.changes || slot.owner()) continue;
    if (slot.constrained) {
      agents.obstacle = "an invariant reads what other processes change";
      return agents;
    }
    agents.of_slot[number] = shared(slot.edges);
  }
  for (std::size_t clock = 1; clock < resources.clocks.size(); ++clock) {
    const Resource& resource = resources.clocks[clock];
    if (const auto owner = resource.owner()) {
      agents.of_clock.push_back(*owner);
    } else if (resource.edges.empty()) {
      agents.of_clock.push_back(0);  // only goals ask for it
    } else if (resource.constrained) {
      agents.obstacle = "an invariant constrains a clock that other processes use";
      return agents;
    } else {
      agents.of_clock.push_back(shared(resource.edges));
    }
  }
  return agents;
}

}  // namespace tachk::localtime
