// Every zone operation of every kernel against a textbook matrix, on random walks through zones.
#include "zones/zone.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <numeric>
#include <random>
#include <vector>

#include "check.hpp"
#include "zones/reduced.hpp"
#include "zones/zone_buffer.hpp"

namespace {

using tachk::zones::Atom;
using tachk::zones::ClockReset;
using tachk::zones::Raw;
using tachk::zones::ZoneOperations;

constexpr std::int64_t infinity = INT64_MAX;

std::int64_t add(std::int64_t a, std::int64_t b) {
  return a == infinity || b == infinity ? infinity : a + b - ((a | b) & 1);
}

// A difference bound matrix with none of the tricks.
struct Matrix {
  int n;
  std::vector<std::int64_t> entries;

  explicit Matrix(int dimension) : n(dimension), entries(static_cast<std::size_t>(n * n), 1) {}
  std::int64_t& at(int i, int j) { return entries[static_cast<std::size_t>(i * n + j)]; }
  std::int64_t at(int i, int j) const { return entries[static_cast<std::size_t>(i * n + j)]; }

  bool close() {
    for (int k = 0; k < n; ++k)
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) at(i, j) = std::min(at(i, j), add(at(i, k), at(k, j)));
        if (at(i, i) < 1) return false;
      }
    return true;
  }
  bool intersect(const std::vector<Atom>& atoms) {
    for (const Atom& a : atoms) at(a.left, a.right) = std::min(at(a.left, a.right), std::int64_t{a.raw});
    return close();
  }
  // Every clock is a clock of before and so much more: x_i - x_j of now is a difference of before.
  void reset(const ClockReset& r) {
    const Matrix before(*this);
    const auto source = [&](int i) { return i == r.clock ? int{r.source} : i; };
    const auto more = [&](int i) { return i == r.clock ? Raw{r.value} : 0; };
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        if (i != j) at(i, j) = add(before.at(source(i), source(j)), tachk::zones::raw_bound(more(i) - more(j), false));
  }
  void up(const std::vector<std::uint8_t>& stopped) {
    for (int i = 1; i < n; ++i) {
      if (stopped[static_cast<std::size_t>(i)] != 0) continue;
      at(i, 0) = infinity;
      for (int j = 1; j < n; ++j)
        if (stopped[static_cast<std::size_t>(j)] != 0) at(i, j) = infinity;
    }
    CHECK(close());
  }
  void down() {
    for (int j = 1; j < n; ++j) at(0, j) = 1;
    CHECK(close());
  }
  bool includes(const Matrix& inner) const {
    for (std::size_t k = 0; k < entries.size(); ++k)
      if (inner.entries[k] > entries[k]) return false;
    return true;
  }
  std::int64_t largest_entry() const {
    std::int64_t largest = 0;
    for (const std::int64_t entry : entries)
      if (entry != infinity) largest = std::max(largest, std::abs(entry));
    return largest;
  }
  static std::int64_t value(std::int64_t raw) { return raw >> 1; }
  // Definition 7 of the paper, entry by entry from the old matrix.
  void extrapolate_lu_plus(const std::vector<Raw>& lower, const std::vector<Raw>& upper) {
    const Matrix old = *this;
    const auto l = [&](int i) { return i == 0 ? 0 : lower[static_cast<std::size_t>(i)]; };
    const auto u = [&](int i) { return i == 0 ? 0 : upper[static_cast<std::size_t>(i)]; };
    const auto above = [&](int i, Raw bound) { return bound < 0 ? i != 0 : -value(old.at(0, i)) > bound; };
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        if (i == j) continue;
        const std::int64_t c = old.at(i, j);
        if (i != 0 && c != infinity && value(c) > l(i)) at(i, j) = infinity;
        if (i != 0 && above(i, l(i))) at(i, j) = infinity;
        if (above(j, u(j))) at(i, j) = i != 0 ? infinity : u(j) < 0 ? 1 : std::min<std::int64_t>(-2 * u(j), 1);
      }
    CHECK(close());
  }
  void extrapolate_max(const std::vector<Raw>& bound) {
    const Matrix old = *this;
    const auto m = [&](int i) { return i == 0 ? 0 : bound[static_cast<std::size_t>(i)]; };
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const std::int64_t c = old.at(i, j);
        if (i == j || c == infinity) continue;
        if (value(c) > m(i))
          at(i, j) = infinity;
        else if (j != 0 && (m(j) < 0 || value(c) < -m(j)))
          at(i, j) = std::max(c, std::min<std::int64_t>(-2 * m(j), 1));
      }
    CHECK(close());
  }
};

