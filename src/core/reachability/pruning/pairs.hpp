// From where one process can still come to places of its own, whatever everybody else does: pairs of a location and an
// interval of one clock that only this process sets. All synchronisations are taken to be possible, and everything else
// to have whatever value is asked for, so that a state outside of the pairs cannot reach the places; of one inside
// nothing is known.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "machine/edge_effects.hpp"
#include "program/program.hpp"
#include "zones/bound.hpp"

namespace tachk::reachability::pruning {

// The intervals between the constants with which a clock is compared: 0, (0, c1), c1, (c1, c2), ..., beyond the last.
// Of clock 0, which stands for none, there is one.
class Intervals {
 public:
  Intervals(std::uint16_t clock, std::vector<std::int64_t> constants);

  std::uint16_t clock() const { return clock_; }
  std::size_t size() const { return clock_ == 0 ? 1 : 2 * constants_.size(); }
  // The one that holds a value, which is not negative.
  std::size_t of(std::int64_t value) const;
  // True if all its values satisfy the constraints on this clock alone; of others nothing is asked.
  bool satisfies(std::size_t interval, const std::vector<zones::Atom>& atoms) const;
  // The constraints that hold in these intervals and those between them.
  std::vector<zones::Atom> atoms(std::size_t first, std::size_t last) const;

 private:
  std::uint16_t clock_;
  std::vector<std::int64_t> constants_;  // in ascending order, from 0 on
};

// An edge of the process and what it does.
struct EdgeWithEffects {
  const program::Edge* edge;
  const machine::EdgeEffects* effects;
};

// The edges of a process by their locations.
struct EdgesOfProcess {
  std::vector<std::vector<EdgeWithEffects>> from;
  std::vector<std::vector<EdgeWithEffects>> to;
  std::size_t count = 0;
};

// One process and its clock; clock 0: none.
struct View {
  const program::Program* program;
  std::uint32_t process;
  Intervals intervals;
  const EdgesOfProcess* steps;  // of the process

  const std::vector<program::Location>& locations() const { return program->processes[process].locations; }
  std::size_t number(std::size_t location, std::size_t interval) const {
    return location * intervals.size() + interval;
  }
};

// Of each pair, whether it is one.
using PairSet = std::vector<bool>;

// The pairs from which one of these is reached.
PairSet backward(const View& view, PairSet targets);

// True if the process may come from its initial pair to one that is not in the set.
bool may_leave(const View& view, const PairSet& pairs);

}  // namespace tachk::reachability::pruning
