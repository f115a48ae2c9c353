// The online monitor against the offline one, on random formulas and traces, however the samples come.
#include "monitoring/online/online_monitor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include "check.hpp"
#include "monitoring/online/online_spans.hpp"

namespace {

using namespace tachk::monitoring;
using namespace tachk::monitoring::offline;
using namespace tachk::monitoring::online;
using Random = std::mt19937;

std::int64_t below(Random& random, std::int64_t limit) {
  return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(limit));
}

struct Recording {
  std::vector<std::int64_t> ticks;
  std::vector<double> x;
  std::vector<double> y;
  std::int64_t end = 0;
};

// Rows `first` to before `end`.
template <class Monitor>
void push(Monitor& monitor, const Recording& recording, std::size_t first, std::size_t end) {
  const Column columns[2] = {{recording.x.data() + first, nullptr}, {recording.y.data() + first, nullptr}};
  monitor.push({recording.ticks.data() + first, columns, end - first});
}

Recording random_recording(Random& random, std::int64_t rows, std::int64_t gap) {
  Recording result;
  std::int64_t tick = below(random, 100) - 50;
  const std::int64_t steady = 1 + below(random, 4);  // how rarely values change
  for (std::int64_t row = 0; row < rows; ++row) {
    result.ticks.push_back(tick);
    tick += below(random, gap + 1);
    for (std::vector<double>* column : {&result.x, &result.y})
      column->push_back(row > 0 && below(random, steady) > 0 ? column->back()
                                                             : static_cast<double>(below(random, 9) - 4) / 2);
  }
  result.end = result.ticks.back() + below(random, gap + 1);
  return result;
}

MonitorAtom comparison(Relation relation, std::size_t column, double number) {
  MonitorAtom atom;
  atom.relation = relation;
  atom.left = {{ValueOperator::column, 0, column}};
  atom.right = {{ValueOperator::constant, number, 0}};
  return atom;
}

MonitorProgram random_program(Random& random, std::int64_t bound) {
  MonitorProgram program;
  program.columns = 2;
  program.atoms = {comparison(Relation::less, 0, 0.5), comparison(Relation::greater_equal, 1, 0)};
  const auto add = [&](const MonitorNode& node) { program.nodes.push_back(node); };
  add({NodeKind::atom, {}, 0});
  add({NodeKind::atom, {}, 1});
  add({NodeKind::change, {}, 1});
  for (std::int64_t size = 1 + below(random, 6); size > 0; --size) {
    static constexpr NodeKind kinds[] = {NodeKind::logical_not, NodeKind::logical_and, NodeKind::logical_or,
                                         NodeKind::rise,        NodeKind::fall,        NodeKind::eventually,
                                         NodeKind::always,      NodeKind::once,        NodeKind::historically,
                                         NodeKind::until,       NodeKind::since};
    MonitorNode node;
    node.kind = kinds[below(random, std::size(kinds))];
    const auto operand = [&] {
      const std::size_t count = program.nodes.size();
      return below(random, 2) == 0 ? count - 1
                                   : static_cast<std::size_t>(below(random, static_cast<std::int64_t>(count)));
    };
    node.operands = {operand()};
    if (node.kind == NodeKind::logical_and || node.kind == NodeKind::logical_or || node.kind == NodeKind::until ||
        node.kind == NodeKind::since)
      node.operands.push_back(operand());
    node.lower = below(random, 2) == 0 ? 0 : below(random, bound);
    node.upper = below(random, 4) == 0 ? unbounded : node.lower + below(random, bound);
    node.lower_closed = below(random, 3) != 0;
    node.upper_closed = below(random, 3) != 0;
    add(node);
  }
  if (below(random, 2) == 0) add({NodeKind::always, {program.nodes.size() - 1}});
  return program;
}

struct Outcome {
  std::vector<Decision> verdicts;  // after each sample and at the end; of portions only the last two
  std::optional<std::int64_t> decided_at;
  std::optional<ViolatedSpan> violation;
  Range<Robustness> robustness{};
};

