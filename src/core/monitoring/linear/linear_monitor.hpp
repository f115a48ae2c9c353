// Monitoring of columns that move linearly from one sample to the next, and robustness in time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "monitoring/linear/linear_signal.hpp"
#include "monitoring/monitor_program.hpp"
#include "monitoring/monitor_samples.hpp"
#include "monitoring/offline/offline_monitor.hpp"

namespace tachk::monitoring::linear {

// The robustness of atoms.
// space: the distance of the two sides, where columns of numbers are linear between samples (of samples with the same
//   tick the last one counts) and keep the last value up to the end of the trace. Columns of flags do not move.
// ahead, behind: for how long, from now on or until now, an atom has had the truth that it has, negative if it is
//   false, where columns keep their values between samples (Donze, Maler 2010). In ticks. An atom over several columns
//   counts for as long as it would keep its truth if they were shifted apart.
enum class RobustnessKind { space, ahead, behind };

// A trace as a whole: pushed samples are copied.
class LinearMonitor {
 public:
  // Throws std::invalid_argument for what has no meaning on lines: % , and products and quotients of columns.
  LinearMonitor(MonitorProgram program, RobustnessKind measure);

  std::size_t columns() const { return program_.columns; }
  std::size_t nodes() const { return program_.nodes.size(); }
  void push(const Samples& samples);
  // Instants at which columns cross are given in parts of a tick: `most_parts`, a power of ten, or as many as fit.
  void finish(std::int64_t end, std::int64_t most_parts = 1'000'000);

  // The robustness of a node at each instant; after the end of the trace, what is certain of it. It is kept, so that
  // one may ask for the operands first, and look up in between.
  LinearSignal robustness(std::size_t node, bool high);
  // The truth of the formula. Only for `space`. Instants at which columns cross are rounded to parts of a tick, but
  // stay on their side of the ticks; cells count in such parts.
  struct Judgement {
    offline::Range<offline::Truth> verdict;
    offline::Truth lasting;  // see OfflineMonitor
    std::optional<offline::FirstViolation> violation;
  };
  Judgement truth() const;
  offline::Signal<offline::Truth> truth_signal(std::size_t node) const;
  // Parts of a tick in which `truth` counts.
  std::int64_t refinement() const { return refinement_; }
  std::int64_t length() const { return end_ - ticks_.front(); }

 private:
  LinearSignal column(std::size_t number) const;
  LinearSignal value(const std::vector<ValueInstruction>& code) const;
  LinearSignal margin(const MonitorAtom& atom) const;
  double magnitude(const std::vector<ValueInstruction>& code, std::size_t row) const;
  LinearSignal atom(const MonitorAtom& atom) const;
  LinearSignal changes(std::size_t atom, double yes, double no) const;
  // An atom has a truth from `start` on; it is certain from `since` on up to `until`, or the end of the trace.
  struct Run {
    double start;
    bool truth;
    double since;
    std::optional<double> until;
  };
  std::vector<Run> runs(std::size_t atom) const;
  LinearSignal lasting(std::size_t atom, bool high) const;
  LinearSignal far_from_changes(std::size_t atom, bool high) const;
  template <class Value, class Evaluate>
  std::vector<Value> sampled(Evaluate evaluate) const;
  LinearSignal evaluate(std::size_t node, bool high);
  LinearSignal computed(const MonitorNode& node, bool high);
  LinearSignal ahead(const MonitorNode& node, bool high, const LinearSignal* f, const LinearSignal& g) const;
  LinearSignal behind(const MonitorNode& node, const LinearSignal* f, const LinearSignal& g) const;
  MonitorProgram refined() const;
  void fill(const offline::StreamNode& leaf, offline::Stream<offline::Truth>& out) const;

  MonitorProgram program_;
  RobustnessKind measure_;
  std::vector<std::int64_t> ticks_;
  std::vector<std::vector<double>> columns_;
  std::vector<bool> is_flag_;
  std::int64_t end_ = 0;
  std::int64_t refinement_ = 1;
  std::vector<std::array<std::optional<LinearSignal>, 2>> known_;
};

}  // namespace tachk::monitoring::linear
