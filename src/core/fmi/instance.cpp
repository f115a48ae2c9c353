#include "fmi/instance.hpp"

#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace tachk::fmi {

using flow::Ticks;

std::vector<std::byte> Snapshot::bytes() const {
  std::vector<std::int64_t> numbers = course.save();
  numbers.push_back(static_cast<std::int64_t>(mode));
  const std::span<const std::byte> written = std::as_bytes(std::span(numbers));
  return {written.begin(), written.end()};
}

std::unique_ptr<Snapshot> Snapshot::of(std::shared_ptr<const Blueprint> blueprint, std::span<const std::byte> bytes) {
  if (bytes.size() < 8 || bytes.size() % 8 != 0) throw std::invalid_argument("the saved state has a wrong size");
  std::vector<std::int64_t> numbers(bytes.size() / 8);
  std::memcpy(numbers.data(), bytes.data(), bytes.size());
  const std::int64_t mode = numbers.back();
  if (mode < 0 || mode > static_cast<std::int64_t>(Mode::terminated)) throw std::invalid_argument("bad saved state");
  numbers.pop_back();
  return std::make_unique<Snapshot>(Snapshot{Course::restore(std::move(blueprint), numbers), static_cast<Mode>(mode)});
}

Instance::Instance(const std::string& resources, const std::string& token, Logger logger)
    : blueprint_(std::make_shared<const Blueprint>(resources + "/network.bin")),
      course_(std::make_unique<Course>(blueprint_)),
      logger_(std::move(logger)) {
  if (blueprint_->token() != token) throw std::invalid_argument("the description belongs to another network");
}

void Instance::require(Mode mode, const char* what) const {
  if (mode_ != mode) throw std::logic_error(std::string(what) + " was called at a wrong time");
}

void Instance::initialize(double start, std::optional<double> stop) {
  require(Mode::instantiated, "EnterInitializationMode");
  course_->start_at(start, stop);
  mode_ = Mode::initialization;
}

void Instance::reset() {
  course_ = std::make_unique<Course>(blueprint_);
  mode_ = Mode::instantiated;
}

Advance Instance::advance(double time, double size, bool stops, bool at_end) {
  require(Mode::step, "DoStep");
  Course& course = *course_;
  const TimeScale& scale = course.scale();
  const Ticks here = scale.ticks(time) - course.start();
  if (std::abs(here - course.now()) > scale.slack(time)) throw std::invalid_argument("a step begins at a wrong time");
  if (!(size >= 0)) throw std::invalid_argument("a step goes back");
  const Ticks target = std::max(scale.ticks(time + size) - course.start(), course.now());
  for (;;) {
    const Ticks next = course.next_event();
    if (next > target) break;
    const bool waited = next == course.now();
    course.wait_until(next);
    if (stops || (next == target && !at_end)) return {next, true, false};
    // Time cannot pass, and only the surroundings can do something.
    if (!course.react() && waited && course.next_event() == next && !course.ending()) return {next, true, false};
    if (course.ending()) return {course.now(), false, true};
  }
  if (course.ending()) return {course.now(), false, true};
  course.wait_until(target);
  return {target, false, false};
}

std::unique_ptr<Snapshot> Instance::snapshot() const {
  return std::make_unique<Snapshot>(Snapshot{Course(*course_), mode_});
}

void Instance::restore(const Snapshot& snapshot) {
  course_ = std::make_unique<Course>(snapshot.course);
  mode_ = snapshot.mode;
}

}  // namespace tachk::fmi
