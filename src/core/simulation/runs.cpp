#include "simulation/runs.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <optional>
#include <utility>

#include "simulation/horizon.hpp"
#include "simulation/thread_pool.hpp"

namespace tachk::simulation {

using flow::Ticks;

namespace {

constexpr Ticks rows = 1000;

// True if time can pass where a run ends; not where that cannot be computed.
bool lasts(Simulator& simulator) {
  try {
    return simulator.time_passes();
  } catch (const machine::ModelFault&) {
    return false;
  }
}

// The size of a vector from which its copy into a larger one is checked.
constexpr std::size_t large = 1 << 20;

// Lets a vector grow by so many values.
template <class T>
void make_room(std::vector<T>& values, std::size_t more, const Poll& poll) {
  const std::size_t needed = values.size() + more;
  if (needed <= values.capacity()) return;
  const std::size_t copied = values.size() * sizeof(T);
  if (copied >= large && poll) poll(copied);
  values.reserve(std::max(needed, 2 * values.capacity()));
}

// The distance of rows that show how hybrid clocks go on.
Ticks between_rows(Ticks until, Ticks ticks_per_unit) {
  return until < flow::latest_end ? std::max(until / rows, Ticks{1}) : 10 * flow::flow_sample(ticks_per_unit);
}

}  // namespace

Simulation::Simulation(program::Program program, std::span<const std::int64_t> chances)
    : program_(std::move(program)), chances_(flow::decode_chances(chances, program_)), tables_(program_, chances_) {}

std::vector<RunRecord> Simulation::run(const RunRequest& request) const {
  std::vector<RunRecord> records(request.runs);
  share_work(request.threads, request.runs, request.poll, [&] {
    return [&, simulator = Simulator(program_, chances_, tables_, request.policy, request.ticks_per_unit),
            unseen = std::uint64_t{0}](std::uint64_t n) mutable {
      run_one(simulator, request, request.first + n, records[n], unseen);
    };
  });
  return records;
}

void Simulation::run_one(Simulator& simulator, const RunRequest& request, std::uint64_t number, RunRecord& record,
                         std::uint64_t& unseen) const {
  const RunLimits& limits = request.limits;
  const std::uint64_t work = 1 + cells_of_row(request.recording);
  try {
    if (!simulator.begin(request.seed, number)) {
      record.ending = Ending::initial;
      return;
    }
    keep(simulator, request, record);
    std::uint64_t at_once = 0;
    std::optional<Ending> ending;
    while (!ending) {
      if (record.transitions >= limits.steps) {
        ending = Ending::steps;
        break;
      }
      unseen += work;
      if (unseen >= between_polls && request.poll) {
        unseen = 0;
        request.poll(0);
      }
      const Ticks before = simulator.now();
      RunLimits bounded = limits;
      const bool notes = request.recording.observed && simulator.has_hybrid_clocks();
      if (notes)
        bounded.until =
            std::min(limits.until, next_note(simulator, between_rows(limits.until, request.ticks_per_unit)));
      ending = simulator.step(bounded);
      if (ending == Ending::horizon && notes) {
        keep_values(simulator, request, record);
        if (request.recording.actions) record.sizes.push_back(0);
        if (simulator.now() == limits.until) break;
        ending.reset();
        continue;
      }
      if (ending) break;
      ++record.transitions;
      keep(simulator, request, record);
      at_once = simulator.now() == before ? at_once + 1 : 0;
      if (at_once >= limits.steps_at_once) ending = Ending::zeno;
    }
    record.ending = *ending;
  } catch (const machine::ModelFault& fault) {
    record.ending = Ending::fault;
    record.fault = fault.kind;
    record.position = fault.position;
    if (request.recording.observed)  // a row is kept whole or not at all
      record.observed.resize(record.times.size() * chances_.observed.size());
    simulator.retreat();
  }
  record.end = simulator.now();
  record.lasts = lasts(simulator);
}

std::size_t Simulation::cells_of_row(const RecordedParts& recording) const {
  return (recording.observed ? chances_.observed.size() : 0) +
         (recording.clocks ? static_cast<std::size_t>(program_.dimension()) : 0);
}

void Simulation::keep(Simulator& simulator, const RunRequest& request, RunRecord& record) const {
  const RecordedParts& recording = request.recording;
  if (!recording.actions && !recording.observed && !recording.clocks) return;
  keep_values(simulator, request, record);
  if (recording.actions) {
    make_room(record.sizes, 1, request.poll);
    record.sizes.push_back(static_cast<std::uint32_t>(simulator.edges().size()));
    make_room(record.edges, simulator.edges().size(), request.poll);
    record.edges.insert(record.edges.end(), simulator.edges().begin(), simulator.edges().end());
  }
}

void Simulation::keep_values(Simulator& simulator, const RunRequest& request, RunRecord& record) const {
  if (request.recording.observed) {
    make_room(record.observed, chances_.observed.size(), request.poll);
    for (const flow::Number& number : chances_.observed) {
      const double value = number.value(simulator.machine(), simulator.slots());
      record.observed.push_back(number.integer() ? static_cast<std::int64_t>(value)
                                                 : std::bit_cast<std::int64_t>(value));
    }
  }
  make_room(record.times, 1, request.poll);
  record.times.push_back(simulator.now());
  if (request.recording.clocks) {
    make_room(record.clocks, static_cast<std::size_t>(program_.dimension()), request.poll);
    for (int clock = 1; clock < program_.dimension(); ++clock)
      record.clocks.push_back(simulator.clocks().value(static_cast<std::size_t>(clock), simulator.now()));
  }
}

}  // namespace tachk::simulation
