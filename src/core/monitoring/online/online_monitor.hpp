// Monitors a trace while it is recorded. Samples come in chunks of any size, down to single ones; how they are cut into
// chunks changes nothing. A sample says what holds from its tick on; of several for one tick the last one counts, so an
// instant is known once a later one has come.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "monitoring/monitor_program.hpp"
#include "monitoring/monitor_samples.hpp"
#include "monitoring/offline/offline_monitor.hpp"
#include "monitoring/online/online_truth.hpp"

namespace tachk::monitoring::online {

class OnlineMonitor {
 public:
  // `quantitative`: keep bounds of the robustness, too. `all_violations`: of a formula G f, all of them.
  // Throws std::invalid_argument if the program is not valid.
  OnlineMonitor(MonitorProgram program, bool quantitative, bool all_violations = false);
  OnlineMonitor(const OnlineMonitor&) = delete;
  OnlineMonitor& operator=(const OnlineMonitor&) = delete;

  // The tick of the very first sample is the beginning of the trace. All three throw std::invalid_argument if time goes
  // back or the trace is over, and have then done nothing.
  void push(const Samples& samples);
  // The same of samples whose order the caller has looked at.
  void push_ordered(const Samples& samples);
  // Nothing has changed before this tick; it may still change at it.
  void advance(std::int64_t tick);
  // The trace ends with this tick, included.
  void finish(std::int64_t tick);

  Decision verdict() const { return truth_.verdict(); }
  // The tick that was reached when the verdict was decided.
  std::optional<std::int64_t> decided_at() const { return decided_at_; }
  // Of a formula G f: where f does not hold. Cells count from `origin`.
  const std::optional<ViolatedSpan>& violation() const { return truth_.violation(); }
  // With `all_violations`: those that have ended since the last call, and where one has begun that has not ended.
  std::vector<Span> take_violations() { return truth_.take_violations(); }
  std::optional<Cell> violated_since() const { return truth_.violated_since(); }
  // Bounds of the robustness of every continuation; they never widen. Without `quantitative` those that the verdict
  // gives. At the end they are the narrowest, before they need not be.
  offline::Range<offline::Robustness> robustness();
  std::int64_t origin() const { return progress_.origin; }
  std::int64_t now() const { return progress_.now; }
  bool finished() const { return progress_.finished; }
  std::size_t bytes() const;

 private:
  // An atom, or the changes of a value.
  struct Leaf {
    std::size_t node = 0;
    std::size_t atom = 0;
    bool change = false;
    std::uint8_t holds = 0;  // the last sample
    double before = 0;       // the value before the tick of the last sample
    double value = 0;        // and from then on
  };

  Cell cell_of(std::int64_t tick) const { return cell_of_tick(tick - progress_.origin); }
  void check_time(std::int64_t tick) const;
  void follow_all(const Samples& samples);
  void follow_singly(const Samples& samples, std::size_t first, std::size_t count);
  void evaluate(const Samples& samples, std::size_t first, std::size_t count);
  void follow(const Samples& samples, std::size_t first, std::size_t begin, std::size_t end);
  void follow_atom(Leaf& leaf, const std::uint8_t* holds, const std::int64_t* ticks, std::size_t begin,
                   std::size_t end);
  void follow_changes(Leaf& leaf, const double* values, const std::int64_t* ticks, std::size_t begin, std::size_t end);
  void hold_until(Cell end);
  void narrow(const offline::Range<offline::Robustness>& range);
  void take_margins(const Samples& samples);
  void catch_up();

  // The block of samples at hand, for each leaf, behind the last sample before it.
  struct Block {
    std::vector<std::vector<std::uint8_t>> truths;  // of a leaf that is an atom
    std::vector<std::vector<double>> values;        // of a leaf that is a change
  };

  // How things stood some blocks ago.
  struct Earlier {
    TruthEngine truth;
    std::vector<Leaf> leaves;
    Cell known = 0;
  };

  // Samples that the margins have not seen yet.
  struct Waiting {
    std::vector<std::int64_t> ticks;
    std::vector<std::vector<double>> columns;
  };

  // The robustness, if it is requested.
  struct Margins {
    std::unique_ptr<offline::OfflineMonitor<offline::Robustness>> whole;
    std::unique_ptr<offline::OfflineMonitor<offline::Robustness>>
        sooner;  // of another form, for upper bounds before the end
    Waiting waiting;
    offline::Range<offline::Robustness> robustness{offline::Bounds<offline::Robustness>::least,
                                                   offline::Bounds<offline::Robustness>::greatest};
  };

  // How far time has come.
  struct Progress {
    bool begun = false;
    bool finished = false;
    std::int64_t origin = 0;
    std::int64_t now = 0;  // the tick that has been reached
    Cell known = 0;        // cells before are known
  };

  MonitorProgram program_;
  OnlineGraph graph_;
  AtomEvaluator evaluator_;
  std::vector<Leaf> leaves_;
  Block block_;
  TruthEngine truth_;
  Earlier earlier_;
  std::optional<std::int64_t> decided_at_;
  Margins margins_;
  std::vector<double> last_values_;  // of all columns
  Progress progress_;
};

}  // namespace tachk::monitoring::online
