// Zones held whole and by their rows, against a plain list.
#include "states/zone_store.hpp"

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <random>
#include <utility>
#include <vector>

#include "check.hpp"
#include "zones/zone_buffer.hpp"

namespace {

using namespace tachk::states;
using namespace tachk::states::rows;
using namespace tachk::zones;

struct Random {
  std::mt19937 engine;

  int below(int limit) { return static_cast<int>(engine() % static_cast<std::uint32_t>(limit)); }
};

// A zone with bounds below `range` for some of its clocks.
void draw(Random& random, const ZoneOperations& operations, int dimension, int range, int rounds, ZoneRef zone) {
  operations.make_zero(zone, dimension);
  for (int round = 0; round < rounds; ++round) {
    operations.up(zone, dimension, nullptr);
    const auto clock = static_cast<std::uint16_t>(1 + random.below(dimension - 1));
    const int least = random.below(range);
    for (const Atom& atom : {Atom{0, clock, raw_bound(-least, false)}, Atom{clock, 0, raw_bound(least + 5, true)}})
      if (operations.meets_each(zone, dimension, &atom, 1)) CHECK(operations.intersect(zone, dimension, &atom, 1));
    const ClockReset reset{static_cast<std::uint16_t>(1 + random.below(dimension - 1)), 0};
    operations.reset(zone, dimension, &reset, 1);
  }
}

struct Held {
  std::uint32_t number;
  ZoneBuffer zone;
  int dimension;
};

bool same(const ZoneOperations& operations, ConstZoneRef a, ConstZoneRef b) {
  return std::memcmp(a.bytes, b.bytes, operations.bytes) == 0;
}

// Each answer about a zone that is held is that of the operations on the zone itself.
void check_answers(const ZoneStore& store, const Held& held, const Held& other, const ZoneOperations& operations) {
  BoundRowBuffer lower(operations, held.dimension);
  BoundRowBuffer upper(operations, held.dimension);
  for (int clock = 1; clock < held.dimension; ++clock) {
    operations.set_bound(lower.get(), clock, clock % 3 == 0 ? not_compared : 20);
    operations.set_bound(upper.get(), clock, clock % 2 == 0 ? not_compared : 10);
  }
  const ClockBounds bounds{lower.get(), upper.get()};
  const ConstZoneRef mine = held.zone.get();
  const ConstZoneRef theirs = other.zone.get();
  const int n = held.dimension;
  ZoneBuffer buffer(operations);
  CHECK(store.read(held.number, buffer.get()).dimension == n);
  CHECK(same(operations, store.read(held.number, buffer.get()).data, mine));
  CHECK(store.equals(held.number, {mine, n}));
  CHECK(store.equals(held.number, {theirs, n}) == same(operations, mine, theirs));
  CHECK(store.covers(held.number, {theirs, n}) == operations.includes(mine, theirs, n));
  CHECK(store.is_covered(held.number, {theirs, n}) == operations.includes(theirs, mine, n));
  CHECK(store.covers(held.number, {theirs, n}, &bounds) == operations.simulates(mine, theirs, n, bounds));
  CHECK(store.is_covered(held.number, {theirs, n}, &bounds) == operations.simulates(theirs, mine, n, bounds));
}

// Zones of some dimensions come, with the same ones again among them, and go.
void test_zones_come_and_go(const std::vector<int>& dimensions, Width width, bool vector, std::uint32_t rows_after,
                            std::uint32_t reduced_after = UINT32_MAX) {
  Random random{std::mt19937(rows_after)};
  const int largest = dimensions.back();
  std::vector<ZoneOperations> smaller;
  for (int n = 0; dimensions.size() > 1 && n < largest; ++n) smaller.push_back(select_operations(n, width, vector));
  const ZoneOperations whole = select_operations(largest, width, vector);
  ZoneStore store(whole, largest, smaller, {rows_after, reduced_after});
  std::vector<Held> all;
  ZoneBuffer zone(whole);
  for (int step = 0; step < 1500; ++step) {
    const int n = dimensions[static_cast<std::size_t>(random.below(static_cast<int>(dimensions.size())))];
    const ZoneOperations& operations = store.operations(n);
    draw(random, operations, n, 1 + step / 10, 3, zone.get());
    all.push_back({store.intern({zone.get(), n}), ZoneBuffer(operations), n});
    all.back().zone.assign(zone.get());
    for (int count = 0; count < 3; ++count) {
      const Held& held = all[static_cast<std::size_t>(random.below(static_cast<int>(all.size())))];
      if (held.dimension == n) check_answers(store, held, all.back(), operations);
    }
    if (random.below(3) != 0) continue;
    const auto place = static_cast<std::size_t>(random.below(static_cast<int>(all.size())));
    store.release(all[place].number);
    std::swap(all[place], all.back());
    all.pop_back();
  }
  for (const Held& held : all)
    for (const Held& other : {all.front(), all.back()})
      CHECK(other.dimension != held.dimension ||
            (held.number == other.number) == same(store.operations(held.dimension), held.zone.get(), other.zone.get()));
}

// Rows are held once each where zones have few different ones, and no longer once they have many.
void test_the_way_that_takes_less_memory() {
  constexpr int dimension = 6;
  const ZoneOperations operations = select_operations(dimension, Width::wide, true);
  ZonesOfDimension zones(operations, dimension, {64, UINT32_MAX}, std::size_t{1} << 10);
  Random random{std::mt19937(1)};
  ZoneBuffer zone(operations);
  ZoneBuffer buffer(operations);
  std::vector<ZoneBuffer> all;
  const auto add = [&](int range, int rounds) {
    draw(random, operations, dimension, range, rounds, zone.get());
    CHECK(zones.add(zone.get()) == all.size());
    all.push_back(zone);
  };
  const auto check_all = [&] {
    for (std::uint32_t record = 0; record < all.size(); ++record)
      CHECK(same(operations, zones.read(record, buffer.get()), all[record].get()));
  };
  while (all.size() < 65) add(2, 2);
  CHECK(zones.by_rows());
  check_all();
  while (all.size() < 1025) add(1 << 20, 2 * dimension);
  CHECK(!zones.by_rows());
  check_all();
  const std::size_t whole = zones.bytes();
  while (all.size() < 4097) add(3, 2);
  CHECK(zones.by_rows());
  CHECK(zones.bytes() < 2 * whole);
  check_all();
}

// Rows are given back with the zones that have them.
void test_rows_are_given_back() {
  RowStore rows(16);
  std::vector<std::uint32_t> numbers;
  for (std::uint64_t round = 0; round < 3; ++round) {
    for (std::uint64_t n = 0; n < 5000; ++n) {
      const std::uint64_t row[] = {n / 2, round};
      rows.intern(reinterpret_cast<const std::byte*>(row), 1, &numbers.emplace_back());
    }
    CHECK(rows.size() == 2500);
    const std::size_t bytes = rows.bytes();
    for (std::size_t n = 0; n < 4000; ++n) rows.release(numbers[n]);
    CHECK(rows.size() == 500);
    for (std::size_t n = 4000; n < 5000; ++n) rows.release(numbers[n]);
    CHECK(rows.size() == 0);
    CHECK(rows.bytes() < bytes + 50000);
    numbers.clear();
  }
}

void test_a_zone_that_goes_gives_its_rows_back() {
  constexpr int dimension = 6;
  const ZoneOperations operations = select_operations(dimension, Width::wide, true);
  ZonesOfDimension zones(operations, dimension, {0, UINT32_MAX}, std::size_t{1} << 10);
  Random random{std::mt19937(1)};
  ZoneBuffer zone(operations);
  std::size_t bytes = 0;
  for (int round = 0; round < 5000; ++round) {
    draw(random, operations, dimension, 1 << 20, 2 * dimension, zone.get());
    zones.remove(zones.add(zone.get()));
    if (round == 0) bytes = zones.bytes();
  }
  CHECK(zones.bytes() < 2 * bytes);
}

// Zones are held in reduced form where that takes at most half the memory of their rows, and records are used again.
void test_reduced_form_where_it_is_small() {
  constexpr int dimension = 12;
  const ZoneOperations operations = select_operations(dimension, Width::wide, true);
  for (const bool alike : {false, true}) {
    ZonesOfDimension zones(operations, dimension, {64, 64}, std::size_t{1} << 10);
    ZonesOfDimension by_rows(operations, dimension, {64, UINT32_MAX}, std::size_t{1} << 10);
    Random random{std::mt19937(1)};
    ZoneBuffer zone(operations);
    ZoneBuffer buffer(operations);
    const auto draw_next = [&](std::uint32_t record) {
      if (alike) random.engine.seed(record % 16);
      draw(random, operations, dimension, 1 << 20, alike ? 4 * dimension : 6, zone.get());
    };
    for (std::uint32_t record = 0; record < 4000; ++record) {
      draw_next(record);
      CHECK(zones.add(zone.get()) == record);
      CHECK(by_rows.add(zone.get()) == record);
      CHECK(same(operations, zones.read(record, buffer.get()), zone.get()));
    }
    CHECK(zones.in_reduced_form() == !alike);
    CHECK(alike || 2 * zones.bytes() < by_rows.bytes());
    const std::size_t bytes = zones.bytes();
    for (std::uint32_t record = 0; record < 4000; ++record) zones.remove(record);
    for (std::uint32_t record = 0; record < 4000; ++record) {
      draw_next(record);
      CHECK(same(operations, zones.read(zones.add(zone.get()), buffer.get()), zone.get()));
    }
    CHECK(zones.bytes() < bytes + bytes / 2);
  }
}

}  // namespace

int main() {
  test_reduced_form_where_it_is_small();
  for (const std::uint32_t reduced_after : {0u, 64u}) {
    test_zones_come_and_go({18, 25}, Width::narrow, true, UINT32_MAX, reduced_after);
    test_zones_come_and_go({12}, Width::wide, true, 0, reduced_after);
    test_zones_come_and_go({11}, Width::wide, false, UINT32_MAX, reduced_after);
  }
  for (const std::uint32_t rows_after : {0u, 1u, 64u, UINT32_MAX}) {
    test_zones_come_and_go({4}, Width::narrow, true, rows_after);
    test_zones_come_and_go({7}, Width::wide, false, rows_after);
    test_zones_come_and_go({2, 5, 9, 17}, Width::narrow, true, rows_after);
    test_zones_come_and_go({3, 4}, Width::widest, true, rows_after);
  }
  test_the_way_that_takes_less_memory();
  test_rows_are_given_back();
  test_a_zone_that_goes_gives_its_rows_back();
  std::puts("zones are what they were when they were stored");
}