struct Zone {
  ZoneOperations ops;
  int n;
  tachk::zones::ZoneRef data;

  Zone(const ZoneOperations& operations, int dimension)
      : ops(operations), n(dimension), data{new (std::align_val_t{64}) std::byte[operations.bytes]} {
    ops.make_zero(data, n);
  }
  Zone(const Zone& other) : Zone(other.ops, other.n) { std::copy_n(other.data.bytes, ops.bytes, data.bytes); }
  Zone& operator=(const Zone& other) {
    std::copy_n(other.data.bytes, ops.bytes, data.bytes);
    return *this;
  }
  ~Zone() { ::operator delete[](data.bytes, std::align_val_t{64}); }

  bool equals(const Matrix& m) const {
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const Raw raw = ops.entry(data, n, i, j);
        if ((raw == tachk::zones::unbounded_entry ? infinity : std::int64_t{raw}) != m.at(i, j)) return false;
      }
    return true;
  }
};

tachk::zones::BoundRowBuffer bound_row(const ZoneOperations& ops, int n, const std::vector<Raw>& bounds) {
  tachk::zones::BoundRowBuffer row(ops, n);
  for (int c = 1; c < n; ++c) ops.set_bound(row.get(), c, bounds[static_cast<std::size_t>(c)]);
  return row;
}

// A part of the clocks has their entries; the zone with this part has no others but those that follow.
void check_parts(const Zone& zone, tachk::zones::Width width, bool vector, std::uint32_t chosen) {
  std::vector<std::uint16_t> clocks{0};
  for (int c = 1; c < zone.n; ++c)
    if ((chosen >> (c % 32) & 1) != 0) clocks.push_back(static_cast<std::uint16_t>(c));
  const auto count = static_cast<int>(clocks.size());
  const Zone part(tachk::zones::select_operations(count, width, vector), count);
  zone.ops.gather(part.data, zone.data, zone.n, clocks.data(), count, part.ops.stride);
  const auto place = [&](int clock) {
    return static_cast<int>(std::find(clocks.begin(), clocks.end(), clock) - clocks.begin());
  };
  const Zone whole(zone.ops, zone.n);
  zone.ops.scatter(whole.data, part.data, zone.n, clocks.data(), count, part.ops.stride);
  for (int i = 0; i < zone.n; ++i)
    for (int j = 0; j < zone.n; ++j) {
      const int row = place(i);
      const int column = place(j);
      const Raw entry = zone.ops.entry(whole.data, zone.n, i, j);
      if (row == count) CHECK(entry == (i == j ? 1 : tachk::zones::unbounded_entry));
      if (row == count) continue;
      CHECK(entry == zone.ops.entry(zone.data, zone.n, i, column == count ? 0 : j));
      if (column != count) CHECK(entry == part.ops.entry(part.data, count, row, column));
    }
  for (int i = 0; i < count; ++i)  // the padding counts in comparisons of bytes
    for (int j = count; j < part.ops.stride; ++j)
      CHECK(part.ops.entry(part.data, count, i, j) == tachk::zones::unbounded_entry);
}

