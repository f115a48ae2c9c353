#include "monitored/monitored_runs.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>

#include "simulation/thread_pool.hpp"

namespace tachk::monitored {

using simulation::RunRecord;
using simulation::RunRequest;
using simulation::Simulation;

namespace {

constexpr std::size_t first_update = 32;  // rows; the next updates come when these have doubled

class FormulaObserver {
 public:
  FormulaObserver(const Simulation& simulation, const std::vector<MonitoredFormula>& formulas,
                  const RunRequest& request, RecordedRows rows, bool until_decided)
      : rows_(rows),
        width_(simulation.chances().observed.size()),
        recorder_(simulation, request, until_decided ? enough() : simulation::RunRecorder::Enough()) {
    for (const MonitoredFormula& formula : formulas) monitors_.push_back(std::make_unique<RunMonitor>(formula, width_));
  }

  void run(std::uint64_t number, MonitoredRun& result) {
    for (const auto& monitor : monitors_) monitor->restart();
    next_update_ = first_update;
    recorder_.run(number, record_);
    bool violated = false;
    for (const auto& monitor : monitors_) {
      result.truths.push_back(monitor->finish(record_));
      violated = violated || result.truths.back() == Decision::no;
    }
    if (rows_ == RecordedRows::all || (rows_ == RecordedRows::violating && violated)) {
      result.record = std::move(record_);
      record_ = {};
    } else {
      take_last_row(result.record);
    }
  }

 private:
  simulation::RunRecorder::Enough enough() {
    return [this](const RunRecord& record) {
      if (record.times.size() < next_update_) return false;
      next_update_ = 2 * record.times.size();
      return std::all_of(monitors_.begin(), monitors_.end(), [&](const auto& each) { return each->update(record); });
    };
  }

  void take_last_row(RunRecord& out) const {
    out.ending = record_.ending;
    out.end = record_.end;
    out.lasts = record_.lasts;
    out.transitions = record_.transitions;
    out.fault = record_.fault;
    out.position = record_.position;
    if (record_.times.empty()) return;
    out.times.assign(1, record_.times.back());
    out.observed.assign(record_.observed.end() - static_cast<std::ptrdiff_t>(width_), record_.observed.end());
  }

  RecordedRows rows_;
  std::size_t width_;
  std::size_t next_update_ = first_update;
  std::vector<std::unique_ptr<RunMonitor>> monitors_;
  RunRecord record_;
  simulation::RunRecorder recorder_;
};

}  // namespace

std::vector<MonitoredRun> monitored_runs(const Simulation& simulation, const std::vector<MonitoredFormula>& formulas,
                                         RunRequest request, RecordedRows rows, bool until_decided) {
  request.recording.observed = true;
  std::vector<MonitoredRun> result(request.runs);
  simulation::share_work(request.threads, request.runs, request.poll, [&] {
    return [&, observer = std::make_unique<FormulaObserver>(simulation, formulas, request, rows, until_decided)](
               std::uint64_t n) { observer->run(request.first + n, result[n]); };
  });
  return result;
}

}  // namespace tachk::monitored
