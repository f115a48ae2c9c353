// Simulation between zones of two clocks, among others that nothing compares, against its definition: a zone is
// simulated by another one if for each valuation v of it there is one w of the other such that, for each clock x, w(x)
// is v(x), or L(x) < w(x) < v(x), or U(x) < v(x) < w(x) (Behrmann, Bouyer, Larsen, Pelanek 2006).
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <random>
#include <utility>
#include <vector>

#include "check.hpp"
#include "zones/zone.hpp"
#include "zones/zone_buffer.hpp"

namespace {

using namespace tachk::zones;

// Time is counted in sixths: enough to meet each region, and what lies between two valuations of thirds. With constants
// and steps as few as here no clock is compared with, or differs from another by, more than 5.
constexpr int parts = 6;
constexpr int largest = 1;
constexpr int farthest = 6 * parts;
constexpr int beyond_all = 8 * parts;
constexpr Raw unimportant = 100;

struct Pair {
  int n, first, second;  // the two clocks
  ZoneOperations ops;

  bool holds(ConstZoneRef zone, int x, int y) const {
    const int value[] = {0, x, y};
    const int clock[] = {0, first, second};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const Raw raw = ops.entry(zone, n, clock[i], clock[j]);
        if (raw == unbounded_entry) continue;
        const Raw limit = raw_value(raw) * parts;
        if (value[i] - value[j] > limit || (value[i] - value[j] == limit && (raw & 1) == 0)) return false;
      }
    return true;
  }
};

bool stands_for(int w, int v, Raw lower, Raw upper) {
  const auto beyond = [](Raw bound, int time) { return bound == not_compared || time > bound * parts; };
  return w == v || (w < v && beyond(lower, w)) || (w > v && beyond(upper, v));
}

bool by_definition(const Pair& pair, ConstZoneRef outer, ConstZoneRef inner, const Raw (&lower)[2],
                   const Raw (&upper)[2]) {
  std::vector<std::pair<int, int>> others;
  for (int a = 0; a <= beyond_all; ++a)
    for (int b = 0; b <= beyond_all; ++b)
      if (pair.holds(outer, a, b)) others.emplace_back(a, b);
  for (int x = 0; x <= farthest; x += 2)
    for (int y = 0; y <= farthest; y += 2) {
      if (!pair.holds(inner, x, y)) continue;
      const bool found = std::any_of(others.begin(), others.end(), [&](const std::pair<int, int>& other) {
        return stands_for(other.first, x, lower[0], upper[0]) && stands_for(other.second, y, lower[1], upper[1]);
      });
      if (!found) return false;
    }
  return true;
}

ZoneBuffer random_zone(const Pair& pair, std::mt19937& random) {
  ZoneBuffer zone(pair.ops);
  pair.ops.make_zero(zone.get(), pair.n);
  BoundRowBuffer kept(pair.ops, pair.n);
  for (const int clock : {pair.first, pair.second}) pair.ops.set_bound(kept.get(), clock, unimportant);
  const auto clock = [&] { return static_cast<std::uint16_t>(random() % 2 == 0 ? pair.first : pair.second); };
  for (unsigned step = 0; step < 2 + random() % 3; ++step) {
    pair.ops.up(zone.get(), pair.n, nullptr);
    const Raw value = static_cast<Raw>(random() % (largest + 1));
    const std::uint16_t compared = clock();
    const bool strict = random() % 2 == 0;
    const Atom atom =
        random() % 2 == 0 ? Atom{compared, 0, raw_bound(value, strict)} : Atom{0, compared, raw_bound(-value, strict)};
    if (pair.ops.meets_each(zone.get(), pair.n, &atom, 1)) pair.ops.intersect(zone.get(), pair.n, &atom, 1);
    const ClockReset reset{clock(), 0};
    if (random() % 2 == 0) pair.ops.reset(zone.get(), pair.n, &reset, 1);
  }
  pair.ops.extrapolate_lu_plus(zone.get(), pair.n, kept.get(), kept.get());
  return zone;
}

void check(int n, int first, int second, Width width, bool vector, int count, int& simulated, int& included) {
  const Pair pair{n, first, second, select_operations(n, width, vector)};
  std::mt19937 random(static_cast<unsigned>(n + 7 * static_cast<int>(width)));
  for (int round = 0; round < count; ++round) {
    Raw lower[2];
    Raw upper[2];
    BoundRowBuffer lower_row(pair.ops, n);
    BoundRowBuffer upper_row(pair.ops, n);
    for (int c = 0; c < 2; ++c) {
      lower[c] = static_cast<Raw>(random() % (largest + 2)) - 1;
      upper[c] = static_cast<Raw>(random() % (largest + 2)) - 1;
      pair.ops.set_bound(lower_row.get(), c == 0 ? first : second, lower[c]);
      pair.ops.set_bound(upper_row.get(), c == 0 ? first : second, upper[c]);
    }
    const ZoneBuffer outer = random_zone(pair, random);
    const ZoneBuffer inner = random_zone(pair, random);
    const bool expected = by_definition(pair, outer.get(), inner.get(), lower, upper);
    CHECK(pair.ops.simulates(outer.get(), inner.get(), n, {lower_row.get(), upper_row.get()}) == expected);
    simulated += expected ? 1 : 0;
    included += pair.ops.includes(outer.get(), inner.get(), n) ? 1 : 0;
  }
}

}  // namespace

int main() {
  int simulated = 0;
  int included = 0;
  check(3, 1, 2, Width::narrow, true, 300, simulated, included);
  check(3, 2, 1, Width::widest, false, 100, simulated, included);
  check(20, 4, 17, Width::narrow, true, 100, simulated, included);
  check(20, 17, 4, Width::wide, false, 100, simulated, included);
  check(70, 5, 66, Width::narrow, true, 100, simulated, included);
  CHECK(included > 20 && simulated > 2 * included && simulated < 600);
  std::puts("simulation between zones is what its definition says");
}
