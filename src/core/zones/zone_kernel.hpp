// The zone operations, written with vector types and compiled once for each instruction set. Included by
// zone_portable.cpp and zone_avx2.cpp, which define TACHK_INSTRUCTION_SET. Uses no library templates: whatever the
// linker merges with other translation units must run on any machine.
//
// Whole rows are loaded and stored; a single entry is never stored into a row that is loaded as a vector right after,
// because that stalls the store buffer.

#include <cstring>

#if defined(__AVX2__)
#include <immintrin.h>
#endif

#include "zones/contract.hpp"
#include "zones/reduced.hpp"
#include "zones/zone.hpp"

#pragma GCC diagnostic ignored "-Wpsabi"

namespace tachk::zones::TACHK_INSTRUCTION_SET {

template <class T, int Bytes>
struct Lanes;
template <class T>
struct Lanes<T, 16> {
  typedef T Vector __attribute__((vector_size(16), may_alias));
  typedef std::uint64_t Words __attribute__((vector_size(16), may_alias));
};
template <class T>
struct Lanes<T, 32> {
  typedef T Vector __attribute__((vector_size(32), may_alias));
  typedef std::uint64_t Words __attribute__((vector_size(32), may_alias));
};

// Stride 0 stands for a stride known only at run time.
template <class T, int Stride>
struct Kernel {
  using Limits = BoundLimits<T>;
  static constexpr int row_bytes = Stride * static_cast<int>(sizeof(T));
  static constexpr int vector_bytes = row_bytes % 32 == 0 ? 32 : 16;
  static_assert(row_bytes % vector_bytes == 0);
  using Vector = typename Lanes<T, vector_bytes>::Vector;
  using Words = typename Lanes<T, vector_bytes>::Words;
  static constexpr int lanes = vector_bytes / static_cast<int>(sizeof(T));
  static constexpr T infinity = Limits::infinity;
  static constexpr T zero = 1;

  static int stride(int dimension) {
    if constexpr (Stride != 0) return Stride;
    return (dimension + lanes - 1) / lanes * lanes;
  }
  static int vectors(int dimension) { return stride(dimension) / lanes; }

  static T* row(ZoneRef zone, int dimension, int i) { return reinterpret_cast<T*>(zone.bytes) + i * stride(dimension); }
  static const T* row(ConstZoneRef zone, int dimension, int i) {
    return reinterpret_cast<const T*>(zone.bytes) + i * stride(dimension);
  }
  static const T* row(ZoneRows zone, int dimension, int i) {
    return reinterpret_cast<const T*>(zone.row(i, static_cast<std::size_t>(stride(dimension)) * sizeof(T)));
  }
  static T* values(BoundRow bounds) { return reinterpret_cast<T*>(bounds.bytes); }
  static const T* values(ConstBoundRow bounds) { return reinterpret_cast<const T*>(bounds.bytes); }
  static Vector& vector(T* row, int v) { return reinterpret_cast<Vector*>(row)[v]; }
  static const Vector& vector(const T* row, int v) { return reinterpret_cast<const Vector*>(row)[v]; }

  static Vector all(T value) { return Vector{} + value; }
  static Vector minimum(Vector a, Vector b) { return a < b ? a : b; }
  static Vector maximum(Vector a, Vector b) { return a > b ? a : b; }
  static bool any(Vector mask) {
#if defined(__AVX2__)
    if constexpr (vector_bytes == 32) {
      const __m256i bits = reinterpret_cast<const __m256i&>(mask);
      return _mm256_testz_si256(bits, bits) == 0;
    }
#endif
    const Words words = reinterpret_cast<const Words&>(mask);
    std::uint64_t all_words = words[0] | words[1];
    if constexpr (vector_bytes == 32) all_words |= words[2] | words[3];
    return all_words != 0;
  }
  static Vector lane_numbers(int v) {
    Vector numbers{};
    for (int lane = 0; lane < lanes; ++lane) {
      const int number = v * lanes + lane;
      numbers[lane] = static_cast<T>(number);
    }
    return numbers;
  }

  static T add(T a, T b) {
    if (a == infinity || b == infinity) return infinity;
    return static_cast<T>(a + b - ((a | b) & 1));
  }

  // A row prepared for being added to many scalars: to add `a`, add it to `weak` if a is odd, else to `strict`.
  // Infinite entries become `beyond`, so that the sum is never below infinity and a minimum ignores it.
  static Vector prepared_weak(Vector r) { return r == all(infinity) ? all(Limits::beyond) : r - 1; }
  static Vector prepared_strict(Vector r) { return r == all(infinity) ? all(Limits::beyond) : r - (r & 1); }

  static void make_zero(ZoneRef zone, int dimension) {
    for (int i = 0; i < dimension; ++i)
      for (int j = 0; j < stride(dimension); ++j) row(zone, dimension, i)[j] = j < dimension ? zero : infinity;
  }

  static void assign(ZoneRef zone, int dimension, const std::int32_t* entries) {
    for (int i = 0; i < dimension; ++i) {
      T* to = row(zone, dimension, i);
      for (int j = 0; j < dimension; ++j, ++entries)
        to[j] = *entries == unbounded_int32 ? infinity : static_cast<T>(*entries);
      for (int j = dimension; j < stride(dimension); ++j) to[j] = infinity;
    }
  }

