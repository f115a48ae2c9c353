// How many transitions each discrete state is away from a goal, at least: by a search through the zone graph, and one
// back through what it has seen.
#pragma once

#include <cstddef>

#include "program/program.hpp"
#include "simulation/levels.hpp"

namespace tachk::reachability {

struct Distances {
  simulation::Levels levels;  // the top is the goal; 0 is as far from it as the initial state, or farther
  std::size_t states;         // discrete ones that were seen
  bool whole = true;          // there are no others
  bool reached = false;       // the goal was among them
};

// The goal is the first of the program. States that are not seen because there are too many have level 0.
Distances distances(program::Program program, std::size_t most_zones);

}  // namespace tachk::reachability
