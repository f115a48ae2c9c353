// A run of a unit: its inputs so far and its state. A copy goes on by itself.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "fmi/resource_file.hpp"
#include "simulation/simulator.hpp"

namespace tachk::fmi {

class UnitRun {
 public:
  explicit UnitRun(std::shared_ptr<const ResourceFile> resource);
  UnitRun(const UnitRun& other);
  UnitRun& operator=(const UnitRun& other) = delete;

  // ---- variables. All throw std::invalid_argument for a variable of another type or one that cannot be set, and
  // ModelFault.
  double real(std::uint32_t reference);
  std::int64_t number(std::uint32_t reference, Type type);
  void set_number(std::uint32_t reference, Type type, std::int64_t value);
  bool ticks(std::uint32_t reference) const;  // whether a channel was used by the last transition
  void set_ticks(std::uint32_t reference);
  bool ticking() const;  // some channel over which the network sends

  // ---- the run
  // Begins it if that has not been done. Throws std::invalid_argument if there is no initial state, and ModelFault.
  void begin();
  // When it begins, in seconds, and when it ends at the latest if that is known. If that is too long for the finest
  // ticks, they are coarser. Throws std::invalid_argument.
  void start_at(double start, std::optional<double> stop);
  const TimeScale& scale() const { return scale_; }
  flow::Ticks start() const { return start_; }
  flow::Ticks now() const { return now_; }
  // When something may happen next; `never` if nothing does by itself. Nothing happens before.
  flow::Ticks next_event();
  // To a moment that is not behind `next_event`.
  void wait_until(flow::Ticks moment);
  // Executes this moment: the changes of the environment, or else one transition. False if there is none.
  bool react();
  // Why nothing can happen any more.
  std::optional<simulation::Ending> ending() const { return ending_; }

  // ---- as numbers
  std::vector<std::int64_t> save() const;
  // Throws std::invalid_argument if the numbers were not saved by a unit of the same network.
  static UnitRun restore(std::shared_ptr<const ResourceFile> resource, std::span<const std::int64_t> saved);

 private:
  // The changes of the environment, with their times.
  struct Intake {
    std::uint64_t transitions;  // of the network before it
    flow::Ticks moment;
    bool settled;  // whether the network could have acted at that moment, and did not
    std::uint32_t edge;
    std::vector<std::int32_t> inputs;
  };
  struct Parameters {
    std::uint64_t seed = 0;
    std::uint64_t run = 0;
    simulation::Policy policy = simulation::Policy::stochastic;
  };

  // The state that a co-simulation of several networks needs.
  struct Environment {
    std::vector<std::int32_t> inputs;   // of each variable
    std::vector<std::int64_t> counts;   // of each variable: how often its channel was used
    std::vector<std::int64_t> pending;  // of each variable: how often they still have to send
    bool changed = false;               // inputs that the network has not read
    std::vector<Intake> intakes;        // all of them so far
  };

  const Variable& variable(std::uint32_t reference, Type type) const;
  void choose(Role parameter, std::int64_t value);
  void set_input(std::uint32_t place, std::int64_t value);
  void set_count(std::uint32_t place, std::int64_t value);
  void environment_sends(std::uint32_t edge);
  void take(const Intake& intake);
  bool transition();
  void count();
  void go_through(const Intake& intake);

  std::shared_ptr<const ResourceFile> resource_;
  Parameters parameters_;
  std::unique_ptr<simulation::Simulator> simulator_;  // null before the run has begun
  TimeScale scale_;
  flow::Ticks ticks_per_unit_ = flow::finest_ticks;
  flow::Ticks start_ = 0;  // of the run, in the time of the environment
  flow::Ticks now_ = 0;    // since the start
  std::uint64_t transitions_ = 0;
  std::uint64_t at_once_ = 0;  // transitions without time between them
  flow::Ticks last_ = 0;       // when the last one was
  bool settled_ = false;       // the network could have acted at this moment, and did not
  bool fresh_ = false;         // what happened last is the last transition of the network
  std::optional<simulation::Ending> ending_;
  Environment outside_;
};

}  // namespace tachk::fmi
