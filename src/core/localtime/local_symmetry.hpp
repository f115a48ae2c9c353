// One state over local times for all that differ by a permutation of interchangeable processes.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "localtime/agents.hpp"
#include "localtime/local_zone.hpp"
#include "symbolic/representative.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk::localtime {

// Agents are permuted with the processes or variables that they stand for. Which process has a clock of several is
// chosen by its number, so that it has to be checked whether the agents of clocks and edges are permuted with these.
class LocalSymmetry final {
 public:
  LocalSymmetry(symbolic::Representatives& representatives, const program::Program& program, const Agents& agents,
                const LocalZones& zones);

  bool active() const { return active_; }
  // True if states are sorted, where that can be done.
  void activate(bool wanted) { active_ = wanted && possible_; }

  // Sorts the members of each group in a state, and returns how.
  const symbolic::Arrangement& sort(std::int32_t* slots, zones::ZoneBuffer& synchronised,
                                    std::vector<LocalEntry>& zone);
  void arrange(const symbolic::Arrangement& arrangement, std::int32_t* slots, std::vector<LocalEntry>& zone);

 private:
  // Of each agent which one takes its place; none if the agents do not follow an arrangement.
  std::optional<std::vector<std::uint32_t>> agent_sources(const symbolic::Arrangement& arrangement) const;
  bool follows(const program::Program& program, const symbolic::Arrangement& arrangement) const;
  void move(const symbolic::Arrangement& arrangement, std::vector<LocalEntry>& zone);

  symbolic::Representatives& representatives_;
  const Agents& agents_;
  const LocalZones& zones_;
  bool possible_;
  bool active_;
  std::vector<LocalEntry> scratch_;
};

}  // namespace tachk::localtime
