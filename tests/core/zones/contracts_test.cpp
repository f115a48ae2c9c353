// The contracts of the zone operations fire: on zones that are not canonical or empty, and on arguments out of range.
#include "zones/contract.hpp"

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "check.hpp"
#include "zones/zone.hpp"
#include "zones/zone_buffer.hpp"

namespace {

using namespace tachk::zones;

struct Broken {
  std::string condition;
};

[[noreturn]] void tell(const char* condition, const char*, int) { throw Broken{condition}; }

// The condition that is broken first; empty if none is.
template <class Body>
std::string broken_by(Body&& body) {
  try {
    body();
  } catch (const Broken& broken) {
    return broken.condition;
  }
  return "";
}

constexpr int dimension = 3;

// Entries of 16 bits, three clocks with the reference clock: 0 <= x, y and y - x <= 5 after some time.
struct Sample {
  ZoneOperations operations;
  ZoneBuffer buffer;
  ZoneRef zone;

  explicit Sample(bool vector)
      : operations(select_operations(dimension, Width::narrow, vector)), buffer(operations), zone(buffer.get()) {
    const Atom atoms[] = {{1, 0, raw_bound(5, false)}};
    const ClockReset reset{2, 0};
    operations.make_zero(zone, dimension);
    operations.up(zone, dimension, nullptr);
    CHECK(operations.intersect(zone, dimension, atoms, 1));
    operations.reset(zone, dimension, &reset, 1);
    operations.up(zone, dimension, nullptr);
  }
  void put(int i, int j, std::int16_t entry) {
    std::memcpy(zone.bytes + static_cast<std::size_t>(i * operations.stride + j) * sizeof entry, &entry, sizeof entry);
  }
};

// Every operation that changes a zone or sums one up, on a zone that is not canonical.
void check_operations(Sample& broken) {
  const ZoneOperations& ops = broken.operations;
  const ZoneRef zone = broken.zone;
  const BoundRowBuffer bounds(ops, dimension);
  ZoneBuffer part(ops);
  const std::uint16_t clocks[] = {0, 1, 2};
  const auto fires = [](auto&& body) { CHECK(broken_by(body).starts_with("canonical(")); };
  fires([&] { ops.intersect(zone, dimension, nullptr, 0); });
  fires([&] { ops.meets_each(zone, dimension, nullptr, 0); });
  fires([&] { ops.reset(zone, dimension, nullptr, 0); });
  fires([&] { ops.up(zone, dimension, nullptr); });
  fires([&] { ops.up_within(zone, dimension, nullptr, nullptr, 0); });
  fires([&] { ops.down(zone, dimension); });
  fires([&] { ops.extrapolate_lu_plus(zone, dimension, bounds.get(), bounds.get()); });
  fires([&] { ops.extrapolate_max(zone, dimension, bounds.get()); });
  fires([&] { ops.hash(zone, dimension); });
  fires([&] { ops.largest_entry(zone, dimension); });
  std::vector<Atom> atoms(dimension * dimension);
  fires([&] { ops.tighter(zone, zone, dimension, atoms.data()); });
  fires([&] { ops.gather(part.get(), zone, dimension, clocks, 3, ops.stride); });
  fires([&] { ops.scatter(part.get(), zone, dimension, clocks, 3, ops.stride); });
}

void test_broken_zones(bool vector) {
  Sample sound(vector);
  CHECK(broken_by([&] { sound.operations.down(sound.zone, dimension); }).empty());
  Sample loose(vector);  // the way through a third clock is shorter
  loose.put(1, 2, 100);
  loose.put(1, 0, 20);
  loose.put(0, 2, -199);
  check_operations(loose);
  Sample empty(vector);  // x < x
  empty.put(1, 1, 0);
  check_operations(empty);
  CHECK(broken_by([&] { sound.operations.includes(empty.zone, sound.zone, dimension); }) ==
        "like_a_zone(outer, dimension)");
  CHECK(broken_by([&] { sound.operations.includes(sound.zone, empty.zone, dimension); }) ==
        "like_a_zone(inner, dimension)");
  Sample cycle(vector);  // x - y <= -1 and y - x <= -1
  cycle.put(1, 2, -1);
  cycle.put(2, 1, -1);
  check_operations(cycle);
  Sample padding(vector);
  padding.put(0, dimension, 7);
  check_operations(padding);
  Sample huge(vector);
  huge.put(1, 0, BoundLimits<std::int16_t>::legal);
  check_operations(huge);
  Sample negative(vector);  // x may be less than 0
  negative.put(0, 1, 9);
  check_operations(negative);
}

void test_broken_arguments(bool vector) {
  const Sample sample(vector);
  const ZoneOperations& ops = sample.operations;
  const ZoneRef zone = sample.zone;
  ZoneBuffer part(ops);
  for (const Atom& atom : {Atom{3, 0, 1}, Atom{0, 3, 1}, Atom{1, 0, ops.legal}, Atom{1, 0, -ops.legal}})
    CHECK(broken_by([&] { ops.intersect(zone, dimension, &atom, 1); }) == "proper(atoms, count, dimension)");
  for (const ClockReset& reset :
       {ClockReset{0, 1}, ClockReset{3, 1}, ClockReset{1, -1}, ClockReset{1, 801}, ClockReset{1, 0, 3}})
    CHECK(broken_by([&] { ops.reset(zone, dimension, &reset, 1); }) == "proper(resets, count, dimension)");
  const Atom outside{1, 2, raw_bound(-1, false)};
  CHECK(broken_by([&] { ops.up_within(zone, dimension, nullptr, &outside, 1); }) ==
        "K::meets_each(zone, dimension, atoms, count)");
  const std::uint16_t backwards[] = {0, 2, 1};
  CHECK(broken_by([&] { ops.gather(part.get(), zone, dimension, backwards, 3, ops.stride); }) ==
        "proper(clocks, count, dimension)");
  BoundRowBuffer bounds(ops, dimension);
  CHECK(broken_by([&] { ops.maximise_bounds(bounds.get(), nullptr, 0, dimension); }) == "count > 0");
  CHECK(broken_by([&] { ops.entry(zone, dimension, 3, 0); }).starts_with("i >= 0"));
  for (const auto& [clock, value] : {std::pair{0, Raw{4}}, {1, Raw{801}}, {2, Raw{-2}}, {dimension, not_compared}}) {
    BoundRowBuffer wrong(ops, dimension);
    ops.set_bound(wrong.get(), clock, value);
    CHECK(broken_by([&] { ops.extrapolate_max(zone, dimension, wrong.get()); }) == "proper(bound, dimension)");
  }
}

}  // namespace

int main() {
#ifdef TACHK_CONTRACTS
  on_broken_contract = tell;
  for (const bool vector : {false, true}) {
    test_broken_zones(vector);
    test_broken_arguments(vector);
  }
  std::puts("broken contracts are reported");
#else
  std::puts("built without contracts");
#endif
}