  // Adds x_i - x_j ~ bound to a canonical zone; false if that empties it. O(n^2).
  static bool tighten(ZoneRef zone, int dimension, int i, int j, T bound) {
    if (bound >= row(zone, dimension, i)[j]) return true;
    if (add(bound, row(zone, dimension, j)[i]) < zero) return false;
    constexpr int fixed = Stride == 0 ? 1 : Stride / lanes;
    const int count = vectors(dimension);
    if constexpr (Stride != 0) {
      Vector weak[fixed];
      Vector strict[fixed];
      const T* row_j = row(zone, dimension, j);
      for (int v = 0; v < fixed; ++v) {
        const Vector r = vector(row_j, v);
        Vector sum = all(bound) + r - ((all(bound) | r) & 1);
        sum = r == all(infinity) ? all(infinity) : sum;
        weak[v] = prepared_weak(sum);
        strict[v] = prepared_strict(sum);
      }
      for (int r = 0; r < dimension; ++r) {
        T* row_r = row(zone, dimension, r);
        const T to_i = row_r[i];
        if (to_i == infinity) continue;
        const Vector* prepared = (to_i & 1) != 0 ? weak : strict;
        for (int v = 0; v < fixed; ++v) vector(row_r, v) = minimum(vector(row_r, v), all(to_i) + prepared[v]);
      }
    } else {
      // Row j is read while others are written; it keeps its values: a shorter way from j through (i, j) would be a
      // negative cycle.
      const T* row_j = row(zone, dimension, j);
      for (int r = 0; r < dimension; ++r) {
        T* row_r = row(zone, dimension, r);
        const T to_i = row_r[i];
        const T to_j = add(to_i, bound);
        if (to_j >= row_r[j]) continue;  // then no other way from r through (i, j) is shorter
        for (int v = 0; v < count; ++v) {
          const Vector from_j = vector(row_j, v);
          const Vector prepared = (to_j & 1) != 0 ? prepared_weak(from_j) : prepared_strict(from_j);
          vector(row_r, v) = minimum(vector(row_r, v), all(to_j) + prepared);
        }
      }
    }
    return true;
  }

  static bool intersect(ZoneRef zone, int dimension, const Atom* atoms, std::size_t count) {
    for (std::size_t a = 0; a < count; ++a)
      if (!tighten(zone, dimension, atoms[a].left, atoms[a].right, static_cast<T>(atoms[a].raw))) return false;
    return true;
  }

  // After x := y + c, x differs by c from y, and from the others as y does ("copy" and "shift" of Bengtsson and Yi).
  // The entries of y are read before they are written, also where y is x.
  static void reset(ZoneRef zone, int dimension, const ClockReset* resets, std::size_t count) {
    for (std::size_t n = 0; n < count; ++n) {
      const int clock = resets[n].clock;
      const int source = resets[n].source;
      const T up = static_cast<T>(raw_bound(resets[n].value, false));
      const T down = static_cast<T>(raw_bound(-Raw{resets[n].value}, false));
      const int column = clock / lanes;
      const Vector here = lane_numbers(column) == all(static_cast<T>(clock));
      for (int r = 0; r < dimension; ++r) {
        if (r == clock) continue;
        T* row_r = row(zone, dimension, r);
        vector(row_r, column) = here ? all(add(row_r[source], down)) : vector(row_r, column);
      }
      const int number = vectors(dimension);
      for (int v = 0; v < number; ++v) {
        const Vector same = vector(row(zone, dimension, source), v);
        Vector sum = same + all(static_cast<T>(up - 1));
        sum = same == all(infinity) ? same : sum;
        vector(row(zone, dimension, clock), v) = lane_numbers(v) == all(static_cast<T>(clock)) ? all(zero) : sum;
      }
    }
  }

  static void up(ZoneRef zone, int dimension, const std::uint8_t* stopped) {
    const int number = stopped == nullptr ? 1 : vectors(dimension);  // only those with a column that is freed
    for (int v = 0; v < number; ++v) {
      const Vector lane = lane_numbers(v);
      Vector freed = lane == all(0);
      if (stopped != nullptr)
        for (int j = 1; j < dimension; ++j)
          if (stopped[j] != 0) freed |= lane == all(static_cast<T>(j));
      for (int i = 1; i < dimension; ++i) {
        if (stopped != nullptr && stopped[i] != 0) continue;
        T* row_i = row(zone, dimension, i);
        vector(row_i, v) = freed ? all(infinity) : vector(row_i, v);
      }
    }
  }

