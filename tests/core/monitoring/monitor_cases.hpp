// Random formulas and traces for the tests of monitors.
#pragma once

#include <random>
#include <vector>

#include "monitoring/monitor_program.hpp"
#include "monitoring/monitor_samples.hpp"

namespace tachk::monitoring {

constexpr std::size_t columns = 3;

struct Trace {
  std::vector<std::int64_t> ticks;
  std::vector<std::vector<double>> numbers;  // columns; the first one is also given as flags
  std::vector<std::uint8_t> flags;
  std::int64_t end = 0;
};

using Random = std::mt19937;

inline std::int64_t below(Random& random, std::int64_t limit) {
  return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(limit));
}

inline MonitorProgram random_program(Random& random) {
  MonitorProgram program;
  program.columns = columns;
  for (std::size_t column = 0; column < columns; ++column) {
    MonitorAtom atom;
    atom.left.push_back({ValueOperator::column, 0, column});
    if (column > 0) {
      atom.relation = Relation::less;
      atom.right.push_back({ValueOperator::constant, 0.5, 0});
    }
    program.atoms.push_back(atom);
    MonitorNode node;
    node.kind = NodeKind::atom;
    node.atom = column;
    program.nodes.push_back(node);
  }
  program.nodes.push_back({NodeKind::change, {}, static_cast<std::size_t>(below(random, columns))});
  if (below(random, 4) == 0) program.nodes.push_back({NodeKind::always_true, {}});
  for (std::int64_t size = 1 + below(random, 4); size > 0; --size) {
    MonitorNode node;
    node.kind = static_cast<NodeKind>(3 + below(random, 12));
    if (node.kind == NodeKind::change) continue;
    const std::size_t count = program.nodes.size();
    const auto operand = [&] {
      return below(random, 2) == 0 ? count - 1 : static_cast<std::size_t>(below(random, static_cast<int>(count)));
    };
    const bool two = node.kind == NodeKind::logical_and || node.kind == NodeKind::logical_or ||
                     node.kind == NodeKind::until || node.kind == NodeKind::since;
    node.operands.push_back(operand());
    if (two) node.operands.push_back(operand());
    node.lower = below(random, 2) == 0 ? 0 : below(random, 5);
    node.upper = below(random, 4) == 0 ? unbounded : node.lower + below(random, 5);
    node.lower_closed = below(random, 3) != 0;
    node.upper_closed = below(random, 3) != 0;
    program.nodes.push_back(node);
  }
  return program;
}

inline Trace random_trace(Random& random, std::int64_t rows) {
  Trace trace;
  trace.numbers.resize(columns);
  std::int64_t tick = below(random, 3);
  for (std::int64_t row = 0; row < rows; ++row) {
    trace.ticks.push_back(tick);
    trace.flags.push_back(static_cast<std::uint8_t>(below(random, 2)));
    trace.numbers[0].push_back(trace.flags.back());
    for (std::size_t column = 1; column < columns; ++column)
      trace.numbers[column].push_back(static_cast<double>(below(random, 5)) / 4);
    tick += below(random, 4);
  }
  trace.end = trace.ticks.back() + below(random, 4);
  return trace;
}

template <class Monitor>
void feed(Monitor& monitor, const Trace& trace, Random* random) {
  const std::size_t rows = trace.ticks.size();
  for (std::size_t first = 0; first < rows;) {
    const std::size_t rest = rows - first;
    const std::size_t count =
        random == nullptr ? rest : 1 + static_cast<std::size_t>(below(*random, static_cast<std::int64_t>(rest)));
    std::vector<Column> view{{nullptr, trace.flags.data() + first}};
    for (std::size_t column = 1; column < columns; ++column)
      view.push_back({trace.numbers[column].data() + first, nullptr});
    monitor.push({trace.ticks.data() + first, view.data(), count});
    first += count;
  }
  monitor.finish(trace.end);
}

}  // namespace tachk::monitoring
