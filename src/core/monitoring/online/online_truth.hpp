// Truth online, as early as Kleene's rules decide it. Every operator keeps the cells at which it is decided true and
// those at which it is decided false. Both sets only grow; what grew is passed on to the operators above, once. Cells
// that nothing above asks for any more are forgotten.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "monitoring/online/online_graph.hpp"
#include "monitoring/online/online_spans.hpp"

namespace tachk::monitoring::online {

enum class Decision : std::int8_t { no = 0, yes = 1, undetermined = 2 };

// A run of cells at which what has to hold always does not hold. Not settled: an earlier one may still turn up, or the
// run may grow.
struct ViolatedSpan {
  Span cells;
  bool settled = false;
};

class TruthEngine {
 public:
  // `all_violations`: of a formula G f, goes on after the first one, and keeps the others until they are taken.
  explicit TruthEngine(const OnlineGraph& graph, bool all_violations = false);

  // Appends what is known of a leaf (kind `atom` or `change`) since the last step, in the order of time.
  void know(std::size_t leaf, Span cells, bool value);
  // Draws all conclusions. The trace covers the cells up to `limit`, and more if it is not finished.
  void step(Cell limit, bool finished);

  Decision verdict() const { return verdict_; }
  const std::optional<ViolatedSpan>& violation() const { return violation_; }
  // The violations that have ended since the last call, and where one has begun that has not ended, in the order of
  // time: one is reported when all before it is decided. How the trace is cut into steps changes nothing.
  std::vector<Span> take_violations();
  std::optional<Cell> violated_since() const { return violated_since_; }
  // Nothing that follows can change verdict or violation.
  bool settled() const { return settled_; }
  // How many runs of cells it keeps.
  std::size_t pieces() const;
  std::size_t bytes() const;

 private:
  struct State {
    std::array<SpanSet, 2> cells;             // decided false, decided true
    std::array<std::vector<Span>, 2> news;    // what this step has added to them
    Cell wanted = 0;                          // the first cell that anything above asks for
    Cell open = 0;                            // the first wanted cell that is not decided
    std::array<bool, 2> watched{true, true};  // of a leaf: whether the sets are looked at, not only their growth
    Cell matured = -1;                        // witnesses up to here count for operators that look to the end
  };

  const SpanSet& cells(Literal operand, bool value) const {
    return states_[operand.node].cells[value != operand.negated ? 1 : 0];
  }
  const std::vector<Span>& news(Literal operand, bool value) const {
    return states_[operand.node].news[value != operand.negated ? 1 : 0];
  }
  void decide(State& state, bool value, Cell first, Cell end) {
    state.cells[value ? 1 : 0].add(std::max(first, state.wanted), end, state.news[value ? 1 : 0]);
  }
  void decide_merged(State& state, bool value, const std::vector<Span>& left, const std::vector<Span>& right);

  void step_either(const OnlineNode& node, State& state);
  void step_window(const OnlineNode& node, State& state, Cell limit, bool finished);
  void step_until(const OnlineNode& node, State& state, Cell limit, bool finished);
  void step_since(const OnlineNode& node, State& state);
  void step_just_before(const OnlineNode& node, State& state);
  void until_holds(const OnlineNode& node, State& state, const Span& run, Cell latest_witness);
  void since_holds(const OnlineNode& node, State& state, const Span& run);
  void conclude(Cell limit, bool finished);
  void collect(Cell limit, bool finished);
  void forget();
  bool forgets_now();
  void watch(Literal operand, bool value) { states_[operand.node].watched[value != operand.negated ? 1 : 0] = true; }
  void want(Literal operand, Cell cell) {
    State& state = states_[operand.node];
    state.wanted = std::min(state.wanted, std::max<Cell>(cell, 0));
  }

  const OnlineGraph* graph_;
  std::vector<State> states_;
  bool begun_ = false;
  int steps_ = 0;  // since something was forgotten
  std::vector<Span> scratch_[2];
  std::optional<Literal> guarded_;  // of a formula G f: f
  Cell guarded_open_ = 0;           // f is decided true before, or all its violations before are reported
  Decision verdict_ = Decision::undetermined;
  std::optional<ViolatedSpan> violation_;
  bool all_violations_;
  std::vector<Span> ended_;
  std::optional<Cell> violated_since_;
  bool settled_ = false;
};

}  // namespace tachk::monitoring::online