  // Upper bounds x_i <= b, the usual invariants, are added all at once: after `up` no other way leads to 0 than through
  // one of them, so the new distance of r to 0 is the smallest of D[r][i] + b, and one pass over the rows closes the
  // matrix again.
  static void up_within(ZoneRef zone, int dimension, const std::uint8_t* stopped, const Atom* atoms,
                        std::size_t count) {
    up(zone, dimension, stopped);
    bool simple = stopped == nullptr && Stride != 0;
    for (std::size_t a = 0; a < count; ++a) simple &= atoms[a].right == 0;
    if (!simple || count == 0) {
      intersect(zone, dimension, atoms, count);
      return;
    }
    if constexpr (Stride != 0) {
      Vector weak[Stride / lanes];
      Vector strict[Stride / lanes];
      const T* first = row(zone, dimension, 0);
      for (int v = 0; v < Stride / lanes; ++v) {
        weak[v] = prepared_weak(vector(first, v));
        strict[v] = prepared_strict(vector(first, v));
      }
      for (int r = 1; r < dimension; ++r) {
        T* row_r = row(zone, dimension, r);
        T to_zero = infinity;
        for (std::size_t a = 0; a < count; ++a) {
          const T way = add(row_r[atoms[a].left], static_cast<T>(atoms[a].raw));
          if (way < to_zero) to_zero = way;
        }
        if (to_zero == infinity) continue;
        const Vector* prepared = (to_zero & 1) != 0 ? weak : strict;
        for (int v = 0; v < Stride / lanes; ++v)
          vector(row_r, v) = minimum(vector(row_r, v), all(to_zero) + prepared[v]);
      }
    }
  }

  static void down(ZoneRef zone, int dimension) {
    // x_0 - x_j: the least value of x_j is lowered to 0, but not below what the differences to other clocks ask for.
    T* first = row(zone, dimension, 0);
    for (int j = 1; j < dimension; ++j) {
      T bound = zero;
      for (int i = 1; i < dimension; ++i) {
        const T entry = row(zone, dimension, i)[j];
        if (entry < bound) bound = entry;
      }
      first[j] = bound;
    }
  }

  template <class Outer, class Inner>
  static bool includes(Outer outer, Inner inner, int dimension) {
    const int number = vectors(dimension);
    for (int i = 0; i < dimension; ++i) {
      const T* row_outer = row(outer, dimension, i);
      const T* row_inner = row(inner, dimension, i);
      Vector violated{};
      for (int v = 0; v < number; ++v) violated |= vector(row_inner, v) > vector(row_outer, v);
      if (any(violated)) return false;
    }
    return true;
  }

  // Not if for some clocks x and y, the reference clock being one of them, the least value of x in `inner` is at most
  // U(x), and y - x is bounded more tightly in `outer` in a way that matters below L(y).
  template <class Outer, class Inner>
  static bool simulates(Outer outer, Inner inner, int dimension, const ClockBounds& bounds) {
    const int number = vectors(dimension);
    const T* lower_bounds = values(bounds.lower);
    const T* upper_bounds = values(bounds.upper);
    const T* first = row(inner, dimension, 0);
    for (int y = 0; y < dimension; ++y) {
      const T bound = y == 0 ? 0 : lower_bounds[y];
      if (bound < 0) continue;
      const T* row_outer = row(outer, dimension, y);
      const T* row_inner = row(inner, dimension, y);
      const T shift = static_cast<T>(-2 * bound);
      Vector violated{};
      for (int v = 0; v < number; ++v) {
        const Vector tighter = vector(row_outer, v);
        const Vector least = vector(first, v);
        violated |= (tighter < vector(row_inner, v)) & (least > vector(upper_bounds, v) * -2) &
                    ((tighter & ~1) + shift < least);
      }
      if (any(violated)) return false;
    }
    return true;
  }

  static void hull(ZoneRef zone, ConstZoneRef other, int dimension) {
    const int number = vectors(dimension);
    for (int i = 0; i < dimension; ++i) {
      T* mine = row(zone, dimension, i);
      const T* theirs = row(other, dimension, i);
      for (int v = 0; v < number; ++v) vector(mine, v) = maximum(vector(mine, v), vector(theirs, v));
    }
  }

  // The bounds of `inner` that are tighter than those of `outer`, but for those that follow from bounds of single
  // clocks; -1 if there are more than fit.
  struct Bound {
    int i, j;
    T value;
  };
  static constexpr int most_bounds = 128;
  static int tighter_bounds(ConstZoneRef inner, ConstZoneRef outer, int dimension, Bound* bounds) {
    int count = 0;
    for (int i = 0; i < dimension; ++i) {
      const T* row_inner = row(inner, dimension, i);
      const T* row_outer = row(outer, dimension, i);
      for (int v = 0; v < vectors(dimension); ++v) {
        const Vector tighter = vector(row_inner, v) < vector(row_outer, v);
        if (!any(tighter)) continue;
        for (int lane = 0; lane < lanes; ++lane) {
          if (tighter[lane] == 0) continue;
          const int j = v * lanes + lane;
          if (i != 0 && j != 0 && row_inner[j] == add(row_inner[0], row(inner, dimension, 0)[j])) continue;
          if (count == most_bounds) return -1;
          bounds[count++] = {i, j, row_inner[j]};
        }
      }
    }
    return count;
  }

