// Interchangeable processes between which a state makes no difference: exchanging two of them leaves the state as it
// is. What one of them can do each can, and the successors differ by an exchange only, so that one of them is enough.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "program/program.hpp"
#include "symbolic/member_names.hpp"
#include "zones/zone.hpp"

namespace tachk::symbolic {

class Twins final {
 public:
  Twins(const program::Program& program, const zones::ZoneOperations& operations);

  // Looks for members of a group that are twins of the one before.
  void find(const std::int32_t* slots, zones::ConstZoneRef zone);

  // Whether a process belongs to a twin of the member before: what it does alone, that one does, too.
  bool second(std::size_t process) const { return member_of_[process] != nobody && twins_[member_of_[process]] != 0; }
  // Whether an exchange of twins makes another action of this one, in which earlier members take part: some twin takes
  // part in this one without the member before it.
  bool repeats(std::span<const std::uint32_t> edges);

 private:
  struct Group {
    program::Interchangeable parts;
    MemberNames names;
    std::uint32_t first;  // its first member, of those of all groups
  };
  static constexpr std::uint32_t nobody = UINT32_MAX;

  bool exchangeable(const Group& group, std::uint32_t member, const std::int32_t* slots, zones::ConstZoneRef zone);

  const program::Program& program_;
  zones::ZoneOperations operations_;
  std::vector<Group> groups_;
  std::vector<std::uint32_t> member_of_;  // of each process
  std::vector<std::uint8_t> twins_;       // of each member, whether it is a twin of the one before
  std::vector<std::uint8_t> named_;       // of each member of a group
  std::vector<std::uint8_t> taking_part_;
  std::vector<std::uint16_t> sources_;
  std::vector<std::uint16_t> moved_;
};

}  // namespace tachk::symbolic
