// Many runs, by several threads, each recorded on its own.
#pragma once

#include <cstdint>
#include <functional>
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

  // Back to what a new record is, but for the memory that it has.
  void clear();
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
  program::Program program_;
  flow::Chances chances_;
  Tables tables_;
};

// Draws runs one after the other. The arguments must outlive it.
class RunRecorder {
 public:
  // Looks at what is recorded so far, after each row: true ends the run there. May be empty.
  using Enough = std::function<bool(const RunRecord& record)>;

  RunRecorder(const Simulation& simulation, const RunRequest& request, Enough enough = {});

  // The run of this number, in the place of what the record holds. Throws what `poll` throws.
  void run(std::uint64_t number, RunRecord& record);

 private:
  void go_on(RunRecord& record);
  bool keep(RunRecord& record);
  void keep_values(RunRecord& record);
  std::size_t cells_of_row() const;

  const Simulation& simulation_;
  const RunRequest& request_;
  Enough enough_;
  Simulator simulator_;
  std::uint64_t unseen_ = 0;  // transitions, with what is recorded of them, since the last poll
};

}  // namespace tachk::simulation