// The constraints that are tighter than those of another zone: what they leave of it is what both have in common.
void check_tighter(const Zone& zone, const Matrix& matrix, const Zone& other, const Matrix& other_matrix) {
  std::vector<Atom> atoms(static_cast<std::size_t>(zone.n * zone.n));
  atoms.resize(zone.ops.tighter(zone.data, other.data, zone.n, atoms.data()));
  std::size_t expected = 0;
  for (int i = 0; i < zone.n; ++i)
    for (int j = 0; j < zone.n; ++j) expected += matrix.at(i, j) < other_matrix.at(i, j) ? 1 : 0;
  CHECK(atoms.size() == expected);
  CHECK(std::ranges::is_partitioned(atoms, [](const Atom& atom) { return atom.right == 0; }));
  for (const Atom& atom : atoms) {
    CHECK(std::int64_t{atom.raw} == matrix.at(atom.left, atom.right));
    CHECK(std::int64_t{atom.raw} < other_matrix.at(atom.left, atom.right));
  }
}

// Clocks in another order: any, and all moved on by some, as the processes of a ring are.
void check_order(const Zone& zone, int moved, std::mt19937& random) {
  std::vector<std::uint16_t> sources(static_cast<std::size_t>(zone.n));
  std::iota(sources.begin(), sources.end(), std::uint16_t{0});
  for (const bool any : {false, true}) {
    if (any)
      std::shuffle(sources.begin() + 1, sources.end(), random);
    else
      std::rotate(sources.begin() + 1, sources.begin() + 1 + moved, sources.end());
    const Zone other(zone.ops, zone.n);
    zone.ops.rename(other.data, zone.data, zone.n, sources.data());
    for (int i = 0; i < zone.n; ++i)
      for (int j = 0; j < zone.ops.stride; ++j) {
        const bool of_clock = j < zone.n;
        const int source = of_clock ? sources[static_cast<std::size_t>(j)] : j;
        const int row = of_clock ? sources[static_cast<std::size_t>(i)] : i;
        CHECK(zone.ops.entry(other.data, zone.n, i, j) == zone.ops.entry(zone.data, zone.n, row, source));
      }
  }
}

// A zone in reduced form is the zone, and what is said of it at once is true.
void check_reduced(const Zone& zone, const Zone& other, std::mt19937& random, Raw constant) {
  const tachk::zones::ZoneReductions& reductions = zone.ops.reductions;
  if (reductions.most_bytes == 0) return;
  const int n = zone.n;
  std::vector<std::byte> record(reductions.most_bytes);
  CHECK(reductions.reduce(record.data(), zone.data, n) ==
        tachk::zones::ReducedHeader::of(record.data()).record_bytes());
  const Zone restored(other);
  reductions.restore(restored.data, record.data(), n);
  CHECK(std::equal(zone.data.bytes, zone.data.bytes + zone.ops.bytes, restored.data.bytes));
  CHECK(reductions.include(record.data(), other.data, n) == zone.ops.includes(zone.data, other.data, n));
  if (zone.ops.includes(other.data, zone.data, n)) CHECK(reductions.may_lie_in(record.data(), other.data, n));
  std::vector<Raw> lower(static_cast<std::size_t>(n), -1);
  std::vector<Raw> upper(static_cast<std::size_t>(n), -1);
  for (std::size_t c = 1; c < static_cast<std::size_t>(n); ++c) {
    lower[c] = static_cast<Raw>(random()) % (constant + 2) - 1;
    upper[c] = static_cast<Raw>(random()) % (constant + 2) - 1;
  }
  const tachk::zones::BoundRowBuffer l = bound_row(zone.ops, n, lower);
  const tachk::zones::BoundRowBuffer u = bound_row(zone.ops, n, upper);
  const tachk::zones::ClockBounds bounds{l.get(), u.get()};
  if (zone.ops.simulates(zone.data, other.data, n, bounds))
    CHECK(reductions.may_simulate(record.data(), other.data, n, bounds));
  if (zone.ops.simulates(other.data, zone.data, n, bounds))
    CHECK(reductions.may_be_simulated(record.data(), other.data, n, bounds));
}

