#include "localtime/local_zone.hpp"

#include <algorithm>
#include <utility>

namespace tachk {
namespace {

constexpr LocalEntry zero = raw_zero;

LocalEntry sum(LocalEntry a, LocalEntry b) {
  if (a == LocalZones::infinity || b == LocalZones::infinity) return LocalZones::infinity;
  return a + b - ((a | b) & 1);
}

}  // namespace

LocalZones::LocalZones(std::size_t agents, std::vector<std::uint32_t> of_clock)
    : agents_(agents), of_clock_(std::move(of_clock)), size_(agents + of_clock_.size() - 1) {}

void LocalZones::make_zero(LocalEntry* zone) const { std::fill_n(zone, size(), zero); }

bool LocalZones::tighten(LocalEntry* zone, std::size_t i, std::size_t j, LocalEntry bound) const {
  if (bound >= zone[i * size_ + j]) return true;
  const LocalEntry* from_j = zone + j * size_;
  if (sum(bound, from_j[i]) < zero) return false;
  for (std::size_t r = 0; r < size_; ++r) {
    LocalEntry* row = zone + r * size_;
    if (row[i] == infinity) continue;
    const LocalEntry to_j = sum(row[i], bound);
    if (to_j >= row[j]) continue;  // no way through (i, j) is shorter
    for (std::size_t k = 0; k < size_; ++k) {
      // What is infinite stays far above infinity's place among the finite ones, and is cut back to it.
      const LocalEntry through = to_j + from_j[k] - ((to_j | from_j[k]) & 1);
      const LocalEntry shorter = from_j[k] == infinity ? infinity : through;
      row[k] = std::min(row[k], shorter);
    }
  }
  return true;
}

bool LocalZones::meet(LocalEntry* zone, std::span<const std::uint32_t> agents) const {
  for (std::size_t n = 1; n < agents.size(); ++n)
    if (!tighten(zone, agents[0], agents[n], zero) || !tighten(zone, agents[n], agents[0], zero)) return false;
  return true;
}

bool LocalZones::constrain(LocalEntry* zone, Atom atom) const {
  const auto bound = static_cast<LocalEntry>(atom.raw);
  if (atom.left == atom.right) return bound >= zero;
  // x <= c is t - x <= c, x >= c is x - t <= -c: `raw` bounds left - right, where the reference clock is 0.
  if (atom.right == 0) return tighten(zone, of_clock_[atom.left], row_of(atom.left), bound);
  return tighten(zone, row_of(atom.right), of_clock_[atom.right], bound);
}

void LocalZones::reset(LocalEntry* zone, ClockReset reset) const {
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

bool LocalZones::synchronised(const LocalEntry* zone, LocalEntry* clocks) const {
  // One time takes the place of all: the shortest way from it and to it is the shortest one from and to any of them. A
  // way through it twice is never shorter, or two agents could not have the same time.
  for (std::size_t p = 0; p < agents_; ++p)
    for (std::size_t q = 0; q < agents_; ++q)
      if (zone[p * size_ + q] < zero) return false;
  const std::size_t dimension = of_clock_.size();
  clocks[0] = zero;
  for (std::size_t x = 1; x < dimension; ++x) {
    LocalEntry upper = infinity;  // of t - x, the value of the clock
    LocalEntry lower = infinity;  // of x - t
    for (std::size_t p = 0; p < agents_; ++p) {
      upper = std::min(upper, zone[p * size_ + row_of(x)]);
      lower = std::min(lower, zone[row_of(x) * size_ + p]);
    }
    clocks[x * dimension] = upper;
    clocks[x] = lower;
  }
  for (std::size_t x = 1; x < dimension; ++x)
    for (std::size_t y = 1; y < dimension; ++y) {
      // The value of x minus that of y is the zero of y minus that of x.
      const LocalEntry direct = zone[row_of(y) * size_ + row_of(x)];
      clocks[x * dimension + y] = std::min(direct, sum(clocks[y], clocks[x * dimension]));
    }
  return true;
}

bool LocalZones::is_legal(const LocalEntry* zone) const {
  return std::all_of(zone, zone + size(),
                     [](LocalEntry entry) { return entry == infinity || (entry < legal && entry > -legal); });
}

}  // namespace tachk
