// The online monitor fed from C++, one sample a call: `online_feed PROGRAM ROWS COLUMNS truth|bounds`.
//
// PROGRAM is a compiled formula as numbers (bench/monitors.py writes it), ROWS a file of rows of four doubles: the time
// in seconds, x, y and z. COLUMNS says which of the three the program reads, in its order, such as `xz`. Prints the CPU
// seconds from the first sample to the last, and the verdict.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "monitoring/online/online_monitor.hpp"

namespace {

std::vector<tachk::monitoring::ValueInstruction> read_code(std::istream& in) {
  std::size_t count = 0;
  in >> count;
  std::vector<tachk::monitoring::ValueInstruction> code(count);
  for (tachk::monitoring::ValueInstruction& instruction : code) {
    int operation = 0;
    double operand = 0;
    in >> operation >> operand;
    instruction.operation = static_cast<tachk::monitoring::ValueOperator>(operation);
    instruction.number = operand;
    instruction.column = static_cast<std::size_t>(operand);
  }
  return code;
}

tachk::monitoring::MonitorProgram read_program(const char* path) {
  std::ifstream in(path);
  tachk::monitoring::MonitorProgram program;
  std::size_t atoms = 0;
  std::size_t nodes = 0;
  in >> program.columns >> atoms >> nodes;
  for (; atoms > 0; --atoms) {
    int relation = 0;
    in >> relation;
    auto left = read_code(in);
    auto right = read_code(in);
    program.atoms.push_back({static_cast<tachk::monitoring::Relation>(relation), std::move(left), std::move(right)});
  }
  for (; nodes > 0; --nodes) {
    tachk::monitoring::MonitorNode node;
    int kind = 0;
    std::size_t operands = 0;
    in >> kind >> node.atom >> node.lower >> node.upper >> node.lower_closed >> node.upper_closed >> operands;
    node.kind = static_cast<tachk::monitoring::NodeKind>(kind);
    node.operands.resize(operands);
    for (std::size_t& operand : node.operands) in >> operand;
    program.nodes.push_back(std::move(node));
  }
  return program;
}

struct Row {
  double time;
  double values[3];
};

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  std::vector<Row> rows;
  std::ifstream file(argv[2], std::ios::binary);
  for (Row row; file.read(reinterpret_cast<char*>(&row), sizeof row);) rows.push_back(row);
  const std::string names = argv[3];
  tachk::monitoring::online::OnlineMonitor monitor(read_program(argv[1]), std::string(argv[4]) == "bounds");
  std::vector<tachk::monitoring::Column> columns(names.size());
  const double begin = cpu_seconds();
  for (const Row& row : rows) {
    const std::int64_t tick = std::llround(1000 * row.time);
    for (std::size_t n = 0; n < names.size(); ++n) columns[n].numbers = &row.values[names[n] - 'x'];
    monitor.push({&tick, columns.data(), 1});
  }
  const double cpu = cpu_seconds() - begin;
  std::printf("%zu samples %.6f s, verdict %d\n", rows.size(), cpu, static_cast<int>(monitor.verdict()));
}
