#include "runs/ending.hpp"

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

}  // namespace tachk::runs
