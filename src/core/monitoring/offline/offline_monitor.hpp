// The truth and robustness of a formula on a recorded trace: a network of streams, fed with blocks of samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "monitoring/offline/monitor_graph.hpp"
#include "monitoring/offline/monitor_leaves.hpp"
#include "monitoring/offline/monitor_operators.hpp"
#include "monitoring/offline/monitor_stream.hpp"

namespace tachk::monitoring::offline {

// Every continuation of the trace has a value between the two.
template <class Value>
struct Range {
  Value low;
  Value high;
};

// The earliest cells at which something that must always hold certainly does not; cell 0 if the formula is certainly
// false for another reason.
struct FirstViolation {
  std::size_t node;
  Cell first;
  Cell last;
};

struct Requests {
  bool verdict = true;                    // the value of the formula at cell 0, and its first violation
  std::vector<std::size_t> signals = {};  // nodes whose whole signal is wanted
  bool lasting = true;                    // the verdict if values stay as they are, beside the verdict
};

// Pieces of a signal, from cell 0 to the end of the trace; adjacent pieces differ.
template <class Value>
struct Signal {
  std::vector<Cell> starts;
  std::vector<Value> low;
  std::vector<Value> high;
};

// Samples go in by `push`, in any portions; after `finish` the results can be read. What comes out does not depend on
// the portions.
template <class Value>
class OfflineMonitor {
 public:
  OfflineMonitor(MonitorProgram program, Requests requests, Leaves leaves = Leaves::combined);
  OfflineMonitor(const OfflineMonitor&) = delete;
  OfflineMonitor& operator=(const OfflineMonitor&) = delete;

  // Throws std::invalid_argument if times decrease or are too far from the first one.
  void push(const Samples& samples);
  // The trace ends at this tick, which is not before the last sample. There must be a sample.
  void finish(std::int64_t end);
  // Instead of samples and an end: whole signals of the leaves, of which only the cells up to `last` count, but for
  // `lasting`.
  void evaluate(Cell last, const std::function<void(const StreamNode&, Stream<Value>&)>& fill);
  // Forgets the trace; another one may follow.
  void restart();
  // True if further samples cannot change any result.
  bool settled() const;
  std::size_t columns() const { return program_.columns; }
  // Memory held for the streams.
  std::size_t bytes() const;

  Range<Value> verdict() const;
  // The verdict if all values stay as they are at the end for ever. Where signals are wanted it is not known: the lower
  // bound of the verdict.
  Value lasting() const { return lasting_ ? *lasting_ : verdict().low; }
  // Before the end: bounds of the verdict of every continuation. They rest on what is decided at every cell of an
  // outermost G or F, and need not be the narrowest.
  Range<Value> so_far() const { return bounds_of(verdict_); }
  std::optional<FirstViolation> violation() const;
  Signal<Value> signal(std::size_t number) const;

 private:
  // The join (dual: the meet) of the values on a range of cells, up to the end of the trace.
  struct Fold {
    std::size_t node;
    std::size_t stream;
    bool dual;
    Cell first;
    Cell last;
    Value value;
    std::size_t at = 0;
    bool complete = false;
    Cell least_from = -1;  // where the value is the worst of all for the first time
    Cell least_to = -1;    // and the first cell after that
  };
  struct SignalLog {
    std::size_t stream;
    std::size_t at = 0;
    std::vector<Cell> starts;
    std::vector<Value> values;
  };
  // How the value at cell 0 follows from folds.
  struct Term {
    bool leaf;
    bool conjunction;
    std::size_t fold;
    std::vector<Term> operands;
  };
  // One evaluation of all streams. The two of a finished trace differ in what comes after its end.
  struct Side {
    std::vector<Stream<Value>> streams;
    std::vector<std::unique_ptr<StreamOperator<Value>>> operators;  // none for leaves
    std::vector<ChangeLeaf<Value>> changes;
    std::vector<Fold> folds;
    std::vector<SignalLog> logs;
    TraceEnd end;
  };

  Term plan(std::size_t node, bool negated);
  Term fold(std::size_t node, std::size_t stream, bool dual, Cell first, Cell last);
  void feed(const Samples& samples, std::size_t first, std::size_t count);
  bool step(Side& side);
  void drain(Side& side);
  void trim(Side& side);
  void collect(Fold& fold, const Side& side);
  void record(SignalLog& log, const Side& side);
  void close();
  void conclude(Side& side, TraceEnd::Beyond beyond);
  void begin(Side& side) const;
  void copy(const Side& side, Side& result) const;
  Range<Value> bounds_of(const Term& term) const;
  Value value_of(const Term& term, const std::vector<Fold>& folds) const;
  void find_violation(const Term& term, const std::vector<Fold>& folds, std::optional<FirstViolation>& earliest) const;

  MonitorProgram program_;
  Requests requests_;
  StreamGraph graph_;
  PointwiseEvaluator<Value> pointwise_;
  std::vector<double> left_values_;
  std::vector<std::size_t> leaves_;
  Term verdict_{};
  Side side_;
  std::optional<Value> lasting_;
  Side low_;   // of a finished trace; side_ is the high one
  Side held_;  // and of one whose values stay as they are
  TracePosition position_;
  std::vector<std::size_t> needed_;  // scratch of trim
};

}  // namespace tachk::monitoring::offline
