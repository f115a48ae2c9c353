#include "symbolic/equivalent_processes.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace tachk::symbolic {

EquivalentProcesses::EquivalentProcesses(const program::Program& program, const zones::ZoneOperations& operations)
    : program_(program),
      operations_(operations),
      member_of_(program.processes.size(), no_member),
      sources_(static_cast<std::size_t>(program.dimension())) {
  std::iota(sources_.begin(), sources_.end(), std::uint16_t{0});
  std::uint32_t count = 0;
  for (const program::Interchangeable& parts : program.interchangeable) {
    if (parts.cyclic) continue;
    groups_.push_back({parts, MemberNames(parts), count});
    for (const std::vector<std::uint32_t>& slots : parts.slots) {
      for (const std::uint32_t slot : slots)
        if (slot < program.processes.size()) member_of_[slot] = count;
      ++count;
    }
  }
  equivalent_.assign(count, 0);
  taking_part_.assign(count, 0);
}

void EquivalentProcesses::find(const std::int32_t* slots, zones::ConstZoneRef zone) {
  for (const Group& group : groups_) {
    const auto members = static_cast<std::uint32_t>(group.parts.slots.size());
    named_.assign(members, 0);
    for (const program::Interchangeable::Name& name : group.parts.names) {
      const std::int32_t member = group.names.member(name.table, slots[name.slot]);
      if (member >= 0) named_[static_cast<std::size_t>(member)] = 1;
    }
    for (std::uint32_t member = 1; member < members; ++member)
      equivalent_[group.first + member] = exchangeable(group, member, slots, zone) ? 1 : 0;
  }
}

// True if exchanging a member with the one before leaves the state as it is.
bool EquivalentProcesses::exchangeable(const Group& group, std::uint32_t member, const std::int32_t* slots,
                                       zones::ConstZoneRef zone) {
  if (named_[member] != 0 || named_[member - 1] != 0) return false;
  const std::vector<std::uint32_t>& own = group.parts.slots[member];
  const std::vector<std::uint32_t>& others = group.parts.slots[member - 1];
  for (std::size_t role = 0; role < own.size(); ++role)
    if (slots[own[role]] != slots[others[role]]) return false;
  moved_.clear();
  for (std::size_t role = 0; role < group.parts.clocks[member].size(); ++role) {
    const std::uint16_t one = group.parts.clocks[member][role];
    const std::uint16_t other = group.parts.clocks[member - 1][role];
    std::swap(sources_[one], sources_[other]);
    moved_.insert(moved_.end(), {one, other});
  }
  const bool stays = operations_.stays(zone, program_.dimension(), sources_.data(), moved_.data(), moved_.size());
  for (const std::uint16_t clock : moved_) sources_[clock] = clock;
  return stays;
}

bool EquivalentProcesses::repeats(std::span<const std::uint32_t> edges) {
  const auto member_of = [this](std::uint32_t edge) { return member_of_[program_.edges[edge].process]; };
  const auto mark = [&](std::uint8_t value) {
    for (const std::uint32_t edge : edges)
      if (member_of(edge) != no_member) taking_part_[member_of(edge)] = value;
  };
  mark(1);
  const bool found = std::any_of(edges.begin(), edges.end(), [&](std::uint32_t edge) {
    const std::uint32_t member = member_of(edge);
    return member != no_member && equivalent_[member] != 0 && taking_part_[member - 1] == 0;
  });
  mark(0);
  return found;
}

}  // namespace tachk::symbolic
