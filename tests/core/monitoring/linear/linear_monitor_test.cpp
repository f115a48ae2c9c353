// Monitors of lines: on steps they agree with the monitors of steps, on lines with those of finely sampled lines.
#include "monitoring/linear/linear_monitor.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <vector>

#include "check.hpp"
#include "monitoring/monitor_cases.hpp"

namespace {

using namespace tachk::monitoring;
using namespace tachk::monitoring::linear;
using namespace tachk::monitoring::offline;

constexpr double infinity = std::numeric_limits<double>::infinity();

double at(const Signal<Robustness>& signal, Cell cell, bool high) {
  const auto next = std::upper_bound(signal.starts.begin(), signal.starts.end(), cell);
  const auto piece = static_cast<std::size_t>(next - signal.starts.begin()) - 1;
  return high ? signal.high[piece] : signal.low[piece];
}

Truth at(const Signal<Truth>& signal, Cell cell, bool high) {
  const auto next = std::upper_bound(signal.starts.begin(), signal.starts.end(), cell);
  const auto piece = static_cast<std::size_t>(next - signal.starts.begin()) - 1;
  return high ? signal.high[piece] : signal.low[piece];
}

double value_at(const LinearSignal& signal, double time) {
  const auto next =
      std::upper_bound(signal.begin(), signal.end(), time, [](double t, const LinearPiece& p) { return t < p.start; });
  const LinearPiece& piece = *std::prev(next);
  if (piece.start == time) return piece.at;
  if (next == signal.end() || piece.after == piece.before) return piece.after;
  return piece.after + (piece.before - piece.after) * ((time - piece.start) / (next->start - piece.start));
}

// Flags do not move, so combinations of them are steps.
void test_steps() {
  Random random(30);
  for (int round = 0; round < 3000; ++round) {
    MonitorProgram program = random_program(random);
    for (std::size_t n = 1; n < columns; ++n)
      program.atoms[n].left = {{ValueOperator::column, 0, n},     {ValueOperator::constant, 0.75, 0},
                               {ValueOperator::multiply, 0, 0},   {ValueOperator::column, 0, 0},
                               {ValueOperator::constant, 2.0, 0}, {ValueOperator::divide, 0, 0},
                               {ValueOperator::subtract, 0, 0}};
    Trace trace = random_trace(random, 1 + below(random, 8));
    std::vector<std::vector<std::uint8_t>> flags(columns);
    std::vector<Column> view;
    for (std::vector<std::uint8_t>& column : flags) {
      for (std::size_t n = 0; n < trace.ticks.size(); ++n)
        column.push_back(static_cast<std::uint8_t>(below(random, 2)));
      view.push_back({nullptr, column.data()});
    }
    const Samples samples{trace.ticks.data(), view.data(), trace.ticks.size()};
    const std::size_t root = program.nodes.size() - 1;

    LinearMonitor lines(program, RobustnessKind::space);
    lines.push(samples);
    lines.finish(trace.end);
    OfflineMonitor<Robustness> steps(program, {true, {root}});
    steps.push(samples);
    steps.finish(trace.end);
    OfflineMonitor<Truth> truths(program, {true, {root}});
    truths.push(samples);
    truths.finish(trace.end);

    const Cell last = cell_of_tick(trace.end - trace.ticks[0]);
    for (const bool high : {false, true}) {
      const LinearSignal found = lines.robustness(root, high);
      for (Cell cell = 0; cell <= last; ++cell)
        CHECK(value_at(found, static_cast<double>(cell) / 2) == at(steps.signal(0), cell, high));
      const Signal<Truth> truth = lines.truth_signal(root);
      for (Cell cell = 0; cell <= last; ++cell) {
        const Cell fine = is_instant(cell) ? cell * lines.refinement() : (cell - 1) * lines.refinement() + 3;
        CHECK(at(truth, fine, high) == at(truths.signal(0), cell, high));
      }
    }
    CHECK(lines.truth().verdict.low == truths.verdict().low);
    CHECK(lines.truth().verdict.high == truths.verdict().high);
    CHECK(lines.truth().violation.has_value() == truths.violation().has_value());
  }
}

bool is_close(double left, double right, double tolerance) {
  return left == right || std::abs(left - right) <= tolerance;
}

void test_lines() {
  constexpr std::int64_t parts = 64;
  Random random(31);
  for (int round = 0; round < 1500; ++round) {
    MonitorProgram program = random_program(random);
    bool smooth = true;
    for (std::size_t n = 0; n < program.nodes.size(); ++n) {
      MonitorNode& node = program.nodes[n];
      if (node.kind == NodeKind::atom || node.kind == NodeKind::change) {
        node.kind = NodeKind::atom;
        node.atom = 1 + n % 2;
      }
      smooth = smooth && node.kind != NodeKind::rise && node.kind != NodeKind::fall;
      // A supremum over an empty window would make a jump.
      if (node.upper == node.lower) node.lower_closed = node.upper_closed = true;
    }
    if (!smooth) continue;
    const Trace trace = random_trace(random, 1 + below(random, 8));
    const std::size_t root = program.nodes.size() - 1;
    LinearMonitor lines(program, RobustnessKind::space);
    feed(lines, trace, &random);
    const LinearSignal found[] = {lines.robustness(root, false), lines.robustness(root, true)};

    // The same lines in small steps. Numbers are quarters between 0 and 1.
    Trace fine;
    fine.numbers.resize(columns);
    const double slope = 1.0 / parts;
    for (std::size_t n = 0; n < trace.ticks.size(); ++n) {
      if (n + 1 < trace.ticks.size() && trace.ticks[n + 1] == trace.ticks[n]) continue;
      const std::int64_t start = trace.ticks[n];
      std::size_t next = n + 1;
      while (next + 1 < trace.ticks.size() && trace.ticks[next + 1] == trace.ticks[next]) ++next;
      const bool moves = next < trace.ticks.size();
      const std::int64_t length = moves ? (trace.ticks[next] - start) * parts : 1;
      for (std::int64_t step = 0; step < length; ++step) {
        fine.ticks.push_back(start * parts + step);
        fine.flags.push_back(0);
        for (std::size_t c = 0; c < columns; ++c) {
          const double here = trace.numbers[c][n];
          const double there = moves ? trace.numbers[c][next] : here;
          fine.numbers[c].push_back(here + (there - here) * static_cast<double>(step) / static_cast<double>(length));
        }
      }
    }
    fine.end = trace.end * parts;
    MonitorProgram finer = program;
    for (MonitorNode& node : finer.nodes) {
      node.lower *= parts;
      if (node.upper != unbounded) node.upper *= parts;
    }
    OfflineMonitor<Robustness> steps(finer, {true, {root}});
    feed(steps, fine, nullptr);
    const Signal<Robustness> expected = steps.signal(0);
    for (std::int64_t tick = 0; tick <= lines.length() * 4; ++tick)
      for (const bool high : {false, true}) {
        const double value = value_at(found[high ? 1 : 0], static_cast<double>(tick) / 4);
        CHECK(is_close(value, at(expected, cell_of_tick(tick * parts / 4), high), 1.5 * slope));
      }
    const Range<Truth> truth = lines.truth().verdict;
    if (value_at(found[0], 0) > 0) CHECK(truth.low == 1);
    if (value_at(found[1], 0) < 0) CHECK(truth.high == 0);
  }
}

MonitorProgram below_half() {
  MonitorProgram program;
  program.columns = 1;
  program.atoms.push_back({Relation::less, {{ValueOperator::column, 0, 0}}, {{ValueOperator::constant, 0.5, 0}}});
  program.nodes.push_back({NodeKind::atom, {}});
  program.nodes.push_back({NodeKind::always, {0}});
  return program;
}

template <class Monitor>
void push(Monitor& monitor, const std::vector<std::int64_t>& ticks, const std::vector<double>& values) {
  const Column column{values.data(), nullptr};
  monitor.push({ticks.data(), &column, ticks.size()});
}

void test_violation_begins_at_the_crossing() {
  LinearMonitor monitor(below_half(), RobustnessKind::space);
  push(monitor, {0, 4, 8}, {0, 2, 0});
  monitor.finish(10);
  const auto judgement = monitor.truth();
  CHECK(judgement.verdict.high == 0 && judgement.violation);
  CHECK(judgement.violation->first == cell_of_tick(monitor.refinement()));
  CHECK(judgement.violation->last == cell_of_tick(7 * monitor.refinement()));
  CHECK(value_at(monitor.robustness(1, false), 0) == -1.5);
  CHECK(value_at(monitor.robustness(0, false), 3) == -1.0);
}

void test_robustness_in_time() {
  const auto measure = [](RobustnessKind what, double time, bool high) {
    LinearMonitor monitor(below_half(), what);
    push(monitor, {0, 4, 8}, {0, 2, 0});
    monitor.finish(10);
    return value_at(monitor.robustness(0, high), time);
  };
  CHECK(measure(RobustnessKind::ahead, 0, false) == 4 && measure(RobustnessKind::ahead, 3, true) == 1);
  CHECK(measure(RobustnessKind::ahead, 4, false) == -4 && measure(RobustnessKind::ahead, 7.5, false) == -0.5);
  CHECK(measure(RobustnessKind::ahead, 8, false) == 2 && measure(RobustnessKind::ahead, 8, true) == infinity);
  CHECK(measure(RobustnessKind::behind, 3, false) == 3 && measure(RobustnessKind::behind, 6, true) == -2);
  CHECK(measure(RobustnessKind::behind, 4, false) == 0 && measure(RobustnessKind::behind, 10, false) == 2);
}

void test_products_are_rejected() {
  MonitorProgram program = below_half();
  program.atoms[0].left = {
      {ValueOperator::column, 0, 0}, {ValueOperator::column, 0, 0}, {ValueOperator::multiply, 0, 0}};
  bool rejected = false;
  try {
    const LinearMonitor monitor(program, RobustnessKind::space);
  } catch (const std::invalid_argument&) {
    rejected = true;
  }
  CHECK(rejected);
}

}  // namespace

int main() {
  test_steps();
  test_lines();
  test_violation_begins_at_the_crossing();
  test_robustness_in_time();
  test_products_are_rejected();
  return 0;
}
