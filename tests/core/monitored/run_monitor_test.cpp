// Formulas on records of runs, looked at while they grow, against the monitors of whole and of growing traces.
#include "monitored/run_monitor.hpp"

#include <algorithm>
#include <optional>

#include "check.hpp"
#include "monitoring/monitor_cases.hpp"
#include "monitoring/online/online_monitor.hpp"

namespace {

using namespace tachk::monitored;
using namespace tachk::monitoring;
using tachk::simulation::RunRecord;

constexpr std::int64_t factor = 2;

// Quarters as their numbers, what is true as texts that stand for it.
MonitoredFormula formula_of(MonitorProgram program) {
  MonitoredFormula formula{std::move(program), {}, factor};
  formula.columns.push_back({2, false, {1, 0}});
  for (std::size_t column = 1; column < columns; ++column)
    formula.columns.push_back({column - 1, false, {0, 0.25, 0.5, 0.75, 1}});
  return formula;
}

RunRecord record_of(const Trace& trace, bool lasts) {
  RunRecord record;
  for (const std::int64_t tick : trace.ticks) record.times.push_back(tick - trace.ticks.front());
  for (std::size_t row = 0; row < trace.ticks.size(); ++row) {
    for (std::size_t column = 1; column < columns; ++column)
      record.observed.push_back(static_cast<std::int64_t>(4 * trace.numbers[column][row]));
    record.observed.push_back(1 - trace.flags[row]);
  }
  record.end = lasts ? trace.end - trace.ticks.front() : record.times.back();
  record.lasts = lasts;
  return record;
}

template <class Monitor>
void push(Monitor& monitor, const Trace& trace, std::size_t rows) {
  std::vector<std::int64_t> ticks;
  for (std::size_t row = 0; row < rows; ++row) ticks.push_back(factor * (trace.ticks[row] - trace.ticks.front()));
  std::vector<Column> view;
  for (const auto& numbers : trace.numbers) view.push_back({numbers.data(), nullptr});
  monitor.push({ticks.data(), view.data(), rows});
}

// What `RunMonitor` has to find, each time by new monitors.
Decision definition(const MonitorProgram& program, const Trace& trace, const RunRecord& record) {
  offline::OfflineMonitor<offline::Truth> whole(program, {});
  push(whole, trace, trace.ticks.size());
  whole.finish(factor * record.end);
  if (whole.verdict().low != whole.verdict().high) return Decision::undetermined;
  if (whole.verdict().low != 0) return Decision::yes;
  const std::int64_t known = record.lasts ? record.end + 1 : std::max<std::int64_t>(record.end - 1, 0);
  const auto rows = std::lower_bound(record.times.begin(), record.times.end(), known) - record.times.begin();
  online::OnlineMonitor growing(program, false);
  push(growing, trace, static_cast<std::size_t>(std::max<std::ptrdiff_t>(rows, 1)));
  growing.advance(factor * known);
  return growing.verdict() == Decision::no ? Decision::no : Decision::undetermined;
}

RunRecord beginning(const RunRecord& whole, std::size_t rows) {
  RunRecord record;
  record.times.assign(whole.times.begin(), whole.times.begin() + static_cast<std::ptrdiff_t>(rows));
  record.observed.assign(whole.observed.begin(), whole.observed.begin() + static_cast<std::ptrdiff_t>(columns * rows));
  return record;
}

void test_random_formulas() {
  Random random(30);
  int counts[3] = {0, 0, 0};
  int settled = 0;
  for (int round = 0; round < 3000; ++round) {
    const MonitoredFormula formula = formula_of(random_program(random));
    RunMonitor monitor(formula, columns);
    for (int turn = 0; turn < 3; ++turn) {
      const Trace trace = random_trace(random, 1 + below(random, 12));
      const RunRecord whole = record_of(trace, below(random, 2) == 0);
      const Decision expected = definition(formula.program, trace, whole);
      ++counts[static_cast<std::size_t>(expected)];
      bool ended = false;
      for (std::size_t rows = 1; rows <= whole.times.size() && !ended; ++rows) {
        if (below(random, 3) == 0) continue;
        const RunRecord part = beginning(whole, rows);
        ended = monitor.update(part);
        if (ended) CHECK(monitor.finish(part) == expected);
      }
      if (ended) ++settled;
      if (!ended) CHECK(monitor.finish(whole) == expected);
      monitor.restart();
    }
  }
  CHECK(counts[0] > 500 && counts[1] > 500 && counts[2] > 100 && settled > 1000);
}

}  // namespace

int main() { test_random_formulas(); }
