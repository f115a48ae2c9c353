// Long antichains against plain lists: the same answers, the same members removed.
#include "states/antichain.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <new>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "check.hpp"
#include "states/store.hpp"
#include "zones/zone_buffer.hpp"

namespace {

using namespace tachk::program;
using namespace tachk::states;
using namespace tachk::zones;

struct Random {
  std::mt19937 engine;

  int below(int limit) { return static_cast<int>(engine() % static_cast<std::uint32_t>(limit)); }
};

std::set<std::uint32_t> numbers(const Antichain& antichain) {
  std::set<std::uint32_t> result;
  antichain.for_each([&](std::uint32_t number) { CHECK(result.insert(number).second); });
  return result;
}

// Those that wait come in falling order; removed ones may be among them.
void check_waiting(const Antichain& antichain, const std::vector<std::pair<Extent, std::uint32_t>>& plain,
                   std::uint32_t first) {
  std::vector<std::uint32_t> visited;
  antichain.for_each_waiting(first, [&](std::uint32_t number) { visited.push_back(number); });
  CHECK(std::is_sorted(visited.rbegin(), visited.rend()));
  CHECK(visited.empty() || visited.back() >= first);
  const std::set<std::uint32_t> waiting(visited.begin(), visited.end());
  for (const auto& [extent, number] : plain) CHECK(number < first || waiting.contains(number));
}

// Random points near a plane, where few dominate others, of which some components vary; each third number takes no part
// in a comparison.
void test_extents(int components, int range, std::uint32_t steps) {
  Random random{std::mt19937(static_cast<std::uint32_t>(components))};
  std::vector<std::pair<Extent, std::uint32_t>> plain;
  std::vector<Extent> extents;
  const auto extent_of = [&](std::uint32_t number) { return extents[number]; };
  Antichain antichain;
  const std::size_t empty_bytes = antichain.bytes();
  std::size_t longest = 0;
  std::uint32_t first_waiting = 0;
  for (std::uint32_t step = 0; step < steps; ++step) {
    Extent extent{};
    int rest = random.below(range / 40 + 2);
    for (int k = 1; k < components; ++k) {
      const int sum = random.below(range) - range / 2;
      extent.sums[k] = static_cast<std::int16_t>(sum);
      rest -= sum;
    }
    extent.sums[0] = static_cast<std::int16_t>(rest);
    extents.push_back(extent);
    const auto takes_part = [](std::uint32_t number) { return number % 3 != 0; };
    const bool above = std::any_of(plain.begin(), plain.end(), [&](const auto& member) {
      return member.first.may_include(extent) && takes_part(member.second);
    });
    std::uint64_t examined = 0;
    const auto accept = [&](std::uint32_t number) { return takes_part(number) && extents[number].may_include(extent); };
    CHECK(antichain.any_above(extent, accept, examined) == above);
    if (above) continue;
    std::set<std::uint32_t> removed;
    antichain.remove_below(extent, [&](std::uint32_t number) {
      if (!takes_part(number) || !extent.may_include(extents[number])) return false;
      CHECK(removed.insert(number).second);
      return true;
    });
    const std::size_t before = plain.size();
    std::erase_if(plain, [&](const auto& member) {
      if (!extent.may_include(member.first) || !takes_part(member.second)) return false;
      CHECK(removed.contains(member.second));
      return true;
    });
    CHECK(before - plain.size() == removed.size());
    if (random.below(4) == 0) first_waiting += static_cast<std::uint32_t>(random.below(8));
    first_waiting = std::min(first_waiting, step);
    antichain.add(extent, step, first_waiting, extent_of);
    plain.push_back({extent, step});
    if (step % 16 == 0) check_waiting(antichain, plain, first_waiting);
    longest = std::max(longest, plain.size());
    CHECK(antichain.bytes() > empty_bytes + plain.size() * sizeof(ExtentCode));
    if (step % 500 != 0) continue;
    const std::set<std::uint32_t> present = numbers(antichain);
    CHECK(present.size() == plain.size());
    for (const auto& member : plain) CHECK(present.contains(member.second));
  }
  CHECK(longest > 500);
  Extent all{};
  std::fill_n(all.sums, Extent::count, INT16_MAX);
  antichain.remove_below(all, [](std::uint32_t) { return true; });
  CHECK(numbers(antichain).empty());
  antichain.add(all, 7, UINT32_MAX, extent_of);
  CHECK(numbers(antichain) == std::set<std::uint32_t>{7});
}

// Extents that arrive one by one in grids that become coarser: an extent lies in its cell, and none loses against one
// that it includes.
void test_grids(int range) {
  Random random{std::mt19937(static_cast<std::uint32_t>(range))};
  for (int round = 0; round < 200; ++round) {
    std::vector<Extent> extents;
    std::vector<ExtentCode> codes;
    Extent least{};
    Extent most{};
    ExtentGrid grid;
    for (int step = 0; step < 60; ++step) {
      Extent extent{};
      const int reach = 1 + range * (1 + random.below(step + 1)) / 60;
      for (std::int16_t& sum : extent.sums)
        sum = static_cast<std::int16_t>(std::clamp(random.below(2 * reach) - reach, INT16_MIN, INT16_MAX));
      if (!extents.empty() && random.below(2) == 0) {
        extent = extents[static_cast<std::size_t>(random.below(step))];
        std::int16_t& sum = extent.sums[random.below(Extent::count)];
        sum = static_cast<std::int16_t>(std::max(sum - random.below(3), INT16_MIN));
      }
      if (extents.empty()) least = most = extent;
      least.lower_to(extent);
      most.raise_to(extent);
      if (!grid.spans(least, most)) {
        const ExtentGrid wider(least, most, grid);
        if (!codes.empty()) {
          const ExtentGrid::Change change(grid, wider);
          for (ExtentCode& code : codes) code = change(code);
        }
        grid = wider;
        CHECK(grid.spans(least, most));
      }
      extents.push_back(extent);
      codes.push_back(grid.code(extent));
      for (std::size_t n = 0; n < extents.size(); ++n) {
        CHECK(extents[n].may_include(grid.least(codes[n])));
        CHECK(grid.most(codes[n]).may_include(extents[n]));
        CHECK(std::equal(codes[n].sums, codes[n].sums + Extent::count, grid.code(extents[n]).sums));
        if (extent.may_include(extents[n])) CHECK(codes.back().may_include(codes[n]));
        if (extents[n].may_include(extent)) CHECK(codes[n].may_include(codes.back()));
      }
    }
    CHECK(range > 50 || std::equal(extents[0].sums, extents[0].sums + Extent::count, grid.least(codes[0]).sums));
  }
}

// A box of about the same size as the others, mostly, somewhere within a range that grows, cut off along a diagonal.
void draw(Random& random, const ZoneOperations& operations, int dimension, int range, ZoneRef zone) {
  const BoundRowBuffer bounds(operations, dimension);
  std::vector<Atom> atoms;
  int size = range / (random.below(20) == 0 ? 1 : 4);
  for (int clock = 1; clock < dimension; ++clock) {
    const int width = clock + 1 == dimension ? size : random.below(size + 1);
    const int start = random.below(range);
    const auto c = static_cast<std::uint16_t>(clock);
    atoms.push_back({0, c, raw_bound(-start, random.below(2) == 0)});
    if (random.below(30) != 0) atoms.push_back({c, 0, raw_bound(start + width + 1, random.below(2) == 0)});
    size -= width;
  }
  if (dimension > 2 && random.below(2) == 0) atoms.push_back({1, 2, raw_bound(random.below(range), false)});
  do {
    operations.make_zero(zone, dimension);
    operations.up(zone, dimension, nullptr);
    operations.extrapolate_lu_plus(zone, dimension, bounds.get(), bounds.get());
    if (operations.intersect(zone, dimension, atoms.data(), atoms.size())) return;
    atoms.pop_back();
  } while (true);
}

void test_zones(int dimension, Width width, int range, std::uint32_t steps, bool subsumption, std::uint32_t rows_after,
                std::uint32_t reduced_after = UINT32_MAX) {
  Random random{std::mt19937(static_cast<std::uint32_t>(dimension + range))};
  Program program;
  program.clocks = dimension - 1;
  program.state_slots = 1;
  program.slots = {Slot{0, 1, 0, false}};
  const ZoneOperations operations = select_operations(dimension, width, true);
  PassedList passed(program, operations, {.rows_after = rows_after, .reduced_after = reduced_after});
  const std::int32_t slots[] = {0};
  passed.announce(slots, SlotSet::all());
  const std::uint32_t discrete = passed.locate();
  struct Member {
    std::uint32_t number;
    ZoneBuffer zone;  // a copy, for the moment when it has just been covered
  };
  std::vector<Member> plain;
  std::size_t longest = 0;
  int removals = 0;
  const auto includes = [&](ConstZoneRef outer, ConstZoneRef inner) {
    return subsumption ? operations.includes(outer, inner, dimension)
                       : std::memcmp(outer.bytes, inner.bytes, operations.bytes) == 0;
  };
  ZoneBuffer zone(operations);
  ZoneBuffer buffer(operations);
  for (std::uint32_t step = 0; step < steps; ++step) {
    const int reach = 4 + static_cast<int>(static_cast<std::uint32_t>(range) * step / steps);
    draw(random, operations, dimension, reach, zone.get());
    if (!plain.empty() && random.below(4) == 0) {
      // One that is likely to contain a stored zone, or to be contained.
      const int place = random.below(static_cast<int>(plain.size()));
      zone.assign(plain[static_cast<std::size_t>(place)].zone.get());
      const auto clock = static_cast<std::uint16_t>(1 + random.below(dimension - 1));
      const Atom atom{0, clock, raw_bound(-random.below(reach), false)};
      if (random.below(2) == 0)
        operations.up(zone.get(), dimension, nullptr);
      else if (operations.meets_each(zone.get(), dimension, &atom, 1))
        CHECK(operations.intersect(zone.get(), dimension, &atom, 1));
    }
    const bool covered = std::any_of(plain.begin(), plain.end(),
                                     [&](const Member& member) { return includes(member.zone.get(), zone.get()); });
    if (subsumption) CHECK(passed.covers(discrete, {zone.get(), dimension}) == covered);
    const std::uint32_t fresh = passed.add(discrete, {zone.get(), dimension}, no_node, subsumption);
    CHECK((fresh == no_node) == covered);
    if (covered) continue;
    std::erase_if(plain, [&](const Member& member) {
      const bool smaller = includes(zone.get(), member.zone.get());
      CHECK(passed.covered(member.number) == smaller);
      if (!smaller && (member.number + step) % 16 == 0)
        CHECK(std::memcmp(passed.zone(member.number, buffer).data.bytes, member.zone.get().bytes, operations.bytes) ==
              0);
      if (smaller) ++removals;
      return smaller;
    });
    plain.push_back({fresh, zone});
    longest = std::max(longest, plain.size());
    CHECK(passed.stored() == plain.size());
  }
  CHECK(longest > 100);
  CHECK(removals > (subsumption ? 50 : -1));
}

}  // namespace

int main() {
  for (const int range : {50, 1000, 32768}) test_grids(range);
  test_extents(2, 60000, 20000);
  test_extents(3, 50, 6000);
  test_extents(5, 100, 6000);
  test_extents(16, 1000, 4000);
  for (const int dimension : {3, 6, 8, 9, 17, 33}) {
    test_zones(dimension, Width::narrow, 390, 2500, true, 0);
    test_zones(dimension, Width::wide, 30000, 2500, true, 100);
    test_zones(dimension, Width::wide, 300, 1500, false, 1024);
  }
  test_zones(9, Width::narrow, 390, 2500, true, 0, 0);
  test_zones(9, Width::wide, 30000, 2500, true, 200, 20);
  test_zones(17, Width::wide, 300, 500, false, 1024, 0);
  std::puts("long antichains are those of a plain list");
}
