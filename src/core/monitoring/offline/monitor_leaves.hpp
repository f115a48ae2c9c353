// The leaves of a monitor: combinations of atoms and changes of values, cut out of blocks of samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "monitoring/monitor_samples.hpp"
#include "monitoring/offline/monitor_graph.hpp"
#include "monitoring/offline/monitor_stream.hpp"

namespace tachk::monitoring::offline {

// The value of a combination of atoms at each sample of a block.
template <class Value>
class PointwiseEvaluator {
 public:
  explicit PointwiseEvaluator(const MonitorProgram& program);

  // The result stays where it is until the next call.
  const Value* evaluate(const StreamNode& leaf, const Samples& samples, std::size_t first, std::size_t count);
  // The worth of the leaf if every atom and every negated atom had this value.
  Value with_all(const StreamNode& leaf, Value value);
  AtomEvaluator& atoms() { return atoms_; }

 private:
  void node(std::size_t number, bool negated, std::size_t depth, const Samples& samples, std::size_t first,
            std::size_t count);
  void junction(const std::vector<std::size_t>& operands, bool negated, bool conjunction, std::size_t depth,
                const Samples& samples, std::size_t first, std::size_t count);
  // The combinations below a leaf of which several operators take the value, operands before operators.
  const std::vector<std::size_t>& shared_below(const StreamNode& leaf);
  Value node_with_all(std::size_t number, bool negated, Value value);
  Value junction_with_all(const std::vector<std::size_t>& operands, bool negated, bool conjunction, Value value);

  const MonitorProgram* program_;
  AtomEvaluator atoms_;
  std::vector<std::vector<Value>> blocks_;  // intermediate results by depth
  // A chain of `xor` takes each of its beginnings twice, and would double the work with every link.
  std::vector<bool> shared_;  // by node
  bool any_shared_ = false;
  std::map<std::vector<std::size_t>, std::vector<std::size_t>> shared_below_;  // by the nodes that a leaf combines
  std::map<std::size_t, std::vector<Value>> shared_blocks_;                    // of shared nodes, in this block
  std::map<std::pair<std::size_t, bool>, Value> shared_constants_;             // of shared nodes and their negations
};

// Where a trace stands between two blocks.
struct TracePosition {
  std::int64_t origin = 0;  // the first tick: cell 0
  std::int64_t last = 0;    // the tick of the last sample
  bool begun = false;
};

// True if ticks rise strictly from one sample to the next; throws std::invalid_argument if they fall.
bool rises(const std::int64_t* ticks, std::size_t count, const TracePosition& position);

// Appends the values of a block of samples. Where `rising` is false, later samples overwrite those of the same tick.
void extend(Stream<Truth>& out, const Truth* values, const std::int64_t* ticks, std::size_t count, std::int64_t origin,
            bool rising);
void extend(Stream<Robustness>& out, const Robustness* values, const std::int64_t* ticks, std::size_t count,
            std::int64_t origin, bool rising);

// Instants at which a value differs from the one before.
template <class Value>
class ChangeLeaf {
 public:
  explicit ChangeLeaf(bool negated) : negated_(negated) {}

  void extend(Stream<Value>& out, const double* values, const std::int64_t* ticks, std::size_t count,
              std::int64_t origin);
  // The last sample is final.
  void settle(Stream<Value>& out);

 private:
  Value yes() const { return negated_ ? Bounds<Value>::least : Bounds<Value>::greatest; }
  Value no() const { return negated_ ? Bounds<Value>::greatest : Bounds<Value>::least; }

  bool negated_;
  Cell cell_ = -1;  // of the last sample, whose value may still be overwritten
  double value_ = 0;
  double before_ = 0;
};

}  // namespace tachk::monitoring::offline
