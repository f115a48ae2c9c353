// How far the processes have come. Each process goes through its locations in rounds: without the edges that close a
// circle, its locations lie in layers, and every other edge leads to a later layer. Two ways to the same locations with
// the same number of rounds of each process have come equally far, whatever they took. So a search that takes the
// states that have come least far first explores a state only when all others that may still lead there are explored,
// unless they take another round (the waiting strategy of F. Herbreteau, T. T. Tran, "Improving search order for
// reachability testing in timed automata", FORMATS 2015).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "program/program.hpp"

namespace tachk::order {

class Progress final {
 public:
  explicit Progress(const program::Program& program);

  // How far it is from these locations, of a state, to those of one that follows: at least 1.
  std::uint32_t between(const std::int32_t* from, const std::int32_t* to) const;
  // How many of the slots of a state are locations.
  std::size_t processes() const { return processes_.size(); }

 private:
  struct Layered {
    std::vector<std::uint32_t> layer;  // of each location
    std::uint32_t layers;              // how many there are
  };

  std::vector<Layered> processes_;
};

}  // namespace tachk::order
