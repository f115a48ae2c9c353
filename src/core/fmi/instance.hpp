// An instance of a unit as masters of either version of FMI see it.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fmi/unit_run.hpp"

namespace tachk::fmi {

enum class Mode : std::int64_t { instantiated, initialization, event, step, terminated };

// The state that may be saved and restored.
struct Snapshot {
  UnitRun run;
  Mode mode;

  std::vector<std::byte> bytes() const;
  static std::unique_ptr<Snapshot> of(std::shared_ptr<const ResourceFile> resource, std::span<const std::byte> bytes);
};

// How far a step came, and why no further.
struct Advance {
  flow::Ticks end;
  bool event;  // something happens at the end that has not been handled
  bool over;   // nothing can happen any more
};

class Instance {
 public:
  using Logger = std::function<void(const char* message)>;

  // The resources are a folder. Throws std::invalid_argument.
  Instance(const std::string& resources, const std::string& token, Logger logger);

  UnitRun& run() { return *run_; }
  const ResourceFile& resource() const { return *resource_; }
  void log(const char* message) const { logger_(message); }

  // ---- modes. They throw std::logic_error if the unit is in another.
  void require(Mode mode, const char* what) const;
  void enter(Mode mode) { mode_ = mode; }
  Mode mode() const { return mode_; }
  void initialize(double start, std::optional<double> stop);
  void reset();

  // Goes on to a time. `stops`: at the first event; otherwise events are handled on the way, and `at_end` says whether
  // also those at its end.
  Advance advance(double time, double size, bool stops, bool at_end);

  std::unique_ptr<Snapshot> snapshot() const;
  void restore(const Snapshot& snapshot);
  std::unique_ptr<Snapshot> snapshot_of(std::span<const std::byte> bytes) const {
    return Snapshot::of(resource_, bytes);
  }

 private:
  std::shared_ptr<const ResourceFile> resource_;
  std::unique_ptr<UnitRun> run_;
  Mode mode_ = Mode::instantiated;
  Logger logger_;
};

// Runs a call from outside; an error is logged, and gives `failed`.
template <class Status, class Body>
Status guarded(void* instance, Status fine, Status failed, Body body) {
  auto* unit = static_cast<Instance*>(instance);
  if (unit == nullptr) return failed;
  try {
    body(*unit);
    return fine;
  } catch (const machine::ModelFault& fault) {
    unit->log(
        ("a run-time error of the model, at position " + std::to_string(fault.position) + " of its code").c_str());
  } catch (const std::exception& error) {
    unit->log(error.what());
  }
  return failed;
}

}  // namespace tachk::fmi