void walk(int n, tachk::zones::Width width, bool vector, std::uint32_t seed, int steps, Raw constant) {
  std::mt19937 random(seed);
  const auto below = [&](Raw limit) { return static_cast<int>(static_cast<Raw>(random()) % limit); };
  const ZoneOperations ops = tachk::zones::select_operations(n, width, vector);
  // Sums are right also where entries are cut off.
  const Raw limit = seed % 2 == 0 ? 2 * constant : constant / 3;
  const tachk::zones::ExtentScale scale = tachk::zones::choose_scale(ops, n, limit);
  Zone zone(ops, n);
  Matrix matrix(n);
  Zone other_zone(zone);
  Matrix other_matrix(matrix);
  for (int step = 0; step < steps; ++step) {
    const auto clock = [&] { return n == 1 ? 0 : 1 + below(n - 1); };
    switch (n == 1 ? 0 : below(8)) {
      case 0: {
        std::vector<Atom> atoms;
        for (int k = below(3); k >= 0; --k) {
          const int i = below(n);
          const int j = below(n);
          if (i == j) continue;
          const int c = (below(2) == 0 ? 1 : -1) * below(constant + 1);
          atoms.push_back({static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j),
                           tachk::zones::raw_bound(c, below(2) == 0)});
        }
        Matrix trial(matrix);
        Zone fast(zone);
        const bool some = trial.intersect(atoms);
        if (!ops.meets_each(zone.data, n, atoms.data(), atoms.size())) CHECK(!some);
        CHECK(ops.intersect(fast.data, n, atoms.data(), atoms.size()) == some);
        if (some) {
          matrix = trial;
          zone = fast;
        }
        break;
      }
      case 1: {
        ClockReset r{static_cast<std::uint16_t>(clock()), below(constant + 1)};
        if (below(2) == 0) r = {r.clock, below(constant / 4 + 1), static_cast<std::uint16_t>(clock())};
        ops.reset(zone.data, n, &r, 1);
        matrix.reset(r);
        break;
      }
      case 2:
      case 3: {
        std::vector<std::uint8_t> stopped(static_cast<std::size_t>(n), 0);
        const bool some = below(4) == 0;
        if (some)
          for (int c = 1; c < n; ++c) stopped[static_cast<std::size_t>(c)] = static_cast<std::uint8_t>(below(2));
        // An invariant that the zone satisfies already somewhere: its own upper bounds, made a little looser.
        std::vector<Atom> invariant;
        for (int c = 1; c < n; ++c) {
          if (below(3) != 0) continue;
          const Raw least = -tachk::zones::raw_value(ops.entry(zone.data, n, 0, c));
          const Raw bound = std::min(constant, least + 1 + below(4));
          if (bound > least)
            invariant.push_back({static_cast<std::uint16_t>(c), 0, tachk::zones::raw_bound(bound, below(2) == 0)});
        }
        if (n > 2 && below(4) == 0) {
          const auto c = static_cast<std::uint16_t>(clock());
          const auto d = static_cast<std::uint16_t>(clock());
          if (c != d) invariant.push_back({c, d, tachk::zones::raw_bound(below(3), below(2) == 0)});
        }
        Matrix before(matrix);
        if (!before.intersect(invariant)) invariant.clear();
        if (!invariant.empty()) CHECK(ops.intersect(zone.data, n, invariant.data(), invariant.size()));
        matrix.intersect(invariant);
        Zone within(zone);
        ops.up(zone.data, n, some ? stopped.data() : nullptr);
        ops.intersect(zone.data, n, invariant.data(), invariant.size());
        ops.up_within(within.data, n, some ? stopped.data() : nullptr, invariant.data(), invariant.size());
        CHECK(std::equal(zone.data.bytes, zone.data.bytes + ops.bytes, within.data.bytes));
        matrix.up(stopped);
        matrix.intersect(invariant);
        break;
      }
      case 4:
        if (below(4) == 0) {
          ops.down(zone.data, n);
          matrix.down();
        }
        break;
      case 5: {
        std::vector<Raw> lower(static_cast<std::size_t>(n), -1);
        std::vector<Raw> upper(static_cast<std::size_t>(n), -1);
        for (std::size_t c = 1; c < static_cast<std::size_t>(n); ++c) {
          lower[c] = below(constant + 2) - 1;
          upper[c] = below(constant + 2) - 1;
        }
        const tachk::zones::BoundRowBuffer l = bound_row(ops, n, lower);
        const tachk::zones::BoundRowBuffer u = bound_row(ops, n, upper);
        ops.extrapolate_lu_plus(zone.data, n, l.get(), u.get());
        matrix.extrapolate_lu_plus(lower, upper);
        break;
      }
      case 6: {
        std::vector<Raw> bound(static_cast<std::size_t>(n), static_cast<Raw>(below(constant + 1)));
        for (std::size_t c = 1; c < static_cast<std::size_t>(n); ++c) bound[c] = below(constant + 2) - 1;
        const tachk::zones::BoundRowBuffer b = bound_row(ops, n, bound);
        const Zone before(zone);
        ops.extrapolate_max(zone.data, n, b.get());
        matrix.extrapolate_max(bound);
        CHECK(ops.includes(zone.data, before.data, n));
        break;
      }
      default:
        other_zone = zone;
        other_matrix = matrix;
        break;
    }
    CHECK(zone.equals(matrix));
    CHECK(ops.includes(zone.data, other_zone.data, n) == matrix.includes(other_matrix));
    CHECK(ops.includes(other_zone.data, zone.data, n) == other_matrix.includes(matrix));
    const tachk::zones::Extent extent = ops.extent(zone.data, n, scale);
    const tachk::zones::Extent other_extent = ops.extent(other_zone.data, n, scale);
    CHECK(ops.largest_entry(zone.data, n) == matrix.largest_entry());
    check_tighter(zone, matrix, other_zone, other_matrix);
    if (matrix.includes(other_matrix)) CHECK(extent.may_include(other_extent));
    if (other_matrix.includes(matrix)) CHECK(other_extent.may_include(extent));
    const bool same = zone.equals(other_matrix);
    if (same) CHECK(ops.hash(zone.data, n) == ops.hash(other_zone.data, n));
    if (same) CHECK(extent == other_extent);
    CHECK(same == std::equal(zone.data.bytes, zone.data.bytes + ops.bytes, other_zone.data.bytes));
    if (step % 6 == 0) check_reduced(zone, other_zone, random, constant);
    if (step % 6 == 3) check_reduced(other_zone, zone, random, constant);
    check_parts(zone, width, vector, static_cast<std::uint32_t>(random()));
    check_parts(zone, width, vector, static_cast<std::uint32_t>(random() | random()));
    check_order(zone, n == 1 ? 0 : below(n - 1), random);
    // Keeps the constants within what extrapolation would guarantee in a search.
    if (step % 6 == 5) {
      const std::vector<Raw> bound(static_cast<std::size_t>(n), constant);
      const tachk::zones::BoundRowBuffer b = bound_row(ops, n, bound);
      ops.extrapolate_lu_plus(zone.data, n, b.get(), b.get());
      matrix.extrapolate_lu_plus(bound, bound);
      CHECK(zone.equals(matrix));
    }
  }
}

}  // namespace

int main() {
  // The largest constants each width takes.
  for (const bool vector : {false, true})
    for (const int n : {3, 8, 20}) {
      walk(n, tachk::zones::Width::narrow, vector, 7, 2000, 800);
      walk(n, tachk::zones::Width::wide, vector, 8, 2000, (1 << 26) - 1);
      walk(n, tachk::zones::Width::widest, vector, 9, 2000, INT32_MAX - 1);
    }
  for (const tachk::zones::Width width :
       {tachk::zones::Width::narrow, tachk::zones::Width::wide, tachk::zones::Width::widest})
    for (const bool vector : {false, true}) {
      std::uint32_t seed = 1;
      for (const int n : {1, 2, 3, 4, 7, 8, 9, 15, 16, 17, 23, 33, 47, 64, 65, 70})
        for (const Raw constant : {2, 20, 400})
          walk(n, width, vector, seed++, n < 10 ? 2000 : n < 20 ? 300 : 30, constant);
    }
  std::puts("zone operations agree with the textbook");
}