  // The hull of two zones is their union if nothing of it breaks a bound of each. The hull is closed, so that what
  // breaks x_i - x_j ~ a and x_k - x_l ~ b is empty only by the cycle j, i, l, k: two bounds broken, two of the hull.
  static bool convex_union(ZoneRef zone, ConstZoneRef other, int dimension) {
    Bound mine[most_bounds];
    Bound theirs[most_bounds];
    const int gained = tighter_bounds(zone, other, dimension, mine);
    if (gained <= 0) return false;
    const int count = tighter_bounds(other, zone, dimension, theirs);
    if (count < 0) return false;
    const auto of_hull = [&](int i, int j) {
      const T a = row(zone, dimension, i)[j];
      const T b = row(other, dimension, i)[j];
      return a > b ? a : b;
    };
    for (int p = 0; p < gained; ++p)
      for (int q = 0; q < count; ++q) {
        const T way = of_hull(mine[p].i, theirs[q].j);
        const T back = of_hull(theirs[q].i, mine[p].j);
        if (way == infinity || back == infinity) return false;
        const Raw broken = plus(raw_negated(mine[p].value), raw_negated(theirs[q].value));
        if (plus(plus(broken, way), back) >= raw_zero) return false;
      }
    hull(zone, other, dimension);
    return true;
  }

  // Rows of a zone, as far as they are among the first ones.
  struct RowSet {
    static constexpr int most = Stride != 0 ? 64 : 1024;
    std::uint64_t words[most / 64] = {};

    void add(int i) {
      if (i < most) words[i / 64] |= std::uint64_t{1} << (i % 64);
    }
    void add(const RowSet& others) {
      for (int word = 0; word < most / 64; ++word) words[word] |= others.words[word];
    }
    bool contains(int i) const { return i < most && (words[i / 64] >> (i % 64) & 1) != 0; }
    // Calls body(i) for the other rows, in order.
    template <class Body>
    void for_each_other(int dimension, Body body) const {
      for (int first = 0; first < dimension && first < most; first += 64) {
        std::uint64_t rest = ~words[first / 64];
        if (dimension - first < 64) rest &= (std::uint64_t{1} << (dimension - first)) - 1;
        for (; rest != 0; rest &= rest - 1) body(first + __builtin_ctzll(rest));
      }
      for (int i = most; i < dimension; ++i) body(i);
    }
  };

  // Floyd-Warshall; the zone must not be empty. No shorter way leads through a clock whose row is among `without_ways`,
  // none to replace an entry of the rows `closed`, and none but by way of 0 for those `closed_by_zero`, and none by way
  // of `end` or a clock behind it.
  static void close(ZoneRef zone, int dimension, const RowSet& without_ways, RowSet closed,
                    const RowSet& closed_by_zero, int end) {
    const int number = vectors(dimension);
    for (int k = 0; k < end; ++k) {
      if (k == 1) closed.add(closed_by_zero);
      if (without_ways.contains(k)) continue;
      const T* row_k = row(zone, dimension, k);
      if constexpr (Stride != 0) {
        Vector weak[Stride / lanes];
        Vector strict[Stride / lanes];
        for (int v = 0; v < Stride / lanes; ++v) {
          weak[v] = prepared_weak(vector(row_k, v));
          strict[v] = prepared_strict(vector(row_k, v));
        }
        closed.for_each_other(dimension, [&](int i) {
          T* row_i = row(zone, dimension, i);
          const T to_k = row_i[k];
          if (to_k == infinity || i == k) return;
          const Vector* prepared = (to_k & 1) != 0 ? weak : strict;
          for (int v = 0; v < Stride / lanes; ++v)
            vector(row_i, v) = minimum(vector(row_i, v), all(to_k) + prepared[v]);
        });
      } else {
        closed.for_each_other(dimension, [&](int i) {
          T* row_i = row(zone, dimension, i);
          const T to_k = row_i[k];
          if (to_k == infinity || i == k) return;
          for (int v = 0; v < number; ++v) {
            const Vector r = vector(row_k, v);
            const Vector prepared = (to_k & 1) != 0 ? prepared_weak(r) : prepared_strict(r);
            vector(row_i, v) = minimum(vector(row_i, v), all(to_k) + prepared);
          }
        });
      }
    }
  }

