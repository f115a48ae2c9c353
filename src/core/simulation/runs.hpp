// Many runs, by several threads, each recorded on its own.
#pragma once

#include <cstdint>
#include <vector>

#include "flow/chances.hpp"
#include "machine/opcode.hpp"
#include "program/program.hpp"
#include "simulation/simulator.hpp"
#include "simulation/tables.hpp"
#include "simulation/thread_pool.hpp"

namespace tachk::simulation {

// The parts of a run that are recorded, beside how it ends.
struct RecordedParts {
  bool actions = false;   // the edges of each transition
  bool observed = false;  // the values of `Chances::observed` in each state
  bool clocks = false;    // the values of all clocks in each state
};

struct RunRecord {
  Ending ending = Ending::horizon;
  flow::Ticks end = 0;
  bool lasts = false;  // whether time can pass in the last state
  std::uint64_t transitions = 0;
  machine::FaultKind fault = machine::FaultKind::range;  // of a run that ends with one
  std::int32_t position = program::no_code;              // where in the code
  std::vector<flow::Ticks> times;      // of the initial state and of each transition, if anything is kept
  std::vector<std::uint32_t> sizes;    // of each action
  std::vector<std::uint32_t> edges;    // of all of them
  std::vector<std::int64_t> observed;  // row by row; doubles as their bits
  std::vector<flow::Ticks> clocks;     // row by row
};

struct RunRequest {
  std::uint64_t seed = 0;
  std::uint64_t first = 0;  // the number of the first run
  std::uint64_t runs = 1;
  unsigned threads = 1;
  Policy policy = Policy::stochastic;
  RunLimits limits;
  flow::Ticks ticks_per_unit = flow::finest_ticks;
  RecordedParts recording;
  Poll poll = {};
};

class Simulation {
 public:
  Simulation(program::Program program, std::span<const std::int64_t> chances);
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  // The runs in the order of their numbers, whatever the number of threads. Throws what `poll` throws.
  std::vector<RunRecord> run(const RunRequest& request) const;

  const program::Program& program() const { return program_; }
  const flow::Chances& chances() const { return chances_; }
  const Tables& tables() const { return tables_; }

 private:
  void run_one(Simulator& simulator, const RunRequest& request, std::uint64_t number, RunRecord& record,
               std::uint64_t& unseen) const;
  void keep(Simulator& simulator, const RunRequest& request, RunRecord& record) const;
  void keep_values(Simulator& simulator, const RunRequest& request, RunRecord& record) const;
  std::size_t cells_of_row(const RecordedParts& recording) const;

  program::Program program_;
  flow::Chances chances_;
  Tables tables_;
};

}  // namespace tachk::simulation
