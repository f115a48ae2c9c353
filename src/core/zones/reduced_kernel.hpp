// Zones in reduced form (K. Larsen, F. Larsson, P. Pettersson, W. Yi, "Efficient verification of real-time systems:
// compact data structure and state-space reduction", RTSS 1997), compiled as zone_kernel.hpp is, which includes this.
//
// Clocks whose difference is one value are a class, and its first clock stands for it. Other constraints are between
// clocks that stand. That clocks are not negative goes without saying. No way between two other clocks leads through a
// clock that nothing bounds from above, not even another clock, so that such clocks cost little here.

template <class T, int Stride>
class ReducedRecord {
 public:
  static_assert(Stride <= 64);
  static constexpr std::size_t place_bytes = Stride <= 16 ? 1 : 2;
  static constexpr int columns = ReducedHeader::columns_of(place_bytes);

  explicit ReducedRecord(const std::byte* record)
      : header_(ReducedHeader::of(record)),
        places_(record + sizeof(ReducedHeader)),
        bounds_(places_ + header_.count() * place_bytes) {}

  // Calls equality(i, j, d) for each clock j that another one stands for, with x_i - x_j <= d and x_j - x_i <= -d, then
  // constraint(i, j, d) for x_i - x_j ~ d, until one returns false; true if none does.
  template <class Equality, class Constraint>
  bool all_of(Equality equality, Constraint constraint) const {
    return header_.bound_bytes() == sizeof(std::int16_t) ? all<std::int16_t>(equality, constraint)
                                                         : all<std::int32_t>(equality, constraint);
  }

 private:
  template <class Bound, class Equality, class Constraint>
  bool all(Equality& equality, Constraint& constraint) const {
    const int count = static_cast<int>(header_.count());
    for (int n = 0; n < count; ++n) {
      std::uint16_t place = 0;
      Bound bound;
      std::memcpy(&place, places_ + static_cast<std::size_t>(n) * place_bytes, place_bytes);
      std::memcpy(&bound, bounds_ + static_cast<std::size_t>(n) * sizeof bound, sizeof bound);
      const int i = place / columns;
      const int j = place % columns;
      const auto d = static_cast<T>(bound);
      if (n < header_.equalities ? !equality(i, j, d) : !constraint(i, j, d)) return false;
    }
    return true;
  }

  ReducedHeader header_;
  const std::byte* places_;
  const std::byte* bounds_;
};

template <class T, int Stride>
struct Reduction {
  using K = Operations<T, Stride>;
  using Record = ReducedRecord<T, Stride>;
  using Vector = typename K::Vector;
  static constexpr T infinity = K::infinity;
  static constexpr int number = Stride / K::lanes;
  static constexpr int most = Stride * Stride;

  struct Found {
    std::uint16_t places[most];
    std::int32_t bounds[most];
    int count = 0;
    bool is_wide = false;

    void add(int i, int j, T bound) {
      places[count] = static_cast<std::uint16_t>(i * Record::columns + j);
      bounds[count++] = static_cast<std::int32_t>(bound);
      is_wide |= bound != static_cast<T>(static_cast<std::int16_t>(bound));
    }
  };

  // Calls body(i) for the members of a set.
  template <class Body>
  static void for_each(std::uint64_t set, Body body) {
    for (; set != 0; set &= set - 1) body(__builtin_ctzll(set));
  }
  static bool contains(std::uint64_t set, int i) { return (set >> i & 1) != 0; }

  // The lanes that are not zero, where a lane has no bit set or all.
  static std::uint64_t lanes_of(Vector mask) {
    std::uint64_t set = 0;
#if defined(__AVX2__)
    if constexpr (K::vector_bytes == 32) {
      constexpr std::uint32_t one_of_each = sizeof(T) == 2 ? 0x55555555 : 0x11111111;
      std::uint32_t bytes = static_cast<std::uint32_t>(_mm256_movemask_epi8(reinterpret_cast<const __m256i&>(mask)));
      for (bytes &= one_of_each; bytes != 0; bytes &= bytes - 1) {
        const int lane = __builtin_ctz(bytes) / static_cast<int>(sizeof(T));
        set |= std::uint64_t{1} << lane;
      }
      return set;
    }
#endif
    for (int lane = 0; lane < K::lanes; ++lane) set |= std::uint64_t{mask[lane] != 0} << lane;
    return set;
  }

  static bool is_unbounded(ConstZoneRef zone, int dimension, int i) {
    const T* row = K::row(zone, dimension, i);
    if (row[0] != infinity) return false;
    const int own = i / K::lanes;
    Vector bounded = (K::vector(row, own) ^ K::all(infinity)) & (K::lane_numbers(own) != K::all(static_cast<T>(i)));
    for (int v = 0; v < own; ++v) bounded |= K::vector(row, v) ^ K::all(infinity);
    for (int v = own + 1; v < number; ++v) bounded |= K::vector(row, v) ^ K::all(infinity);
    return !K::any(bounded);
  }

