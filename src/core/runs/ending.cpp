#include "runs/ending.hpp"

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "certificates/zones.hpp"
#include "runs/concrete_semantics.hpp"

namespace tachk::runs {

std::optional<RunEnd> end_of(const program::Program& program, const RunPath& path) {
  if (program.has_stopwatches) return std::nullopt;
  const auto dimension = static_cast<std::size_t>(program.dimension());
  std::vector<bool> stands(dimension, false);
  stands[0] = true;
  ConcreteSemantics semantics(program);
  certificates::Zone zone = certificates::Zone::filled(dimension, zones::raw_zero);
  for (const zones::ClockReset& start : program.starts) zone.reset(start);
  std::vector<zones::Atom> invariant;
  std::vector<zones::Atom> guard;
  std::vector<zones::ClockReset> resets;
  for (std::size_t k = 0;; ++k) {
    invariant.clear();
    if (!semantics.invariants(invariant)) return std::nullopt;
    zone.tighten(invariant);
    if (k == path.size() || zone.empty()) break;
    if (semantics.waits()) {
      zone.go_on(stands);
      zone.tighten(invariant);
    }
    guard.clear();
    for (const std::uint32_t edge : path[k])
      if (!semantics.holds(program.edges[edge].guard, guard)) return std::nullopt;
    zone.tighten(guard);
    resets.clear();
    semantics.take(path[k], resets);
    for (const zones::ClockReset& reset : resets)
      if (!zone.empty()) zone.reset(reset);
  }
  return RunEnd{semantics.state(), zone.entries};
}

std::optional<StateOfRun> state_after(const program::Program& program, const RunPath& path, const Moments& moments,
                                      std::size_t transitions) {
  if (transitions > path.size() || transitions > moments.ticks.size())
    throw std::invalid_argument("the run has fewer transitions");
  if (program.has_stopwatches) return std::nullopt;
  ConcreteSemantics semantics(program);
  std::vector<std::int64_t> zero(static_cast<std::size_t>(program.dimension()), 0);  // when each clock was 0
  for (const zones::ClockReset& start : program.starts) zero[start.clock] = -std::int64_t{start.value} * moments.unit;
  std::int64_t now = 0;
  std::vector<zones::ClockReset> resets;
  for (std::size_t k = 0; k < transitions; ++k) {
    now = moments.ticks[k];
    resets.clear();
    semantics.take(path[k], resets);
    for (const zones::ClockReset& reset : resets)
      zero[reset.clock] = (reset.source != 0 ? zero[reset.source] : now) - std::int64_t{reset.value} * moments.unit;
  }
  StateOfRun found{semantics.state(), {}};
  for (std::size_t clock = 1; clock < zero.size(); ++clock) found.clocks.push_back(now - zero[clock]);
  return found;
}

}  // namespace tachk::runs
