// What pruning knows, as certificates carry it: traps, sets of states that no run leaves. Each is about one slot and
// one clock, and is given by what lies outside of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "program/program.hpp"
#include "reachability/pruning/aims.hpp"

namespace tachk::reachability::pruning {

// Where a slot has a value and a clock lies between two points of time. Number 2c stands for the point c, and 2c + 1
// for what is between c and c + 1.
struct Outside {
  static constexpr std::int64_t for_ever = INT64_MAX;

  std::int32_t value;
  std::int64_t first;
  std::int64_t last;
};

struct Trap {
  std::uint32_t slot;   // the location of a process, or a variable
  std::uint16_t clock;  // 0: none
  std::vector<Outside> outside;
};

// The traps in which a goal cannot be reached, each once; none where any state may lead to one, as far as is known.
std::vector<Trap> traps_of(const program::Program& program);

// What follows from traps for the only goal of a program: a state is lost if it lies in one trap of each clause. Clocks
// and times of the traps are those of the program as it was given, before clocks and time were scaled.
Aims aims_within(const program::Program& program, const std::vector<Trap>& traps,
                 const std::vector<std::vector<std::size_t>>& clauses);

}  // namespace tachk::reachability::pruning
