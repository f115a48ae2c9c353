// One state for all that differ by a permutation of interchangeable processes: the members of each group are sorted by
// what is known of them, so that most of these states become the same one. Any order is sound, because every
// permutation maps what is possible onto itself; a better one leaves fewer states (Ip & Dill 1996; Hendriks et al.
// 2003). A cyclic orbit is turned to where what is known of it is least.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "program/program.hpp"
#include "symbolic/member_names.hpp"
#include "symbolic/rotations.hpp"
#include "zones/zone.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk::symbolic {

// Of each group which member has come to each place.
using Arrangement = std::vector<std::vector<std::uint32_t>>;

// The arrangement that undoes one.
Arrangement inverse(const Arrangement& arrangement);
// The composition of two arrangements, the first one first.
Arrangement composed(const Arrangement& first, const Arrangement& second);

class Representatives final {
 public:
  Representatives(const program::Program& program, const zones::ZoneOperations& operations);

  bool active() const { return active_; }
  // True if states are sorted, where there are interchangeable processes.
  void activate(bool wanted) { active_ = wanted && !groups_.empty(); }

  // Sorts the members of each group in a state; false if all have kept their places.
  bool sort(std::int32_t* slots, zones::ZoneBuffer& zone);
  // How the state sorted last was arranged.
  const Arrangement& arrangement() const { return arrangement_; }
  void arrange(const Arrangement& arrangement, std::int32_t* slots, zones::ZoneBuffer& zone);
  void arrange(const Arrangement& arrangement, std::int32_t* slots);

  // Arrangements of which all others are made.
  std::vector<Arrangement> generators() const;
  // Of each slot and of each clock of a state that is arranged, which one comes there.
  std::vector<std::uint32_t> slot_sources(const Arrangement& arrangement) const;
  std::vector<std::uint16_t> clock_sources(const Arrangement& arrangement) const;

 private:
  struct Group {
    program::Interchangeable parts;
    std::vector<bool> names_own;                         // of the slots of a member, whether they may name members
    std::vector<std::size_t> own_tables;                 // their tables
    std::vector<program::Interchangeable::Name> shared;  // names outside the slots of members
    MemberNames known;                                   // whom a number names
    std::optional<Rotations> turns;                      // of a cyclic orbit
  };

  void describe(const Group& group, const std::int32_t* slots);
  void order(std::size_t group);
  void turn(std::size_t group, const std::int32_t* slots, zones::ZoneBuffer& zone);
  void move_slots(const Group& group, const std::vector<std::uint32_t>& from, std::int32_t* slots);
  void move_clocks(const Arrangement& arrangement, zones::ZoneBuffer& zone);
  // Sets `scratch_`.
  void rename_clocks(const Arrangement& arrangement, zones::ConstZoneRef zone);

  int dimension_;
  zones::ZoneOperations operations_;
  std::vector<Group> groups_;
  bool active_;
  Arrangement arrangement_;
  Arrangement identity_;
  std::size_t width_ = 0;            // of the description of a member
  std::vector<std::int64_t> facts_;  // the descriptions of all members
  bool sums_count_ = false;          // whether a group is ordered by the following; a ring is not
  std::vector<std::int64_t> rows_;
  std::vector<std::int64_t> columns_;
  std::vector<std::int32_t> moved_;
  std::vector<std::uint32_t> places_;
  std::size_t slots_;  // of a state
  zones::ZoneBuffer scratch_;
};

}  // namespace tachk::symbolic
