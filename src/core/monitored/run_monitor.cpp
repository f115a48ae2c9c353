#include "monitored/run_monitor.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>

#include "monitoring/online/online_monitor.hpp"

namespace tachk::monitored {

using simulation::RunRecord;

RunMonitor::RunMonitor(const MonitoredFormula& formula, std::size_t observed)
    : formula_(formula),
      observed_(observed),
      monitor_(formula.program, {.lasting = false}),
      values_(formula.columns.size()),
      columns_(formula.columns.size()) {
  if (formula.columns.size() != formula.program.columns) throw std::invalid_argument("a column is missing or too many");
  for (const ObservedColumn& column : formula.columns)
    if (column.number >= observed) throw std::invalid_argument("nothing of this number is observed");
}

void RunMonitor::restart() {
  monitor_.restart();
  seen_ = 0;
  decided_ = Decision::undetermined;
}

// Rows of a record, in the ticks of the program. They stay where they are until the next call.
monitoring::Samples RunMonitor::samples(const RunRecord& record, std::size_t first, std::size_t count) {
  ticks_.resize(count);
  for (std::size_t n = 0; n < count; ++n) ticks_[n] = record.times[first + n] * formula_.factor;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const ObservedColumn& column = formula_.columns[c];
    const std::int64_t* cell = record.observed.data() + first * observed_ + column.number;
    std::vector<double>& values = values_[c];
    values.resize(count);
    for (std::size_t n = 0; n < count; ++n, cell += observed_) {
      if (column.floating) {
        values[n] = std::bit_cast<double>(*cell);
      } else if (column.values.empty()) {
        values[n] = static_cast<double>(*cell);
      } else {
        values[n] = column.values.at(static_cast<std::size_t>(*cell));
      }
    }
    columns_[c].numbers = values.data();
  }
  return {ticks_.data(), columns_.data(), count};
}

// Where no time passes at the end of a run, a tick before it is the last one of which all is known: what is decided to
// be false counts when that has passed.
bool RunMonitor::update(const RunRecord& record) {
  if (decided_ == Decision::undetermined && seen_ < record.times.size()) {
    monitor_.push(samples(record, seen_, record.times.size() - seen_));
    seen_ = record.times.size();
    const auto range = monitor_.so_far();
    if (range.low != range.high) return false;
    decided_ = range.low != 0 ? Decision::yes : Decision::no;
    decided_at_ = record.times.back();
  }
  return decided_ == Decision::yes || (decided_ == Decision::no && record.times.back() > decided_at_);
}

Decision RunMonitor::finish(const RunRecord& record) {
  if (record.times.empty()) return Decision::undetermined;
  if (update(record) || (decided_ == Decision::no && (record.lasts || record.end > decided_at_))) return decided_;
  monitor_.finish(record.end * formula_.factor);
  const auto range = monitor_.verdict();
  if (range.low != range.high) return Decision::undetermined;
  if (range.low != 0) return Decision::yes;
  return certainly_false(record) ? Decision::no : Decision::undetermined;
}

// The formula is false on the run: true if it is false however the run goes on. If no time passes at the end, other
// transitions may follow at that instant, of which nothing is known.
bool RunMonitor::certainly_false(const RunRecord& record) {
  const flow::Ticks known = (record.lasts ? record.end + 1 : std::max<flow::Ticks>(record.end - 1, 0));
  const auto later = std::lower_bound(record.times.begin(), record.times.end(), known);
  const auto rows = std::max<std::ptrdiff_t>(later - record.times.begin(), 1);
  monitoring::online::OnlineMonitor online(formula_.program, false);
  online.push(samples(record, 0, static_cast<std::size_t>(rows)));
  online.advance(known * formula_.factor);
  return online.verdict() == Decision::no;
}

}  // namespace tachk::monitored
