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

void RunRecord::clear() {
  ending = Ending::horizon;
  end = 0;
  lasts = false;
  transitions = 0;
  fault = machine::FaultKind::range;
  position = program::no_code;
  times.clear();
  sizes.clear();
  edges.clear();
  observed.clear();
  clocks.clear();
}

Simulation::Simulation(program::Program program, std::span<const std::int64_t> chances)
    : program_(std::move(program)), chances_(flow::decode_chances(chances, program_)), tables_(program_, chances_) {}

std::vector<RunRecord> Simulation::run(const RunRequest& request) const {
  std::vector<RunRecord> records(request.runs);
  share_work(request.threads, request.runs, request.poll, [&] {
    return [&, recorder = RunRecorder(*this, request)](std::uint64_t n) mutable {
      recorder.run(request.first + n, records[n]);
    };
  });
  return records;
}

RunRecorder::RunRecorder(const Simulation& simulation, const RunRequest& request, Enough enough)
    : simulation_(simulation),
      request_(request),
      enough_(std::move(enough)),
      simulator_(simulation.program(), simulation.chances(), simulation.tables(), request.policy,
                 request.ticks_per_unit) {}

void RunRecorder::run(std::uint64_t number, RunRecord& record) {
  record.clear();
  try {
    if (!simulator_.begin(request_.seed, number)) {
      record.ending = Ending::initial;
      return;
    }
    go_on(record);
  } catch (const machine::ModelFault& fault) {
    record.ending = Ending::fault;
    record.fault = fault.kind;
    record.position = fault.position;
    if (request_.recording.observed)  // a row is kept whole or not at all
      record.observed.resize(record.times.size() * simulation_.chances().observed.size());
    simulator_.retreat();
  }
  record.end = simulator_.now();
  record.lasts = lasts(simulator_);
}

void RunRecorder::go_on(RunRecord& record) {
  const RunLimits& limits = request_.limits;
  const std::uint64_t work = 1 + cells_of_row();
  const bool notes = request_.recording.observed && simulator_.has_hybrid_clocks();
  if (keep(record)) return;
  std::uint64_t at_once = 0;
  while (true) {
    if (record.transitions >= limits.steps) {
      record.ending = Ending::steps;
      return;
    }
    unseen_ += work;
    if (unseen_ >= between_polls && request_.poll) {
      unseen_ = 0;
      request_.poll(0);
    }
    const Ticks before = simulator_.now();
    RunLimits bounded = limits;
    if (notes)
      bounded.until =
          std::min(limits.until, next_note(simulator_, between_rows(limits.until, request_.ticks_per_unit)));
    const std::optional<Ending> ending = simulator_.step(bounded);
    if (ending == Ending::horizon && notes) {
      keep_values(record);
      if (request_.recording.actions) record.sizes.push_back(0);
      if (simulator_.now() == limits.until || (enough_ && enough_(record))) return;
      continue;
    }
    if (ending) {
      record.ending = *ending;
      return;
    }
    ++record.transitions;
    if (keep(record)) return;
    at_once = simulator_.now() == before ? at_once + 1 : 0;
    if (at_once >= limits.steps_at_once) {
      record.ending = Ending::zeno;
      return;
    }
  }
}

std::size_t RunRecorder::cells_of_row() const {
  const RecordedParts& recording = request_.recording;
  return (recording.observed ? simulation_.chances().observed.size() : 0) +
         (recording.clocks ? static_cast<std::size_t>(simulation_.program().dimension()) : 0);
}

// Records a state. True if that is enough of the run.
bool RunRecorder::keep(RunRecord& record) {
  const RecordedParts& recording = request_.recording;
  if (!recording.actions && !recording.observed && !recording.clocks) return false;
  keep_values(record);
  if (recording.actions) {
    make_room(record.sizes, 1, request_.poll);
    record.sizes.push_back(static_cast<std::uint32_t>(simulator_.edges().size()));
    make_room(record.edges, simulator_.edges().size(), request_.poll);
    record.edges.insert(record.edges.end(), simulator_.edges().begin(), simulator_.edges().end());
  }
  return enough_ && enough_(record);
}

void RunRecorder::keep_values(RunRecord& record) {
  if (request_.recording.observed) {
    make_room(record.observed, simulation_.chances().observed.size(), request_.poll);
    for (const flow::Number& number : simulation_.chances().observed) {
      const double value = number.value(simulator_.machine(), simulator_.slots());
      record.observed.push_back(number.integer() ? static_cast<std::int64_t>(value)
                                                 : std::bit_cast<std::int64_t>(value));
    }
  }
  make_room(record.times, 1, request_.poll);
  record.times.push_back(simulator_.now());
  if (request_.recording.clocks) {
    const auto dimension = static_cast<std::size_t>(simulation_.program().dimension());
    make_room(record.clocks, dimension, request_.poll);
    for (std::size_t clock = 1; clock < dimension; ++clock)
      record.clocks.push_back(simulator_.clocks().value(clock, simulator_.now()));
  }
}

}  // namespace tachk::simulation
