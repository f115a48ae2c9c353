#include "simulation/runs.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <optional>
#include <utility>

#include "simulation/crew.hpp"
#include "simulation/horizon.hpp"

namespace tachk::simulation {

using flow::Ticks;

namespace {

constexpr Ticks rows = 1000;

// Whether time can pass where a run ends; not where that cannot be computed.
bool lasts(Simulator& simulator) {
  try {
    return simulator.time_passes();
  } catch (const machine::ModelFault&) {
    return false;
  }
}

// How far rows are apart that tell how hybrid clocks go on.
Ticks between_rows(Ticks until, Ticks ticks_per_unit) {
  return until < flow::latest_end ? std::max(until / rows, Ticks{1}) : 10 * flow::flow_sample(ticks_per_unit);
}

}  // namespace

Simulation::Simulation(program::Program program, std::span<const std::int64_t> chances)
    : program_(std::move(program)), chances_(flow::decode_chances(chances, program_)), tables_(program_, chances_) {}

std::vector<RunRecord> Simulation::run(const Order& order) const {
  std::vector<RunRecord> records(order.runs);
  share_work(order.threads, order.runs, [&] {
    return [&, simulator = Simulator(program_, chances_, tables_, order.policy, order.ticks_per_unit),
            looks = std::uint64_t{0}](std::uint64_t n) mutable {
      run_one(simulator, order, order.first + n, records[n], looks);
    };
  });
  return records;
}

void Simulation::run_one(Simulator& simulator, const Order& order, std::uint64_t number, RunRecord& record,
                         std::uint64_t& looks) const {
  const RunLimits& limits = order.limits;
  try {
    if (!simulator.begin(order.seed, number)) {
      record.ending = Ending::initial;
      return;
    }
    keep(simulator, order.recording, record);
    std::uint64_t at_once = 0;
    std::optional<Ending> ending;
    while (!ending) {
      if (record.transitions >= limits.steps) {
        ending = Ending::steps;
        break;
      }
      const Ticks before = simulator.now();
      RunLimits sight = limits;
      const bool notes = order.recording.observed && simulator.has_hybrid_clocks();
      if (notes)
        sight.until = std::min(limits.until, next_note(simulator, between_rows(limits.until, order.ticks_per_unit)));
      ending = simulator.step(sight);
      if (ending == Ending::horizon && notes) {
        if (order.recording.actions) record.sizes.push_back(0);
        keep_values(simulator, order.recording, record);
        if (simulator.now() == limits.until) break;
        ending.reset();
        continue;
      }
      if (ending) break;
      ++record.transitions;
      if (++looks % between_stops == 0 && order.stop && order.stop()) throw Stopped();
      keep(simulator, order.recording, record);
      at_once = simulator.now() == before ? at_once + 1 : 0;
      if (at_once >= limits.steps_at_once) ending = Ending::zeno;
    }
    record.ending = *ending;
  } catch (const machine::ModelFault& fault) {
    record.ending = Ending::fault;
    record.fault = fault.kind;
    record.position = fault.position;
    simulator.retreat();
  }
  record.end = simulator.now();
  record.lasts = lasts(simulator);
}

void Simulation::keep(Simulator& simulator, const Recording& recording, RunRecord& record) const {
  if (!recording.actions && !recording.observed && !recording.clocks) return;
  if (recording.actions) {
    record.sizes.push_back(static_cast<std::uint32_t>(simulator.edges().size()));
    record.edges.insert(record.edges.end(), simulator.edges().begin(), simulator.edges().end());
  }
  keep_values(simulator, recording, record);
}

void Simulation::keep_values(Simulator& simulator, const Recording& recording, RunRecord& record) const {
  record.times.push_back(simulator.now());
  if (recording.observed)
    for (const flow::Number& number : chances_.observed) {
      const double value = number.value(simulator.machine(), simulator.slots());
      record.observed.push_back(number.integer() ? static_cast<std::int64_t>(value)
                                                 : std::bit_cast<std::int64_t>(value));
    }
  if (recording.clocks)
    for (int clock = 1; clock < program_.dimension(); ++clock)
      record.clocks.push_back(simulator.clocks().value(static_cast<std::size_t>(clock), simulator.now()));
}

}  // namespace tachk::simulation
