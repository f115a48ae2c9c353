// Several formulas on one growing trace: counts its times, looks after its values, and keeps the rows that may be
// needed to explain a violation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "monitoring/monitor_program.hpp"
#include "monitoring/monitor_samples.hpp"
#include "monitoring/online/online_monitor.hpp"
#include "monitoring/ticks.hpp"

namespace tachk::monitoring::online {

// Why a row is not taken. Nothing has changed then.
enum class RowFault {
  none,
  finished,     // the trace is over
  backwards,    // the time lies before the one given last
  too_far,      // the time is too far from the beginning to be counted
  merged,       // another time than that of the row before, but the same tick
  not_a_time,   // not finite, or not to be counted at all
  missing,      // the column has no value yet
  no_truth,     // the column is used as a condition, and its value is neither 0 nor 1
  not_a_value,  // the value of the column is no number
};

class MonitorGroup {
 public:
  struct Watched {
    MonitorProgram program;
    std::vector<std::size_t> places;  // of its columns among those of the group
  };

  // `reach`: so many ticks before the last row are looked at by an explanation; of rows before, at most `most_rows` are
  // kept in any case.
  MonitorGroup(std::vector<Watched> watched, std::size_t columns, bool quantitative, bool all_violations,
               const TickScale& scale, std::int64_t reach, std::size_t most_rows);
  MonitorGroup(const MonitorGroup&) = delete;
  MonitorGroup& operator=(const MonitorGroup&) = delete;

  // One row at an instant in ticks of the clock. Values are numbers, or NaN where the one before stays.
  RowFault update(int128 tick, std::optional<double> time, std::span<const double> values);
  // Many rows; the columns are those of the group, and of numbers. Each time is `factor` ticks. `row` is that of the
  // fault.
  RowFault push(const std::int64_t* times, std::int64_t factor, std::span<const Column> columns, std::size_t count,
                std::size_t& row);
  // Nothing has changed before this instant.
  RowFault advance(int128 tick);
  // The trace is over, with this instant or the one reached.
  RowFault finish(std::optional<int128> tick);

  // no if one formula is violated, else undetermined if one is, else yes.
  Decision verdict() const { return verdict_; }
  // True if the last call decided something. Rows are kept until the next one.
  bool decided_some() const { return decided_some_; }
  std::size_t open() const { return open_; }
  std::size_t size() const { return watched_.size(); }
  std::size_t columns() const { return held_.values.size(); }
  // The column of the fault of the last row.
  std::size_t faulty_column() const { return faulty_column_; }
  // Ticks of a formula are counted from `origin`, the instant of the first row.
  OnlineMonitor& monitor(std::size_t number) { return *watched_[number].monitor; }
  const OnlineMonitor& monitor(std::size_t number) const { return *watched_[number].monitor; }
  bool begun() const { return progress_.begun; }
  int128 origin() const { return progress_.origin; }
  std::int64_t now() const { return progress_.now; }
  std::size_t rows() const { return progress_.rows; }
  // The value that a column has.
  std::optional<double> held(std::size_t column) const {
    return held_.known ? std::optional(held_.values.at(column)) : std::nullopt;
  }
  const TickScale& scale() const { return scale_; }

  // The rows that are kept, counted from the origin; whether they are all there were.
  std::span<const std::int64_t> retained_ticks() const { return std::span(retained_.ticks).subspan(retained_.head); }
  std::span<const double> retained_column(std::size_t column) const {
    return std::span(retained_.columns[column]).subspan(retained_.head);
  }
  bool has_all_rows() const { return retained_.whole; }

 private:
  struct Member {
    std::unique_ptr<OnlineMonitor> monitor;
    std::vector<std::size_t> places;
    std::vector<Column> columns;
    bool decided = false;
  };
  struct RetainedRows {
    std::vector<std::int64_t> ticks;
    std::vector<std::vector<double>> columns;
    std::size_t head = 0;
    bool whole = true;
    std::int64_t reach = 0;
    std::size_t most = 0;
  };
  // The values that the columns have.
  struct Held {
    std::vector<double> values;
    bool known = false;
  };
  // How far time has come.
  struct Progress {
    bool begun = false;
    bool finished = false;
    int128 origin = 0;
    std::int64_t now = 0;
    std::optional<double> last_time;  // of the last row, where it was given as a floating-point number
    std::int64_t last_row = 0;        // its tick
    std::size_t rows = 0;
  };

  RowFault check(int128 tick) const;
  void reach(int128 tick);
  void feed(Member& member, const Samples& samples);
  void settle();
  Decision joint() const;
  void forget_rows();
  void keep(const Samples& samples);

  std::vector<Member> watched_;
  Held held_;
  std::vector<double> row_;
  std::vector<std::uint8_t> conditions_;  // whether a formula uses a column as a condition
  std::vector<std::int64_t> ticks_;
  bool goes_on_;  // with formulas that are decided
  TickScale scale_;
  RetainedRows retained_;
  Decision verdict_ = Decision::undetermined;
  std::size_t open_;
  bool decided_some_ = false;
  Progress progress_;
  std::size_t faulty_column_ = 0;
};

}  // namespace tachk::monitoring::online