  // The clocks of each class but its first one. For each, `found` gets the equality with that first clock.
  static std::uint64_t find_equal(ConstZoneRef zone, int dimension, std::uint64_t bounded, Found& found) {
    std::uint64_t equal = 0;
    const T* first = K::row(zone, dimension, 0);
    for_each(bounded, [&](int i) {
      if (contains(equal, i)) return;
      const T* row = K::row(zone, dimension, i);
      std::uint64_t may_equal = 0;  // as far as least values say
      for (int v = i / K::lanes; v < number; ++v) {
        const Vector least = K::vector(first, v) + K::all(static_cast<T>(K::zero - first[i]));
        may_equal |= lanes_of(K::vector(row, v) == least) << (v * K::lanes);
      }
      for_each(may_equal & bounded & ~equal & ~std::uint64_t{1} << i, [&](int j) {
        if (Raw{row[j]} + K::row(zone, dimension, j)[i] != 2 * K::zero || (row[j] & 1) == 0) return;
        equal |= std::uint64_t{1} << j;
        found.add(i, j, row[j]);
      });
    });
    return equal;
  }

  // Between clocks that stand a constraint follows from others if a way through a third one is not longer.
  static std::size_t reduce(std::byte* target, ConstZoneRef zone, int dimension) {
    Found found;
    std::uint64_t bounded = 0;  // and that stand
    for (int i = 0; i < dimension; ++i)
      if (!is_unbounded(zone, dimension, i)) bounded |= std::uint64_t{1} << i;
    const std::uint64_t equal = find_equal(zone, dimension, bounded, found);
    const int equalities = found.count;
    bounded &= ~equal;
    alignas(64) T stands[Stride];
    for (int j = 0; j < Stride; ++j) stands[j] = static_cast<T>(contains(equal, j) ? 0 : -1);
    alignas(64) T others[Stride][Stride];  // rows without the entry of the clock itself and of those that do not stand
    alignas(64) T prepared[2][Stride][Stride];  // the same to be added to strict and to weak bounds
    for_each(bounded, [&](int k) {
      for (int v = 0; v < number; ++v) {
        const Vector there = K::vector(stands, v) & (K::lane_numbers(v) != K::all(static_cast<T>(k)));
        const Vector entries = there ? K::vector(K::row(zone, dimension, k), v) : K::all(infinity);
        K::vector(others[k], v) = entries;
        K::vector(prepared[0][k], v) = K::prepared_strict(entries);
        K::vector(prepared[1][k], v) = K::prepared_weak(entries);
      }
    });
    for_each(bounded, [&](int i) {
      const T* row = others[i];
      T lengths[Stride];  // of the first parts of ways from i
      const T* rests[Stride];
      int ways = 0;
      for_each(bounded, [&](int k) {
        lengths[ways] = row[k];
        rests[ways] = prepared[row[k] & 1][k];
        ways += row[k] != infinity;
      });
      const Vector plain = K::all(i == 0 ? K::zero : infinity);
      for (int v = 0; v < number; ++v) {
        const Vector entries = K::vector(row, v);
        Vector needed = (entries != K::all(infinity)) & (entries != plain);
        for (int way = 0; way < ways && K::any(needed);)
          for (const int end = way + 4 < ways ? way + 4 : ways; way < end; ++way)
            needed &= K::all(lengths[way]) + K::vector(rests[way], v) > entries;
        if (!K::any(needed)) continue;
        for_each(lanes_of(needed), [&](int lane) { found.add(i, v * K::lanes + lane, row[v * K::lanes + lane]); });
      }
    });
    return found.is_wide ? write<std::int32_t>(target, equalities, found)
                         : write<std::int16_t>(target, equalities, found);
  }

  template <class Bound>
  static std::size_t write(std::byte* target, int equalities, const Found& found) {
    const ReducedHeader header{static_cast<std::uint16_t>(found.count - equalities),
                               static_cast<std::uint8_t>(equalities),
                               ReducedHeader::sizes_of(Record::place_bytes, sizeof(Bound))};
    std::byte* to = target;
    const auto put = [&](const void* from, std::size_t bytes) {
      std::memcpy(to, from, bytes);
      to += bytes;
    };
    put(&header, sizeof header);
    for (int n = 0; n < found.count; ++n) put(found.places + n, Record::place_bytes);
    for (int n = 0; n < found.count; ++n) {
      const auto bound = static_cast<Bound>(found.bounds[n]);
      put(&bound, sizeof bound);
    }
    return static_cast<std::size_t>(to - target);
  }

