// A monitor program broken down into the few operators on streams that monitors are made of.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "monitoring/monitor_cells.hpp"
#include "monitoring/monitor_program.hpp"

namespace tachk::monitoring::offline {

// The operators that make streams. All of them are monotone: negation is pushed down to the leaves. "Join" is `or` and
// maximum, "meet" is `and` and minimum; dual operators exchange the two, and false with true.
enum class StreamKind {
  constant,   // bottom
  pointwise,  // a combination of atoms, sample by sample
  change,     // of the left value of an atom, at isolated instants
  join,       // of two streams
  window,     // the join over a window of cells
  suffix,     // the join over all cells from an offset on
  before,     // the left limit; bottom at cell 0
  until,      // f U (0,oo) g, `horizon` cells ahead at most
  since,      // f S (0,oo) g
  select,     // the first stream at instants, the second one in the intervals between them
  truncate,   // up to the end of the trace, bottom after it
  tail,       // after the end of the trace, bottom up to it
  splice,     // up to the end of the trace the first stream; after it the second one where values are bounded from
              // below, the third one where they are bounded from above
};

struct StreamNode {
  StreamKind kind = StreamKind::constant;
  bool dual = false;
  std::vector<std::size_t> inputs;  // earlier streams
  CellOffsets offsets = {};         // of `window` and `suffix`
  Cell horizon = endless;           // of `until`
  std::size_t source = 0;           // of `pointwise`: the node of the program; of `change`: the atom
  // Of `pointwise`: parts of the node's operands that are pointwise; empty for all of it.
  std::vector<std::size_t> parts = {};
};

// The content of one leaf: any combination of atoms, or an atom only.
enum class Leaves { combined, single };

// The streams that a program needs. Operands come before operators.
class StreamGraph {
 public:
  explicit StreamGraph(const MonitorProgram& program, Leaves leaves = Leaves::combined);

  const std::vector<StreamNode>& streams() const { return streams_; }
  // The stream of a node of the program, or of its negation.
  std::size_t stream_of(std::size_t node, bool negated);
  // True if a node combines atoms sample by sample.
  bool is_pointwise(std::size_t node) const { return pointwise_[node]; }

 private:
  std::size_t add(StreamNode node);
  std::size_t build(std::size_t node, bool negated);
  std::size_t junction(std::size_t node, bool negated);
  std::size_t edge(std::size_t operand, bool rising, bool negated);
  std::size_t constant(bool dual);
  std::size_t join(std::size_t left, std::size_t right, bool dual);
  std::size_t window(std::size_t operand, const CellWindow& offsets, bool dual);
  std::size_t suffix(std::size_t operand, const CellWindow& offsets, bool dual);
  std::size_t eventually(std::size_t operand, const MonitorNode& node, bool dual);
  std::size_t until(std::size_t left, std::size_t right, const MonitorNode& node, bool dual);
  std::size_t since(std::size_t left, std::size_t right, const MonitorNode& node, bool dual);
  std::size_t spliced(std::size_t cut, std::size_t own, std::size_t full, bool dual);

  const MonitorProgram* program_;
  Leaves leaves_;
  std::vector<bool> pointwise_;
  std::vector<StreamNode> streams_;
  std::map<std::pair<std::size_t, bool>, std::size_t> known_;
};

}  // namespace tachk::monitoring::offline
