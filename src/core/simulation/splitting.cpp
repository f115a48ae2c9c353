#include "simulation/splitting.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include "simulation/horizon.hpp"
#include "simulation/thread_pool.hpp"

namespace tachk::simulation {

using flow::Ticks;

namespace {

constexpr std::uint64_t streams = std::uint64_t{1} << 62;  // these numbers are not those of runs

// Where a run has come a level nearer.
struct Entry {
  Simulator::Snapshot snapshot;
  std::uint64_t steps = 0;
  std::uint32_t level = 0;
  bool there = false;  // at the goal
};

class Splitter {
 public:
  Splitter(const Simulation& simulation, const Levels& levels, const RunQuestion& question,
           const SplittingRequest& request)
      : program_(simulation.program()),
        levels_(levels),
        question_(question),
        request_(request),
        simulator_(program_, simulation.chances(), simulation.tables(), Policy::stochastic,
                   question.bound.ticks_per_unit) {}

  void run(std::uint64_t number, Replication& result) {
    result.probability = 1;
    std::vector<Entry> entries;
    // Behind the last level comes the goal, which may ask for more than a discrete state.
    for (std::uint32_t target = 1; target <= levels_.top() + 1 && result.probability > 0; ++target) {
      if (target > 1 && std::all_of(entries.begin(), entries.end(),
                                    [&](const Entry& entry) { return entry.there || entry.level >= target; }))
        continue;
      std::vector<Entry> next;
      for (std::uint64_t n = 0; n < request_.effort; ++n) {
        Random random(request_.seed, streams + (number * (levels_.top() + 2) + target) * request_.effort + n);
        std::optional<Entry> found = advance(target, entries, random, result);
        if (found) next.push_back(std::move(*found));
      }
      result.probability *= static_cast<double>(next.size()) / static_cast<double>(request_.effort);
      entries = std::move(next);
    }
  }

 private:
  // A run from one of the entries, or from the start, until it is at the target.
  std::optional<Entry> advance(std::uint32_t target, const std::vector<Entry>& entries, Random random,
                               Replication& result) {
    std::uint64_t steps = 0;
    try {
      if (target == 1) {
        if (!simulator_.begin(random)) return std::nullopt;
      } else {
        const Entry& entry = entries[random.below(entries.size())];
        if (entry.there || entry.level >= target) return entry;
        simulator_.resume(entry.snapshot, random);
        steps = entry.steps;
      }
      return go_on(target, steps, result);
    } catch (const machine::ModelFault&) {
      ++result.unknown;
      return std::nullopt;
    }
  }

  std::optional<Entry> go_on(std::uint32_t target, std::uint64_t steps, Replication& result) {
    std::uint64_t at_once = 0;
    while (true) {
      const Ticks before = simulator_.now();
      const Ticks last = last_moment(simulator_, question_.bound);
      Ticks lookahead = flow::never;  // there are no hybrid clocks
      const Ticks reached = first_moment(simulator_, program_, question_.goal, lookahead);
      const Ticks lost = first_moment(simulator_, program_, question_.lost, lookahead);
      if (last < before) return std::nullopt;
      if (reached <= before) return Entry{{}, steps, 0, true};
      if (lost <= before) return std::nullopt;
      const std::uint32_t level = levels_.of(simulator_.slots());
      if (level >= target) return Entry{simulator_.snapshot(), steps, level, false};
      RunLimits limits;
      limits.until = last;
      const std::optional<Ending> ending = simulator_.step(limits);
      const Ticks now = std::min(simulator_.now(), last);
      if (std::min(reached, lost) <= now)
        return reached <= lost ? std::optional(Entry{{}, steps, 0, true}) : std::nullopt;
      if (ending) {
        if (*ending == Ending::zeno || (*ending == Ending::horizon && cut_off(simulator_, question_.bound)))
          ++result.unknown;
        return std::nullopt;
      }
      if (++steps > question_.bound.steps) return std::nullopt;
      if (++result.transitions % between_polls == 0 && request_.poll) request_.poll(0);
      at_once = now == before ? at_once + 1 : 0;
      if (at_once >= most_steps_at_once || steps >= request_.most_steps) {
        ++result.unknown;
        return std::nullopt;
      }
    }
  }

  const program::Program& program_;
  const Levels& levels_;
  const RunQuestion& question_;
  const SplittingRequest& request_;
  Simulator simulator_;
};

}  // namespace

std::vector<Replication> split(const Simulation& simulation, const Levels& levels, const RunQuestion& question,
                               const SplittingRequest& request) {
  check(simulation, question);
  std::vector<Replication> result(request.replications);
  share_work(request.threads, request.replications, request.poll, [&] {
    return [&, splitter = Splitter(simulation, levels, question, request)](std::uint64_t n) mutable {
      splitter.run(request.first + n, result[n]);
    };
  });
  return result;
}

}  // namespace tachk::simulation
