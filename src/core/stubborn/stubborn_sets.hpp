// Which actions suffice where time cannot pass: stubborn sets for timed systems (Bønneland, Jensen, Larsen, Muñiz, Srba
// 2018), by processes.
//
// A set of processes is enough in a state if one of them stops time, and each process outside of the set is
// *independent* of it. A process stops time in one of the most committed locations, or, while none is committed, in an
// urgent one or where a clock has reached the bound that its invariant sets. Two processes are independent if what the
// member does from its present location and what the other one may do from now on share no channel, and neither writes
// what the other one reads or writes, clocks and invariants included. Until a member moves, time stands still, and
// whatever happens meanwhile can as well happen after any action of members. No goal reads what they write. The set
// only says which actions to take first: the caller must ensure that the others are not put off for ever
// (PartialOrder).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "program/program.hpp"
#include "symbolic/successor.hpp"

namespace tachk::stubborn {

class StubbornSets final {
 public:
  // A member for each process with its bit.
  using Members = std::uint64_t;

  // `wanted`: off, none is enough.
  StubbornSets(const program::Program& program, const symbolic::Semantics& semantics,
               const zones::ZoneOperations& operations, bool wanted);

  // A set that is enough in a state and not all of what can move, the smallest one found; 0 if there is none.
  Members enough(const std::int32_t* slots, zones::ConstZoneRef zone) const;

 private:
  struct Place;  // a location of a process
  std::vector<Place> describe() const;
  void find_dependencies(const std::vector<Place>& places);
  bool applies() const;
  // True if no time can pass in any valuation of the zone because of the invariant of a location.
  bool has_ended(const program::Location& here, zones::ConstZoneRef zone) const;
  // True if a test is about the location of a process.
  bool is_location(const program::Test& test) const;
  // The smallest set with this process that is enough, where `most` is the largest commitment; 0 if there is none.
  Members closure(std::size_t process, int most, const std::int32_t* slots) const;
  std::size_t number(std::size_t process, const std::int32_t* slots) const {
    return semantics_.location_number(process, slots[process]);
  }
  // True if the actions of a process from a location on depend on those of another one from its location.
  bool depends(std::size_t of, std::size_t on) const { return dependent_[of * locations_ + on]; }

  const program::Program& program_;
  const symbolic::Semantics& semantics_;
  const zones::ZoneOperations& operations_;
  std::size_t locations_ = 0;
  std::vector<bool> dependent_;  // empty: the sets are of no use here
  std::vector<bool> seen_;       // of each location: what is done from it may change whether a goal is met
  std::vector<int> commitment_;  // the largest one of those where its edges lead
  std::vector<bool> moves_;      // there are edges
};

}  // namespace tachk::stubborn
