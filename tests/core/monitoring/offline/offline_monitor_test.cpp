// Offline monitors against the definitions, cell by cell, on random formulas and traces cut into random portions.
#include "monitoring/offline/offline_monitor.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "check.hpp"
#include "monitoring/monitor_cases.hpp"

namespace {

using namespace tachk::monitoring;
using namespace tachk::monitoring::offline;

// The values of all nodes on the cells from 0 to far behind the end of the trace; after the last one nothing changes.
template <class Value>
class Definition {
  using Order = Lattice<Value, false>;
  using Cells = std::vector<Value>;

 public:
  Definition(const MonitorProgram& program, const Trace& trace, bool high)
      : program_(program), trace_(trace), high_(high), last_(2 * (trace.end - trace.ticks[0])) {
    std::int64_t reach = 0;
    for (const MonitorNode& node : program.nodes) reach += std::max(node.lower, node.upper);
    cells_ = last_ + 2 * reach + 5;
    for (std::size_t n = 0; n < program.nodes.size(); ++n) values_.push_back({node(n, high), node(n, !high)});
  }

  Value at(std::size_t number, Cell cell) const { return values_[number][0][static_cast<std::size_t>(cell)]; }

 private:
  Cells node(std::size_t number, bool high) const {
    const MonitorNode& what = program_.nodes[number];
    Cells result(static_cast<std::size_t>(cells_));
    for (Cell c = 0; c < cells_; ++c) result[static_cast<std::size_t>(c)] = value(what, c, high);
    return result;
  }

  Value get(std::size_t operand, bool high, Cell cell) const {
    return values_[operand][high == high_ ? 0 : 1][static_cast<std::size_t>(std::min(cell, cells_ - 1))];
  }

  static Value opposite(Value value) {
    if constexpr (std::is_same_v<Value, Truth>) return value == 0 ? 1 : 0;
    return static_cast<Value>(-value);
  }

  Value value(const MonitorNode& what, Cell c, bool high) const {
    const auto operand = [&](std::size_t n, Cell cell) { return get(what.operands[n], high, cell); };
    const auto negated = [&](std::size_t n, Cell cell) { return opposite(get(what.operands[n], !high, cell)); };
    const auto before = [&](Cell cell) { return is_instant(cell) ? cell - 1 : cell; };
    switch (what.kind) {
      case NodeKind::always_false:
        return Order::bottom;
      case NodeKind::always_true:
        return Order::top;
      case NodeKind::atom:
      case NodeKind::change:
        return leaf(what, c, high);
      case NodeKind::logical_not:
        return negated(0, c);
      case NodeKind::logical_and:
      case NodeKind::logical_or: {
        Value result = operand(0, c);
        for (std::size_t n = 1; n < what.operands.size(); ++n)
          result = what.kind == NodeKind::logical_and ? Order::meet(result, operand(n, c))
                                                      : Order::join(result, operand(n, c));
        return result;
      }
      case NodeKind::rise:
        return c == 0 ? operand(0, 0) : Order::meet(operand(0, c), negated(0, before(c)));
      case NodeKind::fall:
        return c == 0 ? Order::bottom : Order::meet(negated(0, c), operand(0, before(c)));
      case NodeKind::eventually:
        return ahead(what, c, high, [](Cell) { return Order::top; }, [&](Cell x) { return operand(0, x); });
      case NodeKind::always:
        return opposite(
            ahead(what, c, !high, [](Cell) { return Order::top; }, [&](Cell x) { return opposite(operand(0, x)); }));
      case NodeKind::once:
        return behind(what, c, [](Cell) { return Order::top; }, [&](Cell x) { return operand(0, x); });
      case NodeKind::historically:
        return opposite(
            behind(what, c, [](Cell) { return Order::top; }, [&](Cell x) { return opposite(operand(0, x)); }));
      case NodeKind::until:
        return ahead(what, c, high, [&](Cell x) { return operand(0, x); }, [&](Cell x) { return operand(1, x); });
      default:
        return behind(what, c, [&](Cell x) { return operand(0, x); }, [&](Cell x) { return operand(1, x); });
    }
  }

  Value leaf(const MonitorNode& what, Cell c, bool high) const {
    const MonitorAtom& atom = program_.atoms[what.atom];
    const std::size_t column = atom.left[0].column;
    if (what.kind == NodeKind::change && c == 0) return Order::bottom;
    if (c > last_) return high ? Order::top : Order::bottom;
    const double left = sample(column, c);
    if (what.kind == NodeKind::change)
      return is_instant(c) && left != sample(column, c - 1) ? Order::top : Order::bottom;
    if (atom.relation == Relation::truth) return left != 0 ? Order::top : Order::bottom;
    const double right = atom.right[0].number;
    if constexpr (std::is_same_v<Value, Truth>) return left < right;
    return static_cast<Value>(right - left);
  }