  static void extrapolate_lu_plus(ZoneRef zone, int dimension, ConstBoundRow lower, ConstBoundRow upper) {
    const T* lower_bounds = values(lower);
    const T* upper_bounds = values(upper);
    const int number = vectors(dimension);
    T* first = row(zone, dimension, 0);
    bool changed = false;
    bool others = false;  // whether there is a row that is none of the following:
    RowSet freed;         // rows that lose every finite entry
    RowSet closed;        // rows in which no entry is raised: as no way has become shorter, they are closed as they are
    // Rows in which only columns are raised that all rows lose but that of 0, which has the last step of ways there.
    RowSet closed_by_zero;
    for (int i = 1; i < dimension; ++i) {
      T* row_i = row(zone, dimension, i);
      const bool above_lower = first[i] < -2 * lower_bounds[i];
      if (above_lower) freed.add(i);
      const T limit = static_cast<T>(2 * lower_bounds[i] + 1);
      Vector raised_here{};
      Vector others_raised{};
      for (int v = 0; v < number; ++v) {
        const Vector old = vector(row_i, v);
        const Vector u = vector(upper_bounds, v);
        const Vector lost_by_all = vector(first, v) < u * -2;
        Vector raised = (old > all(limit)) | lost_by_all;
        if (above_lower) raised = all(-1);
        Vector fresh = raised ? all(infinity) : old;
        fresh = lane_numbers(v) == all(static_cast<T>(i)) ? all(zero) : fresh;
        raised_here |= fresh ^ old;
        others_raised |= (fresh ^ old) & ~lost_by_all;
        vector(row_i, v) = fresh;
      }
      changed |= any(raised_here);
      if (above_lower || !any(raised_here))
        closed.add(i);
      else if (any(others_raised))
        others = true;
      else
        closed_by_zero.add(i);
    }
    Vector difference{};
    for (int v = 0; v < number; ++v) {
      const Vector old = vector(first, v);
      const Vector limit = vector(upper_bounds, v) * -2;
      const Vector fresh = old < limit ? minimum(limit, all(zero)) : old;
      difference |= fresh ^ old;
      vector(first, v) = fresh;
    }
    if (!changed && !any(difference)) return;
    closed.add(0);  // where a bound of it was relaxed, no other way leads to that clock: its column was raised
    close(zone, dimension, freed, closed, closed_by_zero, others ? dimension : 1);
  }

  static void extrapolate_max(ZoneRef zone, int dimension, ConstBoundRow bound) {
    const T* bounds = values(bound);
    const int number = vectors(dimension);
    bool changed = false;
    for (int i = 0; i < dimension; ++i) {
      T* row_i = row(zone, dimension, i);
      const T limit = static_cast<T>(i == 0 ? 1 : 2 * bounds[i] + 1);
      Vector difference{};
      for (int v = 0; v < number; ++v) {
        const Vector old = vector(row_i, v);
        const Vector least = vector(bounds, v) * -2;
        Vector fresh = old < least ? minimum(least, all(zero)) : old;
        fresh = old > all(limit) ? all(infinity) : fresh;
        fresh = lane_numbers(v) == all(static_cast<T>(i)) ? all(zero) : fresh;
        difference |= fresh ^ old;
        vector(row_i, v) = fresh;
      }
      changed |= any(difference);
    }
    if (changed) close(zone, dimension, {}, {}, {}, dimension);
  }

  static bool meets_each(ConstZoneRef zone, int dimension, const Atom* atoms, std::size_t count) {
    for (std::size_t a = 0; a < count; ++a)
      if (add(static_cast<T>(atoms[a].raw), row(zone, dimension, atoms[a].right)[atoms[a].left]) < zero) return false;
    return true;
  }

  static void maximise_bounds(BoundRow target, const ConstBoundRow* rows, std::size_t count, int dimension) {
    for (int v = 0; v < vectors(dimension); ++v) {
      Vector largest = vector(values(rows[0]), v);
      for (std::size_t k = 1; k < count; ++k) largest = maximum(largest, vector(values(rows[k]), v));
      vector(values(target), v) = largest;
    }
  }

  static void set_bound(BoundRow row, int clock, Raw value) { values(row)[clock] = static_cast<T>(value); }

  static Raw entry(ConstZoneRef zone, int dimension, int i, int j) {
    const T value = row(zone, dimension, i)[j];
    return value == infinity ? unbounded_entry : Raw{value};
  }

  static std::size_t tighter(ConstZoneRef zone, ConstZoneRef other, int dimension, Atom* atoms) {
    std::size_t count = 0;
    const auto compare = [&](int i, int j) {
      const T value = row(zone, dimension, i)[j];
      if (value < row(other, dimension, i)[j])
        atoms[count++] = {static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j), Raw{value}};
    };
    for (int i = 1; i < dimension; ++i) compare(i, 0);
    for (int i = 0; i < dimension; ++i)
      for (int v = 0; v < vectors(dimension); ++v) {
        if (!any(vector(row(zone, dimension, i), v) < vector(row(other, dimension, i), v))) continue;
        const int end = dimension < (v + 1) * lanes ? dimension : (v + 1) * lanes;
        for (int j = v == 0 ? 1 : v * lanes; j < end; ++j)
          if (i != j) compare(i, j);
      }
    return count;
  }

  static Raw largest_entry(ConstZoneRef zone, int dimension) {
    const int number = vectors(dimension);
    Vector largest{};
    for (int i = 0; i < dimension; ++i)
      for (int v = 0; v < number; ++v) {
        const Vector entry = vector(row(zone, dimension, i), v);
        largest = maximum(largest, maximum(entry == all(infinity) ? all(0) : entry, -entry));
      }
    T result = 0;
    for (int lane = 0; lane < lanes; ++lane) result = largest[lane] > result ? largest[lane] : result;
    return result;
  }

