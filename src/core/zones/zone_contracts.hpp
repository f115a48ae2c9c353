// The zone operations with their contracts: each asks for canonical, non-empty zones, and what it changes is one again.
// Included by zone_kernel.hpp, within the namespace of an instruction set.
//
// A matrix D is canonical and not empty if D[i][i] is "<= 0" and no way through a third clock is shorter than the
// direct one: D[i][j] <= D[i][k] + D[k][j]. Then each entry is the least upper bound of x_i - x_j over the zone, which
// is what the operations rely on, and the zone has a valuation: an empty one has a negative cycle, and with it some
// D[i][i] that is too large.

template <class T, int Stride>
struct CheckedKernel : Kernel<T, Stride> {
  using K = Kernel<T, Stride>;

  // Rows of zones may be shorter or longer than those of this kernel where clocks are left out (gather, scatter).
  static const T* row_of(ConstZoneRef zone, int length, int i) {
    return reinterpret_cast<const T*>(zone.bytes) + i * length;
  }
  static bool is_entry(T entry) {
    return entry == K::infinity || (entry < K::Limits::legal && entry > -K::Limits::legal);
  }
  static bool has_entries(ConstZoneRef zone, int dimension, int length) {
    for (int i = 0; i < dimension; ++i) {
      const T* row = row_of(zone, length, i);
      if (row[i] != K::zero) return false;
      for (int j = 0; j < dimension; ++j)
        if (!is_entry(row[j])) return false;
      for (int j = dimension; j < length; ++j)
        if (row[j] != K::infinity) return false;
    }
    return true;
  }
  static bool is_closed(ConstZoneRef zone, int dimension, int length) {
    for (int k = 0; k < dimension; ++k)
      for (int i = 0; i < dimension; ++i) {
        const T to_k = row_of(zone, length, i)[k];
        if (to_k == K::infinity) continue;
        for (int j = 0; j < dimension; ++j)
          if (K::add(to_k, row_of(zone, length, k)[j]) < row_of(zone, length, i)[j]) return false;
      }
    return true;
  }
  // No clock is negative.
  static bool is_positive(ConstZoneRef zone, int dimension, int length) {
    for (int j = 0; j < dimension; ++j)
      if (row_of(zone, length, 0)[j] > K::zero) return false;
    return true;
  }
  static bool canonical(ConstZoneRef zone, int dimension, int length) {
    return has_entries(zone, dimension, length) && is_positive(zone, dimension, length) &&
           is_closed(zone, dimension, length);
  }
  static bool canonical(ConstZoneRef zone, int dimension) { return canonical(zone, dimension, K::stride(dimension)); }
  // Of zones that were checked when they were made, where checking them again would take too long.
  template <class Zone>
  static bool like_a_zone(Zone zone, int dimension) {
    for (int i = 0; i < dimension; ++i)
      if (K::row(zone, dimension, i)[i] != K::zero) return false;
    return true;
  }

  static bool proper(const Atom* atoms, std::size_t count, int dimension) {
    for (std::size_t a = 0; a < count; ++a)
      if (atoms[a].left >= dimension || atoms[a].right >= dimension || atoms[a].raw >= K::Limits::legal ||
          atoms[a].raw <= -K::Limits::legal)
        return false;
    return true;
  }
  static bool proper(const ClockReset* resets, std::size_t count, int dimension) {
    for (std::size_t n = 0; n < count; ++n)
      if (resets[n].clock < 1 || resets[n].clock >= dimension || resets[n].source >= dimension || resets[n].value < 0 ||
          resets[n].value > K::Limits::largest_constant)
        return false;
    return true;
  }
  static bool proper(ConstBoundRow bounds, int dimension) {
    const T* values = K::values(bounds);
    for (int clock = 0; clock < K::stride(dimension); ++clock) {
      const bool bounded = clock != 0 && clock < dimension;
      if (!bounded && values[clock] != no_bound) return false;
      if (bounded && (values[clock] < not_compared || values[clock] > K::Limits::largest_constant)) return false;
    }
    return true;
  }
  // Which clocks are kept: the reference clock, and others behind it in ascending order.
  static bool proper(const std::uint16_t* clocks, int count, int dimension) {
    if (count < 1 || clocks[0] != 0 || clocks[count - 1] >= dimension) return false;
    for (int n = 1; n < count; ++n)
      if (clocks[n] <= clocks[n - 1]) return false;
    return true;
  }