Outcome run(const MonitorProgram& program, const Recording& recording, Random* random) {
  OnlineMonitor monitor(program, true);
  Outcome outcome;
  const std::size_t rows = recording.ticks.size();
  Range<Robustness> bounds = monitor.robustness();
  const auto look = [&] {
    const Range<Robustness> now = monitor.robustness();
    CHECK(bounds.low <= now.low && now.low <= now.high && now.high <= bounds.high);
    bounds = now;
    if (!outcome.verdicts.empty() && outcome.verdicts.back() != Decision::undetermined)
      CHECK(outcome.verdicts.back() == monitor.verdict());
    outcome.verdicts.push_back(monitor.verdict());
  };
  for (std::size_t first = 0; first < rows;) {
    std::size_t count = 1;
    if (random != nullptr) {
      const auto rest = static_cast<std::int64_t>(rows - first);
      count = static_cast<std::size_t>(below(*random, 3) == 0 ? rest : 1 + below(*random, rest));
    }
    push(monitor, recording, first, first + count);
    first += count;
    look();
    if (random != nullptr && below(*random, 3) == 0) {
      const std::int64_t next = first < rows ? recording.ticks[first] : recording.end;
      monitor.advance(monitor.now() + below(*random, next - monitor.now() + 1));
      look();
    }
  }
  monitor.finish(recording.end);
  look();
  outcome.decided_at = monitor.decided_at();
  outcome.violation = monitor.violation();
  outcome.robustness = monitor.robustness();
  return outcome;
}

void compare(const MonitorProgram& program, const Recording& recording, Random& random) {
  OfflineMonitor<Truth> truth(program, {});
  OfflineMonitor<Robustness> margins(program, {});
  push(truth, recording, 0, recording.ticks.size());
  push(margins, recording, 0, recording.ticks.size());
  truth.finish(recording.end);
  margins.finish(recording.end);
  const Range<Truth> range = truth.verdict();
  const Decision expected =
      range.low != range.high ? Decision::undetermined : (range.low != 0 ? Decision::yes : Decision::no);
  const Outcome single = run(program, recording, nullptr);
  const Outcome cut = run(program, recording, &random);
  CHECK(single.verdicts.back() == expected);
  CHECK(cut.verdicts.back() == expected);
  for (const Outcome* outcome : {&single, &cut}) {
    CHECK(outcome->robustness.low == margins.verdict().low);
    CHECK(outcome->robustness.high == margins.verdict().high);
    CHECK(outcome->violation.has_value() == single.violation.has_value());
    if (outcome->violation) {
      CHECK(outcome->violation->cells.first == single.violation->cells.first);
      CHECK(outcome->violation->cells.end == single.violation->cells.end);
      CHECK(outcome->violation->settled == single.violation->settled);
    }
  }
  // `advance` may decide earlier than the next sample, never later.
  CHECK(cut.decided_at.has_value() == single.decided_at.has_value());
  if (cut.decided_at) CHECK(*cut.decided_at <= *single.decided_at);
}

void test_random_formulas() {
  Random random(1);
  for (int round = 0; round < 3000; ++round)
    compare(random_program(random, 5), random_recording(random, 1 + below(random, 12), 3), random);
}

// Long enough for several blocks, and for cells to be forgotten.
void test_long_traces() {
  Random random(2);
  for (int round = 0; round < 60; ++round)
    compare(random_program(random, 200), random_recording(random, 4000, 20), random);
}

MonitorProgram response(std::int64_t deadline) {
  MonitorProgram program;
  program.columns = 2;
  program.atoms = {comparison(Relation::greater, 0, 0), comparison(Relation::greater, 1, 0)};
  program.nodes = {{NodeKind::atom, {}, 0},        {NodeKind::logical_not, {0}},
                   {NodeKind::atom, {}, 1},        {NodeKind::eventually, {2}, 0, 0, deadline},
                   {NodeKind::logical_or, {1, 3}}, {NodeKind::always, {4}}};
  return program;
}

