// What a state must satisfy so that a goal, or a run-time error, can still be reached from it: for each disjunct of a
// goal a conjunction of filters, which follow from one process and one clock, or from one variable, alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "program/program.hpp"
#include "reachability/pruning/values.hpp"
#include "zones/bound.hpp"
#include "zones/zone.hpp"

namespace tachk::reachability::pruning {

// Of one process the places from which it can still come to where it has to. A place is a location and an interval of
// one clock, given by constraints; none are always true.
struct Places {
  std::uint32_t process;
  std::vector<std::vector<std::vector<zones::Atom>>> intervals;  // of each location, whose union counts
};

struct Aim {
  std::vector<std::size_t> places;  // by their numbers in `Aims`
  std::vector<ValueSet> values;

  bool is_trivial() const { return places.empty() && values.empty(); }
};

struct Aims {
  std::vector<Places> places;
  std::vector<std::vector<Aim>> goals;  // for each goal and disjunct
  std::vector<bool> always;             // of each goal: it may be reached from any state, as far as is known
  std::vector<Aim> errors;

  // True if no state can be told to be lost.
  bool none() const;
};

Aims aims_of(const program::Program& program);

}  // namespace tachk::reachability::pruning