  static Extent extent(ConstZoneRef zone, int dimension, const ExtentScale& scale) {
    const int number = vectors(dimension);
    const auto limit = static_cast<T>(scale.limit);
    std::int64_t columns[8]{};
    Extent result{};
    for (int k = 0; k < 8 && k < dimension; ++k) {
      Vector sums{};
      for (int i = k; i < dimension; i += 8)
        for (int v = 0; v < number; ++v)
          sums += maximum(minimum(vector(row(zone, dimension, i), v), all(limit)), all(static_cast<T>(-limit))) >>
                  scale.entry_shift;
      std::int64_t sum = 0;
      for (int lane = 0; lane < lanes; ++lane) {
        sum += sums[lane];
        columns[lane % 8] += sums[lane];
      }
      result.sums[k] = static_cast<std::int16_t>(sum >> scale.sum_shift);
    }
    for (int k = 0; k < 8; ++k) result.sums[8 + k] = static_cast<std::int16_t>(columns[k] >> scale.sum_shift);
    return result;
  }

  // Takes the entries `sources` of rows, all rows in the same order: in blocks of sixteen bytes, each out of the
  // thirty-two from one entry on, and of entry 0; entry after entry where a block needs others.
  class Picks {
   public:
    static constexpr int least = 32, most = Stride == 0 ? 1024 : Stride;  // so many are taken by blocks

    // The rows have so many entries.
    Picks(const std::uint16_t* sources, int count, [[maybe_unused]] int length) : sources_(sources), count_(count) {
#if defined(__AVX2__)
      if constexpr (wide) {
        if (count < least || count > most || length < 2 * entries) return;
        for (int done = 0; done + entries <= count; done += entries) blocks_[number_++].find(sources + done, length);
      }
#endif
    }

    void take(T* to, const T* from) const {
      int done = 0;
#if defined(__AVX2__)
      if constexpr (wide) {
        const __m128i at_zero = _mm_load_si128(reinterpret_cast<const __m128i*>(Zeros(from[0]).values));
        for (int b = 0; b < number_; ++b, done += entries) {
          const Block& block = blocks_[b];
          if (block.first < 0) {
            for (int j = done; j < done + entries; ++j) to[j] = from[sources_[j]];
            continue;
          }
          const auto* window = reinterpret_cast<const __m128i*>(from + block.first);
          const __m128i low = _mm_shuffle_epi8(_mm_loadu_si128(window), block.mask(0));
          const __m128i high = _mm_shuffle_epi8(_mm_loadu_si128(window + 1), block.mask(1));
          const __m128i rest = _mm_and_si128(at_zero, block.mask(2));
          _mm_storeu_si128(reinterpret_cast<__m128i*>(to + done), _mm_or_si128(_mm_or_si128(low, high), rest));
        }
      }
#endif
      for (int j = done; j < count_; ++j) to[j] = from[sources_[j]];
    }

   private:
#if defined(__AVX2__)
    static constexpr int size = static_cast<int>(sizeof(T));
    static constexpr int entries = 16 / size;  // of a block
    static constexpr bool wide = entries > 2 && (Stride == 0 || Stride >= least);

    struct Zeros {
      explicit Zeros(T value) {
        for (T& entry : values) entry = value;
      }
      alignas(16) T values[entries];
    };

    struct Block {
      int first = -1;                            // of the window; -1: none is wide enough
      alignas(16) unsigned char masks[3][16]{};  // of its halves by byte, 128 for none; of entry 0, all bits or none

      __m128i mask(int part) const { return _mm_load_si128(reinterpret_cast<const __m128i*>(masks[part])); }
      void find(const std::uint16_t* sources, int length) {
        int least_source = length;
        int last_source = 0;
        for (int j = 0; j < entries; ++j) {
          if (sources[j] == 0) continue;
          least_source = sources[j] < least_source ? sources[j] : least_source;
          last_source = sources[j] > last_source ? sources[j] : last_source;
        }
        first = least_source < length - 2 * entries ? least_source : length - 2 * entries;
        if (last_source - first >= 2 * entries) {
          first = -1;
          return;
        }
        for (int j = 0; j < entries; ++j)
          for (int byte = 0; byte < size; ++byte) {
            const int at = (sources[j] - first) * size + byte;
            const int place = j * size + byte;
            masks[0][place] = static_cast<unsigned char>(sources[j] != 0 && at < 16 ? at : 128);
            masks[1][place] = static_cast<unsigned char>(sources[j] != 0 && at >= 16 ? at - 16 : 128);
            masks[2][place] = sources[j] == 0 ? 255 : 0;
          }
      }
    };

    int number_ = 0;
    Block blocks_[wide ? most / entries : 1];
#endif
    const std::uint16_t* sources_;
    int count_;
  };

  static void gather(ZoneRef target, ConstZoneRef zone, int dimension, const std::uint16_t* clocks, int count,
                     int length) {
    const Picks picks(clocks, count, stride(dimension));
    for (int i = 0; i < count; ++i) {
      T* to = reinterpret_cast<T*>(target.bytes) + i * length;
      picks.take(to, row(zone, dimension, clocks[i]));
      for (int j = count; j < length; ++j) to[j] = infinity;
    }
  }

