// When the transitions of a path can happen: the counterpart of `earliest` in tachk.engine.exact.schedule.
//
// The moments of the transitions are unknowns. As long as all clocks run, each clock constraint bounds the difference
// of two moments from below, and relaxation (Bellman and Ford) finds the least ones. A moment is an integer, and an
// infinitesimal for each strict bound on the way to it. What depends on a transition being impossible (urgent channels,
// receivers of a broadcast that stay out, priorities) is not checked here: the judge sees to that.
#pragma once

#include <optional>

#include "program/program.hpp"
#include "runs/path.hpp"

namespace tachk::runs {

// The earliest moments at which the transitions of a path can happen, and the end at which a goal holds. Nothing if
// there are none, if they are not found with reasonable effort, or if clocks can stop.
std::optional<Moments> earliest_moments(const program::Program& program, const RunPath& path,
                                        const program::Goal& goal);

}  // namespace tachk::runs
