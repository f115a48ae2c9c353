// Clocks at exact moments. Time is counted in ticks, of which a power of ten is a unit of time, so that sums and
// comparisons are exact and a moment has a short decimal fraction. A run that is too long for the finest ticks has
// coarser ones.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "program/program.hpp"
#include "zones/bound.hpp"

namespace tachk::flow {

using Ticks = std::int64_t;

inline constexpr Ticks finest_ticks = 1'000'000'000;  // in a unit
inline constexpr Ticks coarsest_ticks = 1'000;
inline constexpr Ticks never = std::numeric_limits<Ticks>::max() / 2;
inline constexpr Ticks latest_end = Ticks{1} << 58;  // of a run

// The moments from first to last; none if last < first.
struct Window {
  Ticks first = -never;
  Ticks last = never;

  bool holds(Ticks moment) const { return first <= moment && moment <= last; }
  bool empty() const { return last < first; }
};

// The values of all clocks as functions of the moment: offset + moment where a clock runs, offset where it stands.
class ClockValues {
 public:
  explicit ClockValues(int dimension, Ticks ticks_per_unit = finest_ticks)
      : ticks_per_unit_(ticks_per_unit),
        offsets_(static_cast<std::size_t>(dimension), 0),
        running_(static_cast<std::size_t>(dimension), 1) {
    running_[0] = 0;
  }

  void start() {
    std::fill(offsets_.begin(), offsets_.end(), 0);
    std::fill(running_.begin() + 1, running_.end(), std::int8_t{1});
  }
  Ticks value(std::size_t clock, Ticks now) const { return offsets_[clock] + (running_[clock] != 0 ? now : 0); }
  void set(std::size_t clock, Ticks value, Ticks now) { offsets_[clock] = value - (running_[clock] != 0 ? now : 0); }
  bool runs(std::size_t clock) const { return running_[clock] != 0; }
  void run(std::size_t clock, bool runs, Ticks now) {
    const Ticks before = value(clock, now);
    running_[clock] = runs ? 1 : 0;
    set(clock, before, now);
  }

  // Narrows the window to the moments at which x_left - x_right is within the bound, if clocks go on as they do.
  void narrow(std::uint16_t left, std::uint16_t right, zones::Raw raw, Window& window) const {
    const Ticks room =
        zones::raw_value(raw) * ticks_per_unit_ - ((raw & 1) == 0 ? 1 : 0) - offsets_[left] + offsets_[right];
    switch (running_[left] - running_[right]) {
      case 1:
        if (room < window.last) window.last = room;
        break;
      case -1:
        if (-room > window.first) window.first = -room;
        break;
      default:
        if (room < 0) window.last = -never - 1;
    }
  }

 private:
  Ticks ticks_per_unit_;
  std::vector<Ticks> offsets_;
  std::vector<std::int8_t> running_;
};

}  // namespace tachk::flow
