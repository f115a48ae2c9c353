#include "fmi/instance.hpp"

#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace tachk::fmi {

using flow::Ticks;

std::vector<std::byte> Snapshot::bytes() const {
  std::vector<std::int64_t> numbers = run.save();
  numbers.push_back(static_cast<std::int64_t>(mode));
  const std::span<const std::byte> written = std::as_bytes(std::span(numbers));
  return {written.begin(), written.end()};
}

std::unique_ptr<Snapshot> Snapshot::of(std::shared_ptr<const ResourceFile> resource, std::span<const std::byte> bytes) {
  if (bytes.size() < 8 || bytes.size() % 8 != 0) throw std::invalid_argument("the saved state has a wrong size");
  std::vector<std::int64_t> numbers(bytes.size() / 8);
  std::memcpy(numbers.data(), bytes.data(), bytes.size());
  const std::int64_t mode = numbers.back();
  if (mode < 0 || mode > static_cast<std::int64_t>(Mode::terminated)) throw std::invalid_argument("bad saved state");
  numbers.pop_back();
  return std::make_unique<Snapshot>(Snapshot{UnitRun::restore(std::move(resource), numbers), static_cast<Mode>(mode)});
}

Instance::Instance(const std::string& resources, const std::string& token, Logger logger)
    : resource_(std::make_shared<const ResourceFile>(resources + "/network.bin")),
      run_(std::make_unique<UnitRun>(resource_)),
      logger_(std::move(logger)) {
  if (resource_->token() != token) throw std::invalid_argument("the description belongs to another network");
}

void Instance::require(Mode mode, const char* what) const {
  if (mode_ != mode) throw std::logic_error(std::string(what) + " was called at a wrong time");
}

void Instance::initialize(double start, std::optional<double> stop) {
  require(Mode::instantiated, "EnterInitializationMode");
  run_->start_at(start, stop);
  mode_ = Mode::initialization;
}

void Instance::reset() {
  run_ = std::make_unique<UnitRun>(resource_);
  mode_ = Mode::instantiated;
}

Advance Instance::advance(double time, double size, bool stops, bool at_end) {
  require(Mode::step, "DoStep");
  UnitRun& run = *run_;
  const TimeScale& scale = run.scale();
  const Ticks here = scale.ticks(time) - run.start();
  if (std::abs(here - run.now()) > scale.slack(time)) throw std::invalid_argument("a step begins at a wrong time");
  if (!(size >= 0)) throw std::invalid_argument("a step goes back");
  const Ticks target = std::max(scale.ticks(time + size) - run.start(), run.now());
  for (;;) {
    const Ticks next = run.next_event();
    if (next > target) break;
    const bool waited = next == run.now();
    run.wait_until(next);
    if (stops || (next == target && !at_end)) return {next, true, false};
    // Time cannot pass, and only the environment can do something.
    if (!run.react() && waited && run.next_event() == next && !run.ending()) return {next, true, false};
    if (run.ending()) return {run.now(), false, true};
  }
  if (run.ending()) return {run.now(), false, true};
  run.wait_until(target);
  return {target, false, false};
}

std::unique_ptr<Snapshot> Instance::snapshot() const {
  return std::make_unique<Snapshot>(Snapshot{UnitRun(*run_), mode_});
}

void Instance::restore(const Snapshot& snapshot) {
  run_ = std::make_unique<UnitRun>(snapshot.run);
  mode_ = snapshot.mode;
}

}  // namespace tachk::fmi