  // Shortest ways (Floyd-Warshall) between clocks that stand and are bounded; what they say of others goes along.
  static void restore(ZoneRef target, const std::byte* record, int dimension) {
    const auto row_of = [&](int i) { return K::row(target, dimension, i); };
    for (int i = 0; i < dimension; ++i) {
      for (int v = 0; v < number; ++v) K::vector(row_of(i), v) = K::all(infinity);
      row_of(i)[i] = K::zero;
    }
    for (int j = 0; j < dimension; ++j) row_of(0)[j] = K::zero;
    std::uint64_t bounded = 1;  // and that stand
    std::uint64_t equal = 0;
    unsigned char stands_for[Stride];
    const auto constrain = [&](int i, int j, T d) {
      row_of(i)[j] = d;
      bounded |= std::uint64_t{1} << i;
      return true;
    };
    const auto equate = [&](int i, int j, T d) {
      equal |= std::uint64_t{1} << j;
      stands_for[j] = static_cast<unsigned char>(i);
      return constrain(i, j, d);
    };
    Record(record).all_of(equate, constrain);
    for_each(bounded, [&](int k) {
      Vector weak[number];
      Vector strict[number];
      for (int v = 0; v < number; ++v) {
        weak[v] = K::prepared_weak(K::vector(row_of(k), v));
        strict[v] = K::prepared_strict(K::vector(row_of(k), v));
      }
      for_each(bounded & ~(std::uint64_t{1} << k), [&](int i) {
        T* row = row_of(i);
        const T to_k = row[k];
        if (to_k == infinity) return;
        const Vector* prepared = (to_k & 1) != 0 ? weak : strict;
        for (int v = 0; v < number; ++v) K::vector(row, v) = K::minimum(K::vector(row, v), K::all(to_k) + prepared[v]);
      });
    });
    for_each(equal, [&](int j) {
      const T* row = row_of(stands_for[j]);
      const T shift = static_cast<T>(K::zero - row[j]);
      for (int v = 0; v < number; ++v) {
        const Vector entries = K::vector(row, v);
        K::vector(row_of(j), v) = entries == K::all(infinity) ? entries : entries + shift;
      }
    });
  }

  // The least values of the clocks, negated: the row of the reference clock (Bellman and Ford).
  static void least_values(const std::byte* record, int dimension, T* first) {
    for (int j = 0; j < dimension; ++j) first[j] = K::zero;
    bool changed = true;
    const auto shorten = [&](int i, int j, T d) {
      const T way = K::add(first[i], d);
      if (way >= first[j]) return true;
      first[j] = way;
      changed = true;
      return true;
    };
    while (changed) {
      changed = false;
      Record(record).all_of(
          [&](int i, int j, T d) { return shorten(i, j, d) && shorten(j, i, static_cast<T>(2 * K::zero - d)); },
          shorten);
    }
  }

  static bool include(const std::byte* outer, ConstZoneRef inner, int dimension) {
    const auto entry = [&](int i, int j) { return K::row(inner, dimension, i)[j]; };
    return Record(outer).all_of([&](int i, int j, T d) { return entry(i, j) <= d && entry(j, i) <= 2 * K::zero - d; },
                                [&](int i, int j, T d) { return entry(i, j) <= d; });
  }

  static bool may_lie_in(const std::byte* inner, ConstZoneRef outer, int dimension) {
    const auto entry = [&](int i, int j) { return K::row(outer, dimension, i)[j]; };
    return Record(inner).all_of([&](int i, int j, T d) { return d <= entry(i, j) && 2 * K::zero - d <= entry(j, i); },
                                [&](int i, int j, T d) { return d <= entry(i, j); });
  }

  // As for `simulates` of the kernel, of single entries.
  static bool breaks(T of_outer, T of_inner, T least, int i, int j, const ClockBounds& bounds) {
    const T lower = i == 0 ? 0 : K::values(bounds.lower)[i];
    if (lower < 0) return false;
    return of_outer < of_inner && least > K::values(bounds.upper)[j] * -2 && (of_outer & ~1) - 2 * lower < least;
  }

  static bool may_simulate(const std::byte* outer, ConstZoneRef inner, int dimension, const ClockBounds& bounds) {
    const T* least = K::row(inner, dimension, 0);
    const auto may = [&](int i, int j, T d) {
      return !breaks(d, K::row(inner, dimension, i)[j], least[j], i, j, bounds);
    };
    return Record(outer).all_of(
        [&](int i, int j, T d) { return may(i, j, d) && may(j, i, static_cast<T>(2 * K::zero - d)); }, may);
  }

  static bool may_be_simulated(const std::byte* inner, ConstZoneRef outer, int dimension, const ClockBounds& bounds) {
    T least[Stride];
    least_values(inner, dimension, least);
    const auto may = [&](int i, int j, T d) {
      return !breaks(K::row(outer, dimension, i)[j], d, least[j], i, j, bounds);
    };
    for (int j = 0; j < dimension; ++j)
      if (!may(0, j, least[j])) return false;
    return Record(inner).all_of(
        [&](int i, int j, T d) { return may(i, j, d) && may(j, i, static_cast<T>(2 * K::zero - d)); }, may);
  }

  static constexpr std::size_t most_bytes =
      sizeof(ReducedHeader) + std::size_t{most} * (Record::place_bytes + sizeof(std::int32_t));

  static constexpr ZoneReductions table() {
    return {most_bytes, reduce, restore, include, may_lie_in, may_simulate, may_be_simulated};
  }
};