  double sample(std::size_t column, Cell c) const {
    std::size_t row = 0;
    while (row + 1 < trace_.ticks.size() && 2 * (trace_.ticks[row + 1] - trace_.ticks[0]) <= c) ++row;
    return trace_.numbers[column][row];
  }

  // f holds from cell c on until a witness in cell w; both cells are looked at from their first instants on.
  template <class F, class G>
  Value ahead(const MonitorNode& what, Cell c, bool high, F f, G g) const {
    const CellWindow window = future_window(what);
    if (window.empty) return Order::bottom;
    const CellOffsets offsets = is_instant(c) ? window.even : window.odd;
    Cell stop = what.upper == unbounded ? last_ : c + offsets.last;
    if (what.upper == unbounded && c > last_) stop = high ? cells_ + 2 * what.lower + 4 : c;
    const bool now = what.lower == 0 && what.lower_closed;
    if (what.upper == unbounded && c > last_ && !high) return now ? g(c) : Order::bottom;
    Value result = Order::bottom;
    for (Cell w = c + offsets.first; w <= stop; ++w) {
      Value holds = g(w);
      if (!(w == c && now)) {
        for (Cell x = c; x < w; ++x) holds = Order::meet(holds, f(x));
        if (!is_instant(w)) holds = Order::meet(holds, f(w));
      }
      result = Order::join(result, holds);
    }
    return result;
  }

  template <class F, class G>
  Value behind(const MonitorNode& what, Cell c, F f, G g) const {
    const CellWindow window = past_window(what);
    if (window.empty) return Order::bottom;
    const CellOffsets offsets = is_instant(c) ? window.even : window.odd;
    const bool now = what.lower == 0 && what.lower_closed;
    Value result = Order::bottom;
    for (Cell w = c + offsets.last; w >= std::max(Cell{0}, c + offsets.first); --w) {
      Value holds = g(w);
      if (!(w == c && now)) {
        for (Cell x = w + 1; x <= c; ++x) holds = Order::meet(holds, f(x));
        if (!is_instant(w)) holds = Order::meet(holds, f(w));
      }
      result = Order::join(result, holds);
    }
    return result;
  }

