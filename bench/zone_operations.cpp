// What one zone operation costs: CPU nanoseconds for each on zones of a random walk, copying included where the
// operation changes its zone. Least of several rounds, because what others do on the machine only adds to it.
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <functional>
#include <random>
#include <vector>

#include "zones/zone.hpp"
#include "zones/zone_buffer.hpp"

namespace {

using namespace tachk::zones;

constexpr int zone_count = 512;
constexpr int rounds = 15;
constexpr int largest = 10;

double seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

struct Bench {
  Bench(int clocks, Width width, bool vector)
      : dimension(clocks + 1),
        operations(select_operations(dimension, width, vector)),
        lower(operations, dimension),
        upper(operations, dimension),
        scratch(operations) {
    for (int clock = 1; clock < dimension; ++clock) {
      operations.set_bound(lower.get(), clock, largest);
      operations.set_bound(upper.get(), clock, largest);
    }
    ZoneBuffer zone(operations);
    operations.make_zero(zone.get(), dimension);
    while (zones.size() < zone_count) {
      const auto clock = static_cast<std::uint16_t>(1 + random() % static_cast<unsigned>(clocks));
      const Atom guard{0, clock, raw_bound(-static_cast<Raw>(random() % largest), false)};
      const ClockReset reset{clock, 0};
      operations.up(zone.get(), dimension, nullptr);
      if (operations.meets_each(zone.get(), dimension, &guard, 1))
        operations.intersect(zone.get(), dimension, &guard, 1);
      operations.extrapolate_lu_plus(zone.get(), dimension, lower.get(), upper.get());
      zones.push_back(zone);
      operations.reset(zone.get(), dimension, &reset, 1);
    }
  }

  // Prints nanoseconds for `step(zone, next)` on each zone and the one behind it.
  void time(const char* name, const std::function<bool(ConstZoneRef, ConstZoneRef)>& step) {
    double best = 1e9;
    for (int round = 0; round < rounds; ++round) {
      const double start = seconds();
      for (std::size_t n = 0; n < zones.size(); ++n)
        kept += step(zones[n].get(), zones[(n + 1) % zones.size()].get()) ? 1 : 0;
      best = std::min(best, seconds() - start);
    }
    std::printf("| %s | %d | %s | %.1f |\n", operations.name, dimension, name, 1e9 * best / zone_count);
  }

  void all() {
    const Atom guard{0, 1, raw_bound(-1, true)};
    const ClockReset reset{1, 0};
    const auto changed = [this](ConstZoneRef zone) {
      scratch.assign(zone);
      return scratch.get();
    };
    time("copy", [&](ConstZoneRef zone, ConstZoneRef) { return changed(zone).bytes != nullptr; });
    time("intersect with one constraint",
         [&](ConstZoneRef zone, ConstZoneRef) { return operations.intersect(changed(zone), dimension, &guard, 1); });
    time("reset", [&](ConstZoneRef zone, ConstZoneRef) {
      operations.reset(changed(zone), dimension, &reset, 1);
      return true;
    });
    time("up", [&](ConstZoneRef zone, ConstZoneRef) {
      operations.up(changed(zone), dimension, nullptr);
      return true;
    });
    time("successor", [&](ConstZoneRef zone, ConstZoneRef) {
      const ZoneRef next = changed(zone);
      if (!operations.intersect(next, dimension, &guard, 1)) return false;
      operations.reset(next, dimension, &reset, 1);
      operations.up(next, dimension, nullptr);
      operations.extrapolate_lu_plus(next, dimension, lower.get(), upper.get());
      return true;
    });
    time("includes", [&](ConstZoneRef zone, ConstZoneRef next) { return operations.includes(zone, next, dimension); });
    time("includes itself",
         [&](ConstZoneRef zone, ConstZoneRef) { return operations.includes(zone, zone, dimension); });
    time("hash", [&](ConstZoneRef zone, ConstZoneRef) { return operations.hash(zone, dimension) != 0; });
  }

  int dimension;
  ZoneOperations operations;
  BoundRowBuffer lower;
  BoundRowBuffer upper;
  ZoneBuffer scratch;
  std::vector<ZoneBuffer> zones;
  std::minstd_rand random{1};
  std::uint64_t kept = 0;  // so that nothing is left out as useless
};

}  // namespace

int main() {
  std::printf("| kernel | dimension | operation | ns |\n|---|---|---|---|\n");
  std::uint64_t kept = 0;
  for (const int clocks : {5, 10, 20})
    for (const Width width : {Width::narrow, Width::wide}) {
      Bench bench(clocks, width, true);
      bench.all();
      kept += bench.kept;
    }
  return kept == 0 ? 1 : 0;
}
