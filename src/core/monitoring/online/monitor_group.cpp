#include "monitoring/online/monitor_group.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tachk::monitoring::online {
namespace {

// Later instants are rejected, so that sums of instants and bounds of formulas fit into 64 bits.
constexpr std::int64_t furthest_tick = largest_tick / 2;

bool is_truth(double value) { return value == 0.0 || value == 1.0; }

// Notes the columns that are conditions of their own: `ok`, but not `x > 3` or `change(x)`.
void note_conditions(const MonitorGroup::Watched& watched, std::vector<std::uint8_t>& conditions) {
  for (const MonitorNode& node : watched.program.nodes) {
    if (node.kind != NodeKind::atom) continue;
    const MonitorAtom& atom = watched.program.atoms[node.atom];
    if (atom.relation == Relation::truth && atom.left.size() == 1 && atom.left[0].operation == ValueOperator::column)
      conditions[watched.places[atom.left[0].column]] = 1;
  }
}

template <class Value>
void drop(std::vector<Value>& values, std::size_t count) {
  values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count));
}

}  // namespace

MonitorGroup::MonitorGroup(std::vector<Watched> watched, std::size_t columns, bool quantitative, bool all_violations,
                           const TickScale& scale, std::int64_t reach, std::size_t most_rows)
    : held_{std::vector<double>(columns), false},
      row_(columns),
      conditions_(columns),
      goes_on_(quantitative || all_violations),
      scale_(scale),
      open_(watched.size()) {
  retained_.columns.resize(columns);
  retained_.reach = reach;
  retained_.most = most_rows;
  for (Watched& each : watched) {
    note_conditions(each, conditions_);
    Member member;
    member.monitor = std::make_unique<OnlineMonitor>(std::move(each.program), quantitative, all_violations);
    member.places = std::move(each.places);
    member.columns.resize(member.places.size());
    watched_.push_back(std::move(member));
  }
  verdict_ = joint();
}

RowFault MonitorGroup::check(int128 tick) const {
  if (progress_.finished) return RowFault::finished;
  if (!progress_.begun) return RowFault::none;
  const int128 since = tick - progress_.origin;
  if (since < progress_.now) return RowFault::backwards;
  return since >= furthest_tick ? RowFault::too_far : RowFault::none;
}

void MonitorGroup::reach(int128 tick) {
  if (!progress_.begun) {
    progress_.begun = true;
    progress_.origin = tick;
  }
  progress_.now = static_cast<std::int64_t>(tick - progress_.origin);
}

RowFault MonitorGroup::update(int128 tick, std::optional<double> time, std::span<const double> values) {
  if (const RowFault fault = check(tick); fault != RowFault::none) return fault;
  for (std::size_t n = 0; n < values.size(); ++n) {
    double value = values[n];
    if (std::isnan(value)) {
      faulty_column_ = n;
      if (!held_.known) return RowFault::missing;
      value = held_.values[n];
    } else if (conditions_[n] != 0 && !is_truth(value)) {
      faulty_column_ = n;
      return RowFault::no_truth;
    }
    row_[n] = value;
  }
  if (progress_.rows > 0 && progress_.begun && tick - progress_.origin == progress_.last_row && time &&
      progress_.last_time && *time != *progress_.last_time)
    return RowFault::merged;
  reach(tick);
  std::swap(held_.values, row_);
  held_.known = true;
  progress_.last_time = time;
  progress_.last_row = progress_.now;
  ++progress_.rows;
  forget_rows();
  if (open_ > 0) {
    retained_.ticks.push_back(progress_.now);
    for (std::size_t n = 0; n < held_.values.size(); ++n) retained_.columns[n].push_back(held_.values[n]);
  }
  decided_some_ = false;
  for (Member& member : watched_) {
    if (member.decided && !goes_on_) continue;
    for (std::size_t n = 0; n < member.places.size(); ++n)
      member.columns[n] = {&held_.values[member.places[n]], nullptr};
    feed(member, {&progress_.now, member.columns.data(), 1});
  }
  return RowFault::none;
}

RowFault MonitorGroup::push(const std::int64_t* times, std::int64_t factor, std::span<const Column> columns,
                            std::size_t count, std::size_t& row) {
  row = 0;
  decided_some_ = false;
  if (count == 0) return RowFault::none;
  for (std::size_t n = 0; n < columns.size(); ++n) {
    const double* const numbers = columns[n].numbers;
    if (conditions_[n] == 0 || numbers == nullptr) continue;
    row = static_cast<std::size_t>(std::find_if_not(numbers, numbers + count, is_truth) - numbers);
    faulty_column_ = n;
    if (row < count) return RowFault::no_truth;
    row = 0;
  }
  const auto tick = [&](std::size_t n) { return int128{times[n]} * factor; };
  if (const RowFault fault = check(tick(0)); fault != RowFault::none) return fault;
  const int128 origin = progress_.begun ? progress_.origin : tick(0);
  const bool counted = factor == 1 && origin == 0;
  if (!counted && ticks_.size() < count) ticks_.resize(count);
  // Differences fit although the times themselves may not.
  const auto start = static_cast<std::int64_t>(tick(0) - origin);
  if (counted ? first_backwards(times, count) < count : !scaled(times, count, factor, start, ticks_.data())) {
    row = first_backwards(times, count);
    return RowFault::backwards;
  }
  if (tick(count - 1) - origin >= furthest_tick) {
    while (tick(row) - origin < furthest_tick) ++row;
    return RowFault::too_far;
  }
  const std::int64_t* const ticks = counted ? times : ticks_.data();
  reach(tick(0));
  progress_.now = progress_.last_row = ticks[count - 1];
  progress_.last_time.reset();
  for (std::size_t n = 0; n < columns.size(); ++n) {
    const Column& column = columns[n];
    held_.values[n] = column.numbers != nullptr ? column.numbers[count - 1] : column.flags[count - 1] != 0 ? 1.0 : 0.0;
  }
  held_.known = true;
  progress_.rows += count;
  forget_rows();
  decided_some_ = false;
  for (Member& member : watched_) {
    if (member.decided && !goes_on_) continue;
    for (std::size_t n = 0; n < member.places.size(); ++n) member.columns[n] = columns[member.places[n]];
    feed(member, {ticks, member.columns.data(), count});
  }
  if (open_ > 0 || decided_some_) keep({ticks, columns.data(), count});
  return RowFault::none;
}

