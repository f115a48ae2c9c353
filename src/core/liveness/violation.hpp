// What a search for runs that go on for ever finds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "reachability/explorer.hpp"
#include "symbolic/zone_graph.hpp"

namespace tachk {

enum class ViolationKind { loop, idle, stuck };

// A run that avoids q for ever, from its action number `begins` on.
struct Violation {
  ViolationKind kind;
  Path stem;
  std::size_t begins;
  Path loop;  // of a loop only
};

struct LivenessFault {
  FaultKind kind;
  std::int32_t position;  // of the code word
  Path path;              // to the last state before it
  Edges edges;            // of the action; empty for an invariant of the initial state or a predicate
};

// A run-time error of a predicate in the state that an action leads to.
struct StateFault : ModelFault {
  StateFault(const ModelFault& fault, std::span<const std::uint32_t> action)
      : ModelFault(fault), edges(action.begin(), action.end()) {}

  Edges edges;
};

// What `search` comes to; a run-time error it meets is kept in `fault`, behind the path that `path_so_far` gives.
// Throws GivenUp.
template <typename Search, typename PathSoFar>
Status keeping_faults(std::optional<LivenessFault>& fault, Search search, PathSoFar path_so_far) {
  if (fault) return Status::fault;
  try {
    return search();
  } catch (const StateFault& met) {
    fault = LivenessFault{met.kind, met.position, path_so_far(), {}};
    if (!met.edges.empty()) fault->path.push_back(met.edges);
  } catch (const ActionFault& met) {
    fault = LivenessFault{met.kind, met.position, path_so_far(), met.edges};
  } catch (const ModelFault& met) {
    fault = LivenessFault{met.kind, met.position, path_so_far(), {}};
  } catch (const ConstantOverflow&) {
    return Status::constant_limit;
  }
  return Status::fault;
}

}  // namespace tachk
