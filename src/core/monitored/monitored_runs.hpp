// Many runs, by several threads, on each of which formulas are evaluated while it is drawn.
#pragma once

#include <cstdint>
#include <vector>

#include "monitored/run_monitor.hpp"
#include "simulation/runs.hpp"

namespace tachk::monitored {

// The runs of which all rows stay.
enum class RecordedRows : std::int8_t {
  none,       // of every run the last row, if there is one
  violating,  // and all of the runs on which a formula is false
  all,
};

struct MonitoredRun {
  simulation::RunRecord record;
  std::vector<Decision> truths;  // of the formulas
};

// The runs in the order of their numbers, whatever the number of threads; values are recorded. Throws what `poll`
// throws, and std::invalid_argument for formulas that do not fit.
// `until_decided`: a run ends soon after every formula is decided, and its last row is the one that it has come to.
std::vector<MonitoredRun> monitored_runs(const simulation::Simulation& simulation,
                                         const std::vector<MonitoredFormula>& formulas, simulation::RunRequest request,
                                         RecordedRows rows, bool until_decided);

}  // namespace tachk::monitored