RowFault MonitorGroup::advance(int128 tick) {
  if (const RowFault fault = check(tick); fault != RowFault::none) return fault;
  if (!progress_.begun) return RowFault::missing;
  reach(tick);
  decided_some_ = false;
  for (Member& member : watched_) {
    if (member.decided && !goes_on_) continue;
    member.monitor->advance(progress_.now);
    settle();
  }
  return RowFault::none;
}

RowFault MonitorGroup::finish(std::optional<int128> tick) {
  if (!progress_.begun) return RowFault::missing;
  if (tick) {
    if (const RowFault fault = check(*tick); fault != RowFault::none) return fault;
    reach(*tick);
  }
  decided_some_ = false;
  if (progress_.finished) return RowFault::none;
  progress_.finished = true;
  for (Member& member : watched_)
    if (!member.decided || goes_on_) member.monitor->finish(progress_.now);
  settle();
  return RowFault::none;
}

void MonitorGroup::feed(Member& member, const Samples& samples) {
  member.monitor->push_ordered(samples);
  if (!member.decided && member.monitor->verdict() != Decision::undetermined) settle();
}

// Looks which formulas are decided.
void MonitorGroup::settle() {
  for (Member& member : watched_) {
    if (member.decided || member.monitor->verdict() == Decision::undetermined) continue;
    member.decided = true;
    --open_;
    decided_some_ = true;
  }
  verdict_ = joint();
}

Decision MonitorGroup::joint() const {
  bool undetermined = false;
  for (const Member& member : watched_) {
    const Decision decision = member.monitor->verdict();
    if (decision == Decision::no) return decision;
    undetermined = undetermined || decision == Decision::undetermined;
  }
  return undetermined ? Decision::undetermined : Decision::yes;
}

// An explanation looks back from the last row that the verdict rests on, and that of a violation is requested before
// the next call.
void MonitorGroup::forget_rows() {
  std::vector<std::int64_t>& ticks = retained_.ticks;
  if (open_ == 0) {
    ticks.clear();
    for (std::vector<double>& column : retained_.columns) column.clear();
    retained_.head = 0;
    return;
  }
  if (ticks.empty()) return;
  const std::int64_t oldest = ticks.back() - retained_.reach - 1;
  std::size_t& head = retained_.head;
  while (head + 1 < ticks.size() && (ticks[head + 1] <= oldest || ticks.size() - head > retained_.most)) {
    ++head;
    retained_.whole = false;
  }
  if (head < 1024 || 2 * head < ticks.size()) return;
  drop(ticks, head);
  for (std::vector<double>& column : retained_.columns) drop(column, head);
  head = 0;
}

// Of many rows only those which a later explanation needs, or all of them if there is something to explain.
void MonitorGroup::keep(const Samples& samples) {
  std::size_t first = 0;
  if (!decided_some_) {
    const std::int64_t oldest = samples.ticks[samples.count - 1] - retained_.reach - 1;
    const std::int64_t* const end = samples.ticks + samples.count;
    first = static_cast<std::size_t>(std::upper_bound(samples.ticks, end, oldest) - samples.ticks);
    if (first > 0) --first;  // its values hold still
    if (samples.count - first > retained_.most) first = samples.count - retained_.most;
  }
  if (first > 0) {
    retained_.ticks.clear();
    for (std::vector<double>& column : retained_.columns) column.clear();
    retained_.head = 0;
    retained_.whole = false;
  }
  retained_.ticks.insert(retained_.ticks.end(), samples.ticks + first, samples.ticks + samples.count);
  for (std::size_t n = 0; n < retained_.columns.size(); ++n) {
    const Column& column = samples.columns[n];
    std::vector<double>& retained = retained_.columns[n];
    if (column.numbers != nullptr) {
      retained.insert(retained.end(), column.numbers + first, column.numbers + samples.count);
    } else {
      for (std::size_t row = first; row < samples.count; ++row) retained.push_back(column.flags[row] != 0 ? 1.0 : 0.0);
    }
  }
}

}  // namespace tachk::monitoring::online
