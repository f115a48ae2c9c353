// The union of zones of three clocks, among others that nothing compares, against its definition, valuation by
// valuation.
#include <cstdint>
#include <cstdio>
#include <initializer_list>
#include <random>

#include "check.hpp"
#include "zones/zone.hpp"
#include "zones/zone_buffer.hpp"

namespace {

using namespace tachk::zones;

// Time is counted in quarters: three clocks, each region has a valuation among them.
constexpr int parts = 4;
constexpr int largest = 2;
constexpr Raw unimportant = 100;
constexpr int farthest = (largest + 1) * parts;

struct Three {
  int n;
  int clocks[3];
  ZoneOperations ops;

  bool holds(ConstZoneRef zone, const int (&value)[4]) const {
    const int clock[] = {0, clocks[0], clocks[1], clocks[2]};
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        const Raw raw = ops.entry(zone, n, clock[i], clock[j]);
        if (raw == unbounded_entry) continue;
        const Raw limit = raw_value(raw) * parts;
        if (value[i] - value[j] > limit || (value[i] - value[j] == limit && (raw & 1) == 0)) return false;
      }
    return true;
  }
};

Atom random_atom(const Three& three, std::mt19937& random) {
  const auto clock = [&] { return static_cast<std::uint16_t>(three.clocks[random() % 3]); };
  const std::uint16_t left = clock();
  const std::uint16_t other = clock();
  const std::uint16_t right = random() % 2 == 0 || other == left ? std::uint16_t{0} : other;
  const Atom atom{left, right, raw_bound(static_cast<Raw>(random() % (largest + 1)), random() % 2 == 0)};
  return random() % 2 == 0 ? atom : negated(atom);
}

void add(const Three& three, ZoneRef zone, Atom atom) {
  if (three.ops.meets_each(zone, three.n, &atom, 1)) three.ops.intersect(zone, three.n, &atom, 1);
}

// The values of the three clocks up to the largest constant, which decide all.
ZoneBuffer everything(const Three& three) {
  ZoneBuffer zone(three.ops);
  three.ops.make_zero(zone.get(), three.n);
  for (const int clock : three.clocks) {
    three.ops.up(zone.get(), three.n, nullptr);
    const ClockReset reset{static_cast<std::uint16_t>(clock), 0};
    three.ops.reset(zone.get(), three.n, &reset, 1);
  }
  three.ops.up(zone.get(), three.n, nullptr);
  for (const int clock : three.clocks)
    add(three, zone.get(), {static_cast<std::uint16_t>(clock), 0, raw_bound(largest, false)});
  return zone;
}

// The zone and some atoms, in which other clocks do not matter.
ZoneBuffer restricted(const Three& three, const ZoneBuffer& zone, std::initializer_list<Atom> atoms) {
  ZoneBuffer part(three.ops);
  part.assign(zone.get());
  for (const Atom& atom : atoms) add(three, part.get(), atom);
  BoundRowBuffer kept(three.ops, three.n);
  for (const int clock : three.clocks) three.ops.set_bound(kept.get(), clock, unimportant);
  three.ops.extrapolate_lu_plus(part.get(), three.n, kept.get(), kept.get());
  return part;
}

void check(const Three& three, int count, int& merged, int& apart) {
  std::mt19937 random(static_cast<unsigned>(three.n));
  for (int round = 0; round < count; ++round) {
    const auto atom = [&] { return random_atom(three, random); };
    const Atom border = atom();
    const Atom beyond = random() % 2 == 0 ? negated(border) : atom();
    const ZoneBuffer both = restricted(three, everything(three), {atom(), atom()});
    const ZoneBuffer mine = restricted(three, both, {border, atom()});
    const ZoneBuffer theirs = restricted(three, both, {beyond});
    ZoneBuffer result(three.ops);
    result.assign(mine.get());
    const bool grown = three.ops.convex_union(result.get(), theirs.get(), three.n);
    ZoneBuffer hull(three.ops);
    hull.assign(mine.get());
    three.ops.hull(hull.get(), theirs.get(), three.n);
    bool larger = false;
    bool convex = true;
    int value[4] = {};
    for (value[1] = 0; value[1] <= farthest; ++value[1])
      for (value[2] = 0; value[2] <= farthest; ++value[2])
        for (value[3] = 0; value[3] <= farthest; ++value[3]) {
          const bool of_mine = three.holds(mine.get(), value);
          const bool of_either = of_mine || three.holds(theirs.get(), value);
          larger |= of_either && !of_mine;
          convex &= of_either || !three.holds(hull.get(), value);
          CHECK(three.holds(result.get(), value) == (grown ? of_either : of_mine));
        }
    CHECK(grown == (larger && convex));
    (grown ? merged : apart) += larger ? 1 : 0;
  }
}

// One clock is small in one zone, and hardly smaller than an earlier one in the other: nothing bounds the hull.
void check_unbounded() {
  const Three three{4, {1, 2, 3}, select_operations(4, Width::narrow, true)};
  ZoneBuffer all(three.ops);
  three.ops.make_zero(all.get(), three.n);
  for (const int clock : three.clocks) {
    three.ops.up(all.get(), three.n, nullptr);
    const ClockReset reset{static_cast<std::uint16_t>(clock), 0};
    three.ops.reset(all.get(), three.n, &reset, 1);
  }
  three.ops.up(all.get(), three.n, nullptr);
  ZoneBuffer one(three.ops);
  ZoneBuffer other(three.ops);
  one.assign(all.get());
  other.assign(all.get());
  add(three, one.get(), {2, 0, raw_bound(1, false)});
  add(three, other.get(), {1, 2, raw_bound(1, false)});
  CHECK(!three.ops.convex_union(one.get(), other.get(), three.n));
}

}  // namespace

int main() {
  check_unbounded();
  int merged = 0;
  int apart = 0;
  check({4, {1, 2, 3}, select_operations(4, Width::narrow, true)}, 150, merged, apart);
  check({4, {3, 1, 2}, select_operations(4, Width::widest, false)}, 50, merged, apart);
  check({20, {4, 17, 9}, select_operations(20, Width::narrow, true)}, 50, merged, apart);
  check({70, {5, 66, 20}, select_operations(70, Width::wide, false)}, 50, merged, apart);
  CHECK(merged > 80 && apart > 20);
  std::puts("zones become one where their union is a zone");
}
