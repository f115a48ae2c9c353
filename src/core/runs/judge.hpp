// The judge of runs with exact times: walks a run through the concrete meaning of a program and accepts it only if all
// of it is right. It knows nothing of the search, nor of what gave the run its times. Its counterpart is
// tachk.meaning.judge.replay.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "program/program.hpp"
#include "runs/path.hpp"

namespace tachk::runs {

struct RunObjection {
  std::size_t step;  // from 1; 0 is the initial state
  std::string reason;
};

// The objection to a run to a goal; none if it is right. Of what it does not know (clocks that stop, priorities,
// senders over urgent channels, goals with deadlock) it says that it does not. Throws ModelFault.
std::optional<RunObjection> objection_to(const program::Program& program, const RunPath& path, const Moments& moments,
                                         const program::Goal& goal);

}  // namespace tachk::runs
