#include "localtime/local_symmetry.hpp"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

namespace tachk::localtime {

using symbolic::Arrangement;

LocalSymmetry::LocalSymmetry(symbolic::Representatives& representatives, const program::Program& program,
                             const Agents& agents, const LocalZones& zones)
    : representatives_(representatives), agents_(agents), zones_(zones), scratch_(zones.size()) {
  const std::vector<Arrangement> generators = representatives.generators();
  possible_ = representatives.active() &&
              std::all_of(generators.begin(), generators.end(),
                          [&](const Arrangement& arrangement) { return follows(program, arrangement); });
  active_ = possible_;
}

std::optional<std::vector<std::uint32_t>> LocalSymmetry::agent_sources(const Arrangement& arrangement) const {
  const std::vector<std::uint32_t> slots = representatives_.slot_sources(arrangement);
  const std::vector<std::uint16_t> clocks = representatives_.clock_sources(arrangement);
  std::vector<std::uint32_t> sources(agents_.count, Agents::no_agent);
  bool one_each = true;
  const auto comes = [&](std::uint32_t agent, std::uint32_t source) {
    one_each &= sources[agent] == Agents::no_agent || sources[agent] == source;
    sources[agent] = source;
  };
  const auto processes = static_cast<std::uint32_t>(agents_.processes);
  for (std::uint32_t process = 0; process < processes; ++process) comes(process, slots[process]);
  for (std::size_t clock = 1; clock < clocks.size(); ++clock)
    comes(agents_.of_clock[clock], agents_.of_clock[clocks[clock]]);
  for (std::size_t slot = 0; slot < slots.size(); ++slot) {
    const std::uint32_t agent = agents_.of_slot[slot];
    const std::uint32_t source = agents_.of_slot[slots[slot]];
    if ((agent == Agents::no_agent) != (source == Agents::no_agent)) return std::nullopt;
    if (agent != Agents::no_agent) comes(agent, source);
  }
  std::vector<std::uint32_t> sorted = sources;
  std::sort(sorted.begin(), sorted.end());
  for (std::uint32_t agent = 0; agent < sorted.size(); ++agent) one_each &= sorted[agent] == agent;
  return one_each ? std::optional(sources) : std::nullopt;
}

bool LocalSymmetry::follows(const program::Program& program, const Arrangement& arrangement) const {
  const auto sources = agent_sources(arrangement);
  if (!sources) return false;
  using Kind = std::tuple<std::uint32_t, std::int32_t, std::int32_t, std::vector<std::uint32_t>>;
  std::vector<std::uint32_t> targets(sources->size());
  for (std::uint32_t agent = 0; agent < targets.size(); ++agent) targets[(*sources)[agent]] = agent;
  std::map<Kind, int> balance;  // of edges between the same locations that meet the same agents
  for (std::size_t number = 0; number < program.edges.size(); ++number) {
    const program::Edge& edge = program.edges[number];
    std::vector<std::uint32_t> moved;
    for (const std::uint32_t agent : agents_.of_edge[number]) moved.push_back(targets[agent]);
    std::sort(moved.begin(), moved.end());
    ++balance[{edge.process, edge.source, edge.target, agents_.of_edge[number]}];
    --balance[{targets[edge.process], edge.source, edge.target, moved}];
  }
  return std::all_of(balance.begin(), balance.end(), [](const auto& kind) { return kind.second == 0; });
}

const Arrangement& LocalSymmetry::sort(std::int32_t* slots, zones::ZoneBuffer& synchronised,
                                       std::vector<LocalEntry>& zone) {
  if (representatives_.sort(slots, synchronised)) move(representatives_.arrangement(), zone);
  return representatives_.arrangement();
}

void LocalSymmetry::arrange(const Arrangement& arrangement, std::int32_t* slots, std::vector<LocalEntry>& zone) {
  representatives_.arrange(arrangement, slots);
  move(arrangement, zone);
}

void LocalSymmetry::move(const Arrangement& arrangement, std::vector<LocalEntry>& zone) {
  zones_.rename(scratch_.data(), zone.data(), *agent_sources(arrangement), representatives_.clock_sources(arrangement));
  std::swap(scratch_, zone);
}

}  // namespace tachk::localtime