  static void scatter(ZoneRef target, ConstZoneRef part, int dimension, const std::uint16_t* clocks, int count,
                      int length) {
    if (Picks::least <= dimension && dimension <= Picks::most)
      return scatter_by_blocks(target, part, dimension, clocks, count, length);
    scatter_rows(target, part, dimension, clocks, count, length, [&](T* to, const T* from) {
      for (int j = 0; j < dimension; ++j) to[j] = from[0];
      for (int j = 0; j < count; ++j) to[clocks[j]] = from[j];
    });
  }

  static void scatter_by_blocks(ZoneRef target, ConstZoneRef part, int dimension, const std::uint16_t* clocks,
                                int count, int length) {
    std::uint16_t sources[Picks::most]{};  // of each clock its number in the part; 0: it is not in it
    for (int j = 0; j < count; ++j) sources[clocks[j]] = static_cast<std::uint16_t>(j);
    const Picks picks(sources, dimension, length);
    scatter_rows(target, part, dimension, clocks, count, length, [&](T* to, const T* from) { picks.take(to, from); });
  }

  template <class Take>
  static void scatter_rows(ZoneRef target, ConstZoneRef part, int dimension, const std::uint16_t* clocks, int count,
                           int length, Take take) {
    for (int i = 0, next = 0; i < dimension; ++i) {
      T* to = row(target, dimension, i);
      if (next == count || clocks[next] != i) {
        for (int j = 0; j < stride(dimension); ++j) to[j] = infinity;
        to[i] = zero;
        continue;
      }
      take(to, reinterpret_cast<const T*>(part.bytes) + next * length);
      ++next;
      for (int j = dimension; j < stride(dimension); ++j) to[j] = infinity;
    }
  }

  static void rename(ZoneRef target, ConstZoneRef zone, int dimension, const std::uint16_t* sources) {
    const Picks picks(sources, dimension, stride(dimension));
    for (int i = 0; i < dimension; ++i) {
      T* to = row(target, dimension, i);
      picks.take(to, row(zone, dimension, sources[i]));
      for (int j = dimension; j < stride(dimension); ++j) to[j] = infinity;
    }
  }

  static bool stays(ConstZoneRef zone, int dimension, const std::uint16_t* sources, const std::uint16_t* moved,
                    std::size_t count) {
    for (std::size_t n = 0; n < count; ++n) {
      const T* from = row(zone, dimension, sources[moved[n]]);
      const T* to = row(zone, dimension, moved[n]);
      for (int j = 0; j < dimension; ++j)
        if (to[j] != from[sources[j]]) return false;
    }
    for (int i = 0; i < dimension; ++i) {
      const T* from = row(zone, dimension, sources[i]);
      const T* to = row(zone, dimension, i);
      for (std::size_t n = 0; n < count; ++n)
        if (to[moved[n]] != from[sources[moved[n]]]) return false;
    }
    return true;
  }

  static void sum_up(ConstZoneRef zone, int dimension, std::int64_t* rows, std::int64_t* columns) {
    constexpr std::int64_t limit = std::int64_t{1} << 40;
    for (int j = 0; j < dimension; ++j) columns[j] = 0;
    for (int i = 0; i < dimension; ++i) {
      const T* entries = row(zone, dimension, i);
      std::int64_t sum = 0;
      for (int j = 0; j < dimension; ++j) {
        std::int64_t entry = entries[j];
        if constexpr (sizeof(T) == 8) entry = entry > limit ? limit : entry < -limit ? -limit : entry;
        sum += entry;
        columns[j] += entry;
      }
      rows[i] = sum;
    }
  }

  static bool equal(ZoneRows zone, ConstZoneRef other, int dimension) {
    for (int i = 0; i < dimension; ++i) {
      Vector difference{};
      for (int v = 0; v < vectors(dimension); ++v)
        difference |= vector(row(zone, dimension, i), v) ^ vector(row(other, dimension, i), v);
      if (any(difference)) return false;
    }
    return true;
  }

  static void assemble(ZoneRef target, ZoneRows zone, int dimension) {
    for (int i = 0; i < dimension; ++i) {
      const T* from = row(zone, dimension, i);
      T* to = row(target, dimension, i);
      for (int v = 0; v < vectors(dimension); ++v) vector(to, v) = vector(from, v);
    }
  }

  static std::uint64_t hash(ConstZoneRef zone, int dimension) {
    const int number = vectors(dimension) * dimension;
    const Words* words = reinterpret_cast<const Words*>(zone.bytes);
    Words start;
    if constexpr (vector_bytes == 32)
      start = Words{0x9E3779B97F4A7C15u, 0xC2B2AE3D27D4EB4Fu, 0x165667B19E3779F9u, 0x27D4EB2F165667C5u};
    else
      start = Words{0x9E3779B97F4A7C15u, 0xC2B2AE3D27D4EB4Fu};
    const auto mixed = [](Words sum, Words word) {
      sum ^= word;
      sum += (sum << 21) + (sum << 3);
      return sum ^ (sum >> 29);
    };
    // Parts that do not wait for each other.
    constexpr int parts = 4;
    Words sums[parts] = {start, start + 1, start + 2, start + 3};
    int n = 0;
    for (; n + parts <= number; n += parts)
      for (int part = 0; part < parts; ++part) sums[part] = mixed(sums[part], words[n + part]);
    for (; n < number; ++n) sums[0] = mixed(sums[0], words[n]);
    Words sum = sums[0];
    for (int part = 1; part < parts; ++part) sum = mixed(sum, sums[part]);
    std::uint64_t result = 0;
    for (int lane = 0; lane < vector_bytes / 8; ++lane) {
      result = (result ^ sum[lane]) * 0x9E3779B97F4A7C15u;
      result ^= result >> 32;
    }
    return result;
  }
};

