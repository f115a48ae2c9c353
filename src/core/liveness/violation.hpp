// The result of a search for infinite runs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "reachability/explorer.hpp"
#include "symbolic/zone_graph.hpp"

namespace tachk::liveness {

enum class ViolationKind { loop, idle, stuck };

// A run that avoids q for ever, from its action number `begins` on.
struct Violation {
  ViolationKind kind;
  symbolic::Path stem;
  std::size_t begins;
  symbolic::Path loop;  // of a loop only
};

struct LivenessFault {
  machine::FaultKind kind;
  std::int32_t position;  // of the code word
  symbolic::Path path;    // to the last state before it
  symbolic::Edges edges;  // of the action; empty for an invariant of the initial state or a predicate
};

// A run-time error of a predicate in the state that an action leads to.
struct StateFault : machine::ModelFault {
  StateFault(const machine::ModelFault& fault, std::span<const std::uint32_t> action)
      : machine::ModelFault(fault), edges(action.begin(), action.end()) {}

  symbolic::Edges edges;
};

// The result of `search`; a run-time error is stored in `fault`, behind the path that `path_so_far` gives.
// Throws GivenUp.
template <typename Search, typename PathSoFar>
reachability::Status keeping_faults(std::optional<LivenessFault>& fault, Search search, PathSoFar path_so_far) {
  if (fault) return reachability::Status::fault;
  try {
    return search();
  } catch (const StateFault& met) {
    fault = LivenessFault{met.kind, met.position, path_so_far(), {}};
    if (!met.edges.empty()) fault->path.push_back(met.edges);
  } catch (const symbolic::ActionFault& met) {
    fault = LivenessFault{met.kind, met.position, path_so_far(), met.edges};
  } catch (const machine::ModelFault& met) {
    fault = LivenessFault{met.kind, met.position, path_so_far(), {}};
  } catch (const symbolic::ConstantOverflow&) {
    return reachability::Status::constant_limit;
  }
  return reachability::Status::fault;
}

}  // namespace tachk::liveness
