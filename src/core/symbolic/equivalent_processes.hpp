// Interchangeable processes that are equivalent in a state: their transposition leaves the state as it is. Each of them
// can do what one can, and the successors differ by a transposition only, so that one of them is enough.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "program/program.hpp"
#include "symbolic/member_names.hpp"
#include "zones/zone.hpp"

namespace tachk::symbolic {

class EquivalentProcesses final {
 public:
  EquivalentProcesses(const program::Program& program, const zones::ZoneOperations& operations);

  // Finds the members of each group that are equivalent to the one before.
  void find(const std::int32_t* slots, zones::ConstZoneRef zone);

  // True if a process belongs to a member that is equivalent to the one before: that one can do alone whatever it can.
  bool second(std::size_t process) const {
    return member_of_[process] != no_member && equivalent_[member_of_[process]] != 0;
  }
  // True if a transposition of equivalent members makes of this action another one, of earlier members: some member
  // takes part in it without the equivalent member before it.
  bool repeats(std::span<const std::uint32_t> edges);

 private:
  struct Group {
    program::Interchangeable parts;
    MemberNames names;
    std::uint32_t first;  // its first member, of those of all groups
  };
  static constexpr std::uint32_t no_member = UINT32_MAX;

  bool exchangeable(const Group& group, std::uint32_t member, const std::int32_t* slots, zones::ConstZoneRef zone);

  const program::Program& program_;
  zones::ZoneOperations operations_;
  std::vector<Group> groups_;
  std::vector<std::uint32_t> member_of_;  // of each process
  std::vector<std::uint8_t> equivalent_;  // of each member, whether it is equivalent to the one before
  std::vector<std::uint8_t> named_;       // of each member of a group
  std::vector<std::uint8_t> taking_part_;
  std::vector<std::uint16_t> sources_;
  std::vector<std::uint16_t> moved_;
};

}  // namespace tachk::symbolic