#ifdef TACHK_CONTRACTS
#include "zones/zone_contracts.hpp"
template <class T, int Stride>
using Operations = CheckedKernel<T, Stride>;
#else
template <class T, int Stride>
using Operations = Kernel<T, Stride>;
#endif

#include "zones/reduced_kernel.hpp"

template <class T, int Stride>
struct Table {
  using K = Operations<T, Stride>;
  static bool lie_in(ZoneRows inner, ConstZoneRef outer, int dimension) { return K::includes(outer, inner, dimension); }
  static bool are_simulated(ZoneRows inner, ConstZoneRef outer, int dimension, const ClockBounds& bounds) {
    return K::simulates(outer, inner, dimension, bounds);
  }
  static ZoneOperations make(const char* name, int dimension) {
    ZoneOperations table{};
    table.name = name;
    table.stride = K::stride(dimension);
    table.lanes = K::lanes;
    table.row_bytes = static_cast<std::size_t>(table.stride) * sizeof(T);
    table.bytes = static_cast<std::size_t>(dimension) * table.row_bytes;
    table.largest_constant = BoundLimits<T>::largest_constant;
    table.legal = BoundLimits<T>::legal;
    table.make_zero = K::make_zero;
    table.assign = K::assign;
    table.intersect = K::intersect;
    table.meets_each = K::meets_each;
    table.reset = K::reset;
    table.up = K::up;
    table.up_within = K::up_within;
    table.down = K::down;
    table.includes = K::template includes<ConstZoneRef, ConstZoneRef>;
    table.simulates = K::template simulates<ConstZoneRef, ConstZoneRef>;
    table.hull = K::hull;
    table.convex_union = K::convex_union;
    table.extrapolate_lu_plus = K::extrapolate_lu_plus;
    table.extrapolate_max = K::extrapolate_max;
    table.maximise_bounds = K::maximise_bounds;
    table.hash = K::hash;
    table.gather = K::gather;
    table.scatter = K::scatter;
    table.rename = K::rename;
    table.stays = K::stays;
    table.sum_up = K::sum_up;
    table.largest_entry = K::largest_entry;
    table.tighter = K::tighter;
    table.extent = K::extent;
    table.entry = K::entry;
    table.set_bound = K::set_bound;
    table.rows = {K::equal,      K::template includes<ZoneRows, ConstZoneRef>,
                  lie_in,        K::template simulates<ZoneRows, ConstZoneRef>,
                  are_simulated, K::assemble};
    // Not for short rows, which take little memory as it is, nor for long ones, as restoring zones takes long there.
    if constexpr (Stride >= 16 && sizeof(T) < 8) table.reductions = Reduction<T, Stride>::table();
    return table;
  }
};

// Rows of these lengths have code of their own, others are handled by loops over a length known only at run time.
inline ZoneOperations operations(int dimension, Width width) {
#define TACHK_ROWS(type, name, length) \
  if (dimension <= (length)) return Table<type, length>::make(TACHK_INSTRUCTION_NAME " " name "x" #length, dimension);
  switch (width) {
    case Width::narrow:
      TACHK_ROWS(std::int16_t, "int16", 8)
      TACHK_ROWS(std::int16_t, "int16", 16)
      TACHK_ROWS(std::int16_t, "int16", 24)
      TACHK_ROWS(std::int16_t, "int16", 32)
      TACHK_ROWS(std::int16_t, "int16", 48)
      TACHK_ROWS(std::int16_t, "int16", 64)
      return Table<std::int16_t, 0>::make(TACHK_INSTRUCTION_NAME " int16", dimension);
    case Width::wide:
      TACHK_ROWS(std::int32_t, "int32", 8)
      TACHK_ROWS(std::int32_t, "int32", 16)
      TACHK_ROWS(std::int32_t, "int32", 24)
      TACHK_ROWS(std::int32_t, "int32", 32)
      TACHK_ROWS(std::int32_t, "int32", 40)
      TACHK_ROWS(std::int32_t, "int32", 48)
      TACHK_ROWS(std::int32_t, "int32", 56)
      TACHK_ROWS(std::int32_t, "int32", 64)
      return Table<std::int32_t, 0>::make(TACHK_INSTRUCTION_NAME " int32", dimension);
    case Width::widest:
      break;
  }
  TACHK_ROWS(std::int64_t, "int64", 8)
  TACHK_ROWS(std::int64_t, "int64", 16)
#undef TACHK_ROWS
  return Table<std::int64_t, 0>::make(TACHK_INSTRUCTION_NAME " int64", dimension);
}

}  // namespace tachk::zones::TACHK_INSTRUCTION_SET