void test_a_missed_deadline_is_found_when_time_passes_it() {
  const Recording recording{{0, 10, 11}, {0, 1, 0}, {0, 0, 0}, 100};
  OnlineMonitor monitor(response(20), false);
  push(monitor, recording, 0, 3);
  monitor.advance(30);  // an answer at 30 would be in time for the question at 10
  CHECK(monitor.verdict() == Decision::undetermined);
  monitor.advance(31);
  CHECK(monitor.verdict() == Decision::no);
  CHECK(monitor.decided_at() == 31);
  CHECK(monitor.violation() && monitor.violation()->cells.first == cell_of_tick(10));
}

void test_the_last_of_several_samples_for_a_tick_counts() {
  const Recording recording{{0, 5, 5, 40}, {0, 1, 0, 0}, {0, 0, 0, 0}, 40};
  OnlineMonitor monitor(response(20), false);
  for (std::size_t n = 0; n < 4; ++n) push(monitor, recording, n, n + 1);
  monitor.finish(40);
  CHECK(monitor.verdict() == Decision::yes);
}

void test_memory_does_not_grow_with_the_trace() {
  Random random(3);
  for (const std::int64_t deadline : {180, 18000}) {
    OnlineMonitor monitor(response(deadline), true);
    std::size_t early = 0;
    for (int part = 0; part < 200; ++part) {
      Recording recording = random_recording(random, 1000, 2);
      for (std::int64_t& tick : recording.ticks) tick += part * 10000;
      push(monitor, recording, 0, recording.ticks.size());
      if (part == 40) early = monitor.bytes();
    }
    CHECK(monitor.bytes() <= 2 * early);
  }
}

void test_wrong_times_are_rejected_and_change_nothing() {
  const Recording recording{{5, 9, 7, 12}, {0, 0, 0, 0}, {0, 0, 0, 0}, 12};
  OnlineMonitor monitor(response(20), true);
  const auto rejects = [](auto call) {
    try {
      call();
    } catch (const std::invalid_argument&) {
      return true;
    }
    return false;
  };
  CHECK(rejects([&] { monitor.advance(1); }));
  CHECK(rejects([&] { monitor.finish(1); }));
  CHECK(rejects([&] { push(monitor, recording, 0, 4); }));
  push(monitor, recording, 0, 2);
  CHECK(rejects([&] { push(monitor, recording, 2, 3); }));
  CHECK(rejects([&] { monitor.advance(8); }));
  CHECK(monitor.now() == 9 && monitor.origin() == 5);
  monitor.finish(9);
  CHECK(rejects([&] { push(monitor, recording, 3, 4); }));
}

void test_sets_of_cells() {
  Random random(4);
  for (int round = 0; round < 200; ++round) {
    SpanSet set;
    std::set<Cell> cells;
    std::vector<Span> added;
    Cell floor = 0;
    for (int step = 0; step < 200; ++step) {
      const Cell first = floor + below(random, 300);
      const Span span{first, first + below(random, 20)};
      added.clear();
      set.add(span.first, span.end, added);
      std::set<Cell> fresh;
      for (const Span& piece : added)
        for (Cell cell = piece.first; cell < piece.end; ++cell) CHECK(fresh.insert(cell).second);
      for (Cell cell = span.first; cell < span.end; ++cell) CHECK(fresh.contains(cell) == cells.insert(cell).second);
      for (const Cell cell : fresh) CHECK(span.first <= cell && cell < span.end);
      if (below(random, 4) == 0) {
        floor += below(random, 10);
        set.drop_before(floor);
      }
      for (Cell cell = floor; cell < floor + 320; ++cell) CHECK(set.holds(cell) == cells.contains(cell));
      for (std::size_t n = 1; n < set.size(); ++n) CHECK(set[n - 1].end < set[n].first);
    }
  }
}

}  // namespace

int main() {
  test_sets_of_cells();
  test_random_formulas();
  test_long_traces();
  test_a_missed_deadline_is_found_when_time_passes_it();
  test_the_last_of_several_samples_for_a_tick_counts();
  test_memory_does_not_grow_with_the_trace();
  test_wrong_times_are_rejected_and_change_nothing();
  return 0;
}
