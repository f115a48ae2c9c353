// Random trials: each run ends as soon as the answer to its question is known.
#pragma once

#include <cstdint>
#include <vector>

#include "simulation/horizon.hpp"
#include "simulation/runs.hpp"
#include "simulation/simulator.hpp"

namespace tachk::simulation {

struct RunQuestion {
  Bound bound;
  std::int32_t goal = -1;  // of the program: the run ends where it is reached; -1: nothing is to be reached
  std::int32_t lost = -1;  // another one: where this is reached before, the goal counts no more
  // The measured value is the number `observed` of the chances, or the value of a clock: its extreme value on the run.
  std::int32_t observed = -1;
  std::uint16_t clock = 0;
  bool largest = true;

  bool measures() const { return observed >= 0 || clock > 0; }
};

enum class Answered : std::int8_t {
  no,       // the whole run was looked at, and the goal is not reached
  yes,      // it is
  unknown,  // the run ended before that was known: too many steps, or a run-time error
};

struct Trial {
  Answered answer = Answered::no;
  Ending ending = Ending::horizon;
  flow::Ticks end = 0;  // the moment at which the goal is reached, or up to which the run was looked at
  std::uint64_t transitions = 0;
  std::uint64_t instructions = 0;  // of code, as far as jumps count them
  double measured = 0;
  machine::FaultKind fault = machine::FaultKind::range;
  std::int32_t position = program::no_code;
};

struct TrialRequest {
  std::uint64_t seed = 0;
  std::uint64_t first = 0;
  std::uint64_t runs = 1;
  unsigned threads = 1;
  Policy policy = Policy::stochastic;
  std::uint64_t most_steps = UINT64_MAX;  // after which a run is given up
  Poll poll = {};
};

// The runs in the order of their numbers, whatever the number of threads. Throws what `poll` throws, and
// std::invalid_argument for numbers that the program does not have.
std::vector<Trial> trials(const Simulation& simulation, const RunQuestion& question, const TrialRequest& request);

// Throws std::invalid_argument for numbers that the program does not have.
void check(const Simulation& simulation, const RunQuestion& question);

}  // namespace tachk::simulation