  const MonitorProgram& program_;
  const Trace& trace_;
  bool high_;
  Cell last_;
  Cell cells_ = 0;
  std::vector<std::array<Cells, 2>> values_;
};

template <class Value>
void compare(const MonitorProgram& program, const Trace& trace, Random& random) {
  const std::size_t root = program.nodes.size() - 1;
  const Definition<Value> low(program, trace, false);
  const Definition<Value> high(program, trace, true);
  const Cell last = cell_of_tick(trace.end - trace.ticks[0]);
  OfflineMonitor<Value> monitor(program, {true, {root}});
  feed(monitor, trace, &random);
  CHECK(monitor.verdict().low == low.at(root, 0));
  CHECK(monitor.verdict().high == high.at(root, 0));
  const Signal<Value> signal = monitor.signal(0);
  std::size_t piece = 0;
  for (Cell cell = 0; cell <= last; ++cell) {
    if (piece + 1 < signal.starts.size() && signal.starts[piece + 1] == cell) ++piece;
    CHECK(signal.low[piece] == low.at(root, cell));
    CHECK(signal.high[piece] == high.at(root, cell));
  }
}

void test_random_formulas() {
  Random random(20);
  for (int round = 0; round < 4000; ++round) {
    const MonitorProgram program = random_program(random);
    const Trace trace = random_trace(random, 1 + below(random, 10));
    compare<Truth>(program, trace, random);
    compare<Robustness>(program, trace, random);
  }
}

// Long enough for several blocks, bursts and dropped pieces; the two ways of cutting must agree.
void test_long_traces() {
  Random random(21);
  for (int round = 0; round < 40; ++round) {
    const MonitorProgram program = random_program(random);
    const Trace trace = random_trace(random, 20000);
    OfflineMonitor<Robustness> whole(program, {true, {}});
    OfflineMonitor<Robustness> cut(program, {true, {}});
    feed(whole, trace, nullptr);
    feed(cut, trace, &random);
    CHECK(whole.verdict().low == cut.verdict().low);
    CHECK(whole.verdict().high == cut.verdict().high);
  }
}

// A monitor that was used for other traces finds what a new one does.
void test_restarted_monitors() {
  Random random(22);
  for (int round = 0; round < 500; ++round) {
    const MonitorProgram program = random_program(random);
    OfflineMonitor<Truth> used(program, {});
    for (int turn = 0; turn < 4; ++turn) {
      const Trace trace = random_trace(random, turn == 1 ? 3000 : 1 + below(random, 10));
      OfflineMonitor<Truth> fresh(program, {});
      feed(fresh, trace, &random);
      feed(used, trace, &random);
      CHECK(used.verdict().low == fresh.verdict().low);
      CHECK(used.verdict().high == fresh.verdict().high);
      CHECK(used.lasting() == fresh.lasting());
      CHECK(used.violation().has_value() == fresh.violation().has_value());
      if (fresh.violation()) {
        CHECK(used.violation()->first == fresh.violation()->first);
        CHECK(used.violation()->last == fresh.violation()->last);
      }
      used.restart();
    }
  }
}

MonitorProgram response(std::int64_t deadline) {
  MonitorProgram program;
  program.columns = columns;
  for (std::size_t column = 0; column < 2; ++column) {
    MonitorAtom atom;
    atom.left.push_back({ValueOperator::column, 0, column});
    program.atoms.push_back(atom);
    MonitorNode node;
    node.kind = NodeKind::atom;
    node.atom = column;
    program.nodes.push_back(node);
  }
  program.nodes.push_back({NodeKind::logical_not, {0}});
  program.nodes.push_back({NodeKind::eventually, {1}, 0, 0, deadline});
  program.nodes.push_back({NodeKind::logical_or, {2, 3}});
  program.nodes.push_back({NodeKind::always, {4}});
  return program;
}

Trace pulses() {
  Trace trace;
  trace.ticks = {0, 10, 11, 30, 31, 40, 60, 61};
  trace.flags = {0, 1, 0, 0, 0, 1, 0, 0};
  trace.numbers = {{0, 1, 0, 0, 0, 1, 0, 0}, {0, 0, 0, 1, 0, 0, 0, 0}, std::vector<double>(8, 0)};
  trace.end = 80;
  return trace;
}

void test_first_violation() {
  OfflineMonitor<Truth> monitor(response(20), {true, {}});
  feed(monitor, pulses(), nullptr);
  CHECK(monitor.verdict().high == 0);
  const auto violation = monitor.violation();
  CHECK(violation && violation->node == 4);
  CHECK(violation->first == cell_of_tick(40) && violation->last == cell_of_tick(60) - 1);
}

void test_a_pending_obligation_is_undetermined() {
  Trace trace = pulses();
  trace.end = 70;
  OfflineMonitor<Truth> monitor(response(40), {true, {}});
  feed(monitor, trace, nullptr);
  CHECK(monitor.verdict().low == 0 && monitor.verdict().high == 1);
  CHECK(!monitor.violation());
}

void test_memory_stays_bounded() {
  Random random(22);
  Trace trace = random_trace(random, 1000);
  OfflineMonitor<Robustness> monitor(response(100), {true, {}});
  const std::int64_t length = trace.ticks.back() + 1;
  std::size_t most = 0;
  for (int round = 0; round < 200; ++round) {
    const std::vector<Column> view{
        {nullptr, trace.flags.data()}, {trace.numbers[1].data(), nullptr}, {trace.numbers[2].data(), nullptr}};
    monitor.push({trace.ticks.data(), view.data(), trace.ticks.size()});
    for (std::int64_t& tick : trace.ticks) tick += length;
    if (round == 20) most = monitor.bytes();
  }
  CHECK(monitor.bytes() <= most);
}

void test_rejections() {
  const auto rejects = [](auto action) {
    try {
      action();
    } catch (const std::invalid_argument&) {
      return true;
    }
    return false;
  };
  CHECK(rejects([] {
    Trace trace = pulses();
    trace.ticks[3] = 10;
    OfflineMonitor<Truth> monitor(response(1), {true, {}});
    feed(monitor, trace, nullptr);
  }));
  CHECK(rejects([] {
    Trace trace = pulses();
    trace.end = 60;
    OfflineMonitor<Truth> monitor(response(1), {true, {}});
    feed(monitor, trace, nullptr);
  }));
  CHECK(rejects([] { OfflineMonitor<Truth> monitor(response(largest_tick), {true, {}}); }));
  CHECK(rejects([] {
    MonitorProgram program = response(1);
    program.nodes[2].operands[0] = 7;
    OfflineMonitor<Truth> monitor(program, {true, {}});
  }));
}

}  // namespace

int main() {
  test_random_formulas();
  test_long_traces();
  test_restarted_monitors();
  test_first_violation();
  test_a_pending_obligation_is_undetermined();
  test_memory_stays_bounded();
  test_rejections();
  return 0;
}
