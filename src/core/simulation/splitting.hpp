// How probable a goal is that runs hardly ever reach: they are begun again from where some of them came nearest.
//
// Fixed effort: in each stage so many runs begin at states with which the stage before ended, each of them drawn anew,
// and go on until they are a level nearer to the goal, or end. The product of the shares that get there is the
// probability on average, whatever the levels are (Garvels, "The splitting method in rare event simulation", 2000;
// Amrein, Kuensch, "A variant of importance splitting for rare event estimation", 2011).
#pragma once

#include <cstdint>
#include <vector>

#include "simulation/levels.hpp"
#include "simulation/trials.hpp"

namespace tachk::simulation {

struct SplittingRequest {
  std::uint64_t seed = 0;
  std::uint64_t first = 0;  // the number of the first replication
  std::uint64_t replications = 1;
  std::uint64_t effort = 1000;  // runs of each stage
  unsigned threads = 1;
  std::uint64_t most_steps = UINT64_MAX;
  Poll poll = {};
};

struct Replication {
  double probability = 0;
  std::uint64_t transitions = 0;
  std::uint64_t unknown = 0;  // runs that ended before it was known whether they get nearer
};

// Independent estimates in the order of their numbers, whatever the number of threads. Throws as `trials`.
std::vector<Replication> split(const Simulation& simulation, const Levels& levels, const RunQuestion& question,
                               const SplittingRequest& request);

}  // namespace tachk::simulation
