#include "localtime/local_zone.hpp"

#include <algorithm>
#include <utility>

namespace tachk::localtime {
namespace {

constexpr LocalEntry zero = zones::raw_zero;

LocalEntry sum(LocalEntry a, LocalEntry b) {
  if (a == LocalZones::infinity || b == LocalZones::infinity) return LocalZones::infinity;
  return a + b - ((a | b) & 1);
}

}  // namespace

LocalZones::LocalZones(std::size_t agents, std::vector<std::uint32_t> of_clock)
    : agents_(agents),
      of_clock_(std::move(of_clock)),
      size_(agents + of_clock_.size() - 1),
      to_(size_),
      from_(size_),
      weak_(size_),
      strict_(size_) {}

void LocalZones::make_zero(LocalEntry* zone) const { std::fill_n(zone, size(), zero); }

bool LocalZones::tighten(LocalEntry* zone, std::size_t i, std::size_t j, LocalEntry bound) {
  if (bound >= zone[i * size_ + j]) return true;
  if (sum(bound, zone[j * size_ + i]) < zero) return false;
  for (std::size_t r = 0; r < size_; ++r) {
    const LocalEntry to_j = sum(zone[r * size_ + i], bound);
    to_[r] = to_j < zone[r * size_ + j] ? to_j : infinity;  // else no way through (i, j) is shorter
  }
  shorten(zone, zone + j * size_);
  return true;
}

bool LocalZones::meet(LocalEntry* zone, std::span<const std::uint32_t> agents) {
  if (agents.size() < 2) return true;
  for (const std::uint32_t p : agents)
    for (const std::uint32_t q : agents)
      if (zone[p * size_ + q] < zero) return false;
  // They have one time now: the shortest way to it and from it is the shortest one to and from any of them.
  std::fill(to_.begin(), to_.end(), infinity);
  std::fill(from_.begin(), from_.end(), infinity);
  for (const std::uint32_t agent : agents) {
    for (std::size_t r = 0; r < size_; ++r) to_[r] = std::min(to_[r], zone[r * size_ + agent]);
    for (std::size_t k = 0; k < size_; ++k) from_[k] = std::min(from_[k], zone[agent * size_ + k]);
  }
  shorten(zone, from_.data());
  return true;
}

// Takes the ways through one point where they are shorter: to it as in `to_`, and on as in `from`.
void LocalZones::shorten(LocalEntry* zone, const LocalEntry* from) {
  prepare(from, size_);
  for (std::size_t r = 0; r < size_; ++r) {
    const LocalEntry to = to_[r];
    if (to == infinity) continue;
    LocalEntry* row = zone + r * size_;
    const LocalEntry* on = (to & 1) != 0 ? weak_.data() : strict_.data();
    for (std::size_t k = 0; k < size_; ++k) row[k] = std::min(row[k], to + on[k]);
  }
}

void LocalZones::prepare(const LocalEntry* bounds, std::size_t count) {
  // A sum with a weak bound is one less, with a strict one it loses what the other has. What is beyond infinity never
  // is the minimum.
  constexpr LocalEntry beyond = infinity + infinity / 2;
  for (std::size_t k = 0; k < count; ++k) {
    weak_[k] = bounds[k] == infinity ? beyond : bounds[k] - 1;
    strict_[k] = bounds[k] == infinity ? beyond : bounds[k] - (bounds[k] & 1);
  }
}

bool LocalZones::constrain(LocalEntry* zone, zones::Atom atom) {
  const auto bound = static_cast<LocalEntry>(atom.raw);
  if (atom.left == atom.right) return bound >= zero;
  // x <= c is t - x <= c, x >= c is x - t <= -c: `raw` bounds left - right, where the reference clock is 0.
  if (atom.right == 0) return tighten(zone, of_clock_[atom.left], row_of(atom.left), bound);
  return tighten(zone, row_of(atom.right), of_clock_[atom.right], bound);
}

void LocalZones::reset(LocalEntry* zone, zones::ClockReset reset) const {
  const std::size_t clock = row_of(reset.clock);
  const std::size_t time = of_clock_[reset.clock];
  const LocalEntry shift = 2 * reset.value;  // x := t - value
  for (std::size_t k = 0; k < size_; ++k) {
    if (k == clock) continue;
    const LocalEntry above = zone[time * size_ + k];
    const LocalEntry below = zone[k * size_ + time];
    zone[clock * size_ + k] = above == infinity ? infinity : above - shift;
    zone[k * size_ + clock] = below == infinity ? infinity : below + shift;
  }
  zone[clock * size_ + clock] = zero;
}

void LocalZones::elapse(LocalEntry* zone, std::uint32_t agent) const {
  LocalEntry* row = zone + agent * size_;
  std::fill_n(row, size_, infinity);
  row[agent] = zero;
}

bool LocalZones::synchronised(const LocalEntry* zone, LocalEntry* clocks) {
  // One time takes the place of all: the shortest way from it and to it is the shortest one from and to any of them. A
  // way through it twice is never shorter, or two agents could not have the same time.
  int apart = 0;
  for (std::size_t p = 0; p < agents_; ++p)
    for (std::size_t q = 0; q < agents_; ++q) apart |= static_cast<int>(zone[p * size_ + q] < zero);
  if (apart != 0) return false;
  const std::size_t dimension = of_clock_.size();
  const std::size_t count = dimension - 1;
  LocalEntry* upper = from_.data();  // of t - x, the value of each clock
  std::fill_n(upper, count, infinity);
  for (std::size_t p = 0; p < agents_; ++p) {
    const LocalEntry* values = zone + p * size_ + agents_;
    for (std::size_t x = 0; x < count; ++x) upper[x] = std::min(upper[x], values[x]);
  }
  clocks[0] = zero;
  for (std::size_t x = 0; x < count; ++x) clocks[(x + 1) * dimension] = upper[x];
  prepare(upper, count);
  for (std::size_t y = 0; y < count; ++y) {
    const LocalEntry* row = zone + (agents_ + y) * size_;
    const LocalEntry lower = *std::min_element(row, row + agents_);  // of y - t
    clocks[y + 1] = lower;
    // The value of x minus that of y is the zero of y minus that of x.
    const LocalEntry* direct = row + agents_;
    LocalEntry* column = clocks + dimension + y + 1;
    const LocalEntry* on = (lower & 1) != 0 ? weak_.data() : strict_.data();
    if (lower == infinity)
      for (std::size_t x = 0; x < count; ++x) column[x * dimension] = direct[x];
    else
      for (std::size_t x = 0; x < count; ++x) column[x * dimension] = std::min(direct[x], lower + on[x]);
  }
  return true;
}

void LocalZones::rename(LocalEntry* target, const LocalEntry* zone, std::span<const std::uint32_t> agents,
                        std::span<const std::uint16_t> clocks) const {
  std::vector<std::size_t> sources(agents.begin(), agents.end());
  for (std::size_t clock = 1; clock < clocks.size(); ++clock) sources.push_back(row_of(clocks[clock]));
  for (std::size_t i = 0; i < size_; ++i)
    for (std::size_t j = 0; j < size_; ++j) target[i * size_ + j] = zone[sources[i] * size_ + sources[j]];
}

bool LocalZones::is_legal(const LocalEntry* zone) const {
  int illegal = 0;  // gathered without branches, so that the compiler uses vectors
  for (std::size_t k = 0; k < size(); ++k) {
    const LocalEntry entry = zone[k] == infinity ? 0 : zone[k];
    illegal |= static_cast<int>(entry >= legal) | static_cast<int>(entry <= -legal);
  }
  return illegal == 0;
}

}  // namespace tachk::localtime
