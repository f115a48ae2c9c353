// Where a path ends: the counterpart of a walk through tachk.meaning.symbolic.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "program/program.hpp"
#include "runs/path.hpp"

namespace tachk::runs {

struct RunEnd {
  std::vector<std::int32_t> slots;  // of the state
  std::vector<zones::Raw> bounds;   // of its clocks, row by row; empty if clocks do not allow the path
};

// The state in which a path ends. Conditions that a transition is impossible are not checked. Nothing if clocks can
// stop or the path leads beyond an invariant's integers. Throws ModelFault.
std::optional<RunEnd> end_of(const program::Program& program, const RunPath& path);

// The state after so many transitions of a run, at the moment of the last of them.
struct StateOfRun {
  std::vector<std::int32_t> slots;
  std::vector<std::int64_t> clocks;  // in ticks; the reference clock not counted
};

// Nothing if clocks can stop. Whether the run is one is for the judge to say. Throws ModelFault, and
// std::invalid_argument if there are not so many transitions or moments.
std::optional<StateOfRun> state_after(const program::Program& program, const RunPath& path, const Moments& moments,
                                      std::size_t transitions);

}  // namespace tachk::runs