  static void assign(ZoneRef zone, int dimension, const std::int32_t* entries) {
    K::assign(zone, dimension, entries);
    TACHK_EXPECT(canonical(zone, dimension));
  }
  static void make_zero(ZoneRef zone, int dimension) {
    K::make_zero(zone, dimension);
    TACHK_EXPECT(canonical(zone, dimension));
  }
  static bool intersect(ZoneRef zone, int dimension, const Atom* atoms, std::size_t count) {
    TACHK_EXPECT(canonical(zone, dimension));
    TACHK_EXPECT(proper(atoms, count, dimension));
    const bool some = K::intersect(zone, dimension, atoms, count);
    TACHK_EXPECT(!some || canonical(zone, dimension));
    return some;
  }
  static bool meets_each(ConstZoneRef zone, int dimension, const Atom* atoms, std::size_t count) {
    TACHK_EXPECT(canonical(zone, dimension));
    TACHK_EXPECT(proper(atoms, count, dimension));
    return K::meets_each(zone, dimension, atoms, count);
  }
  static void reset(ZoneRef zone, int dimension, const ClockReset* resets, std::size_t count) {
    TACHK_EXPECT(canonical(zone, dimension));
    TACHK_EXPECT(proper(resets, count, dimension));
    K::reset(zone, dimension, resets, count);
    TACHK_EXPECT(canonical(zone, dimension));
  }
  static void up(ZoneRef zone, int dimension, const std::uint8_t* stopped) {
    TACHK_EXPECT(canonical(zone, dimension));
    K::up(zone, dimension, stopped);
    TACHK_EXPECT(canonical(zone, dimension));
  }
  static void up_within(ZoneRef zone, int dimension, const std::uint8_t* stopped, const Atom* atoms,
                        std::size_t count) {
    TACHK_EXPECT(canonical(zone, dimension));
    TACHK_EXPECT(proper(atoms, count, dimension));
    TACHK_EXPECT(K::meets_each(zone, dimension, atoms, count));
    K::up_within(zone, dimension, stopped, atoms, count);
    TACHK_EXPECT(canonical(zone, dimension));
  }
  static void down(ZoneRef zone, int dimension) {
    TACHK_EXPECT(canonical(zone, dimension));
    K::down(zone, dimension);
    TACHK_EXPECT(canonical(zone, dimension));
  }
  template <class Outer, class Inner>
  static bool includes(Outer outer, Inner inner, int dimension) {
    TACHK_EXPECT(like_a_zone(outer, dimension));
    TACHK_EXPECT(like_a_zone(inner, dimension));
    return K::includes(outer, inner, dimension);
  }
  template <class Outer, class Inner>
  static bool simulates(Outer outer, Inner inner, int dimension, const ClockBounds& bounds) {
    TACHK_EXPECT(like_a_zone(outer, dimension));
    TACHK_EXPECT(like_a_zone(inner, dimension));
    TACHK_EXPECT(proper(bounds.lower, dimension));
    TACHK_EXPECT(proper(bounds.upper, dimension));
    return K::simulates(outer, inner, dimension, bounds);
  }
  static void hull(ZoneRef zone, ConstZoneRef other, int dimension) {
    TACHK_EXPECT(canonical(zone, dimension));
    TACHK_EXPECT(canonical(other, dimension));
    K::hull(zone, other, dimension);
    TACHK_EXPECT(canonical(zone, dimension));
  }
  static bool convex_union(ZoneRef zone, ConstZoneRef other, int dimension) {
    TACHK_EXPECT(canonical(zone, dimension));
    TACHK_EXPECT(canonical(other, dimension));
    const bool is_zone = K::convex_union(zone, other, dimension);
    TACHK_EXPECT(canonical(zone, dimension));
    TACHK_EXPECT(!is_zone || K::includes(zone, other, dimension));
    return is_zone;
  }
  static void extrapolate_lu_plus(ZoneRef zone, int dimension, ConstBoundRow lower, ConstBoundRow upper) {
    TACHK_EXPECT(canonical(zone, dimension));
    TACHK_EXPECT(proper(lower, dimension));
    TACHK_EXPECT(proper(upper, dimension));
    K::extrapolate_lu_plus(zone, dimension, lower, upper);
    TACHK_EXPECT(canonical(zone, dimension));
  }
  static void extrapolate_max(ZoneRef zone, int dimension, ConstBoundRow bound) {
    TACHK_EXPECT(canonical(zone, dimension));
    TACHK_EXPECT(proper(bound, dimension));
    K::extrapolate_max(zone, dimension, bound);
    TACHK_EXPECT(canonical(zone, dimension));
  }
  static void maximise_bounds(BoundRow target, const ConstBoundRow* rows, std::size_t count, int dimension) {
    TACHK_EXPECT(count > 0);
    for (std::size_t k = 0; k < count; ++k) TACHK_EXPECT(proper(rows[k], dimension));
    K::maximise_bounds(target, rows, count, dimension);
    TACHK_EXPECT(proper(target, dimension));
  }
  static bool equal(ZoneRows zone, ConstZoneRef other, int dimension) {
    TACHK_EXPECT(like_a_zone(zone, dimension));
    TACHK_EXPECT(like_a_zone(other, dimension));
    return K::equal(zone, other, dimension);
  }
  static void assemble(ZoneRef target, ZoneRows zone, int dimension) {
    TACHK_EXPECT(like_a_zone(zone, dimension));
    K::assemble(target, zone, dimension);
  }
  static std::uint64_t hash(ConstZoneRef zone, int dimension) {
    TACHK_EXPECT(canonical(zone, dimension));
    return K::hash(zone, dimension);
  }
  static std::size_t tighter(ConstZoneRef zone, ConstZoneRef other, int dimension, Atom* atoms) {
    TACHK_EXPECT(canonical(zone, dimension));
    TACHK_EXPECT(canonical(other, dimension));
    return K::tighter(zone, other, dimension, atoms);
  }
  static Raw largest_entry(ConstZoneRef zone, int dimension) {
    TACHK_EXPECT(canonical(zone, dimension));
    return K::largest_entry(zone, dimension);
  }
  static Extent extent(ConstZoneRef zone, int dimension, const ExtentScale& scale) {
    TACHK_EXPECT(like_a_zone(zone, dimension));
    return K::extent(zone, dimension, scale);
  }
  static Raw entry(ConstZoneRef zone, int dimension, int i, int j) {
    TACHK_EXPECT(i >= 0 && i < dimension && j >= 0 && j < K::stride(dimension));
    return K::entry(zone, dimension, i, j);
  }
  static void gather(ZoneRef target, ConstZoneRef zone, int dimension, const std::uint16_t* clocks, int count,
                     int length) {
    TACHK_EXPECT(canonical(zone, dimension));
    TACHK_EXPECT(proper(clocks, count, dimension));
    K::gather(target, zone, dimension, clocks, count, length);
    TACHK_EXPECT(canonical(target, count, length));
  }
  static void rename(ZoneRef target, ConstZoneRef zone, int dimension, const std::uint16_t* sources) {
    TACHK_EXPECT(sources[0] == 0);
    for (int i = 0; i < dimension; ++i) TACHK_EXPECT(sources[i] < dimension);
    K::rename(target, zone, dimension, sources);
    TACHK_EXPECT(canonical(target, dimension));
  }
  static bool stays(ConstZoneRef zone, int dimension, const std::uint16_t* sources, const std::uint16_t* moved,
                    std::size_t count) {
    TACHK_EXPECT(canonical(zone, dimension));
    std::size_t differing = 0;
    for (int i = 0; i < dimension; ++i) differing += sources[i] != i ? 1U : 0U;
    TACHK_EXPECT(differing == count);
    for (std::size_t n = 0; n < count; ++n) TACHK_EXPECT(sources[moved[n]] != moved[n]);
    return K::stays(zone, dimension, sources, moved, count);
  }
  static void scatter(ZoneRef target, ConstZoneRef part, int dimension, const std::uint16_t* clocks, int count,
                      int length) {
    TACHK_EXPECT(proper(clocks, count, dimension));
    TACHK_EXPECT(canonical(part, count, length));
    K::scatter(target, part, dimension, clocks, count, length);
    TACHK_EXPECT(canonical(target, dimension));
  }
};
