// Evaluates a formula on the runs of a simulation, in the core and run by run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "flow/clock_values.hpp"
#include "monitoring/monitor_program.hpp"
#include "monitoring/offline/offline_monitor.hpp"
#include "monitoring/online/online_truth.hpp"
#include "simulation/runs.hpp"

namespace tachk::monitored {

using monitoring::online::Decision;

// What is observed, as a column of the formula.
struct ObservedColumn {
  std::size_t number = 0;           // among the observed values
  bool floating = false;            // these are the bits of floating point numbers
  std::vector<double> values = {};  // of the numbers 0, 1, ...; empty: the numbers themselves
};

struct MonitoredFormula {
  monitoring::MonitorProgram program;
  std::vector<ObservedColumn> columns;  // of the program, in its order
  std::int64_t factor = 1;              // ticks of the program in one of the simulation
};

// The truth of one formula on one run after another, in the sense of tachk.recordings.monitors.offline: a formula is
// false only if it is false however the run goes on.
class RunMonitor {
 public:
  // Throws std::invalid_argument for a program that is not valid, or that observes what is not there.
  RunMonitor(const MonitoredFormula& formula, std::size_t observed);

  // Forgets the run.
  void restart();
  // Takes the rows that have come since. True if the rest of the run makes no difference.
  bool update(const simulation::RunRecord& record);
  // The run is over.
  Decision finish(const simulation::RunRecord& record);

 private:
  using Offline = monitoring::offline::OfflineMonitor<monitoring::offline::Truth>;

  monitoring::Samples samples(const simulation::RunRecord& record, std::size_t first, std::size_t count);
  bool certainly_false(const simulation::RunRecord& record);

  const MonitoredFormula& formula_;
  std::size_t observed_;
  Offline monitor_;
  std::size_t seen_ = 0;  // rows
  Decision decided_ = Decision::undetermined;
  flow::Ticks decided_at_ = 0;  // by what comes before this tick
  // Scratch: rows as columns.
  std::vector<std::int64_t> ticks_;
  std::vector<std::vector<double>> values_;
  std::vector<monitoring::Column> columns_;
};

}  // namespace tachk::monitored
