"""Zones as difference bound matrices in plain Python: slow, obvious, exact. Tests compare the fast core with it.

A *raw bound* is an integer that stands for ``< c`` (``2c``) or ``<= c`` (``2c + 1``), so that a smaller number is a
tighter bound; `INFINITY` stands for no bound. Entry ``(i, j)`` of a zone bounds ``x_i - x_j``; clock 0 is the constant
zero. Every `Zone` is canonical (no entry can be tightened) and not empty: operations that may empty a zone return None.

Sources: Dill 1989; Bengtsson and Yi 2004 (operations); Behrmann, Bouyer, Larsen and Pelánek 2006 (extrapolations).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction

from tachk.base.records import dataclass

INFINITY = 1 << 60
LESS_EQUAL_ZERO = 1

Constraint = tuple[int, int, int]
"""``(i, j, raw)``: ``x_i - x_j`` is bounded by ``raw``."""


def raw_bound(value: int, strict: bool) -> int:
    """The raw bound ``< value`` or ``<= value``."""
    return 2 * value + (0 if strict else 1)


def bound_value(raw: int) -> int:
    """The constant of a finite raw bound."""
    return raw >> 1


def is_strict(raw: int) -> bool:
    """Whether an encoded bound is strict: ``<``, not ``<=``."""
    return not raw & 1


def add(left: int, right: int) -> int:
    """The bound on a sum, from the bounds on its terms."""
    if left >= INFINITY or right >= INFINITY:
        return INFINITY
    return left + right - ((left | right) & 1)


def negate(raw: int) -> int:
    """The bound on ``x_j - x_i`` that says that ``x_i - x_j`` violates the finite bound ``raw``."""
    return 1 - raw


def complement(constraint: Constraint) -> Constraint:
    """The constraint that holds exactly where the given one does not."""
    i, j, raw = constraint
    return j, i, negate(raw)


@dataclass(frozen=True, slots=True)
class Zone:
    """Attributes:
    dimension: the number of clocks, clock 0 included.
    bounds: the raw bounds, row by row.
    """

    dimension: int
    bounds: tuple[int, ...]

    def __getitem__(self, entry: tuple[int, int]) -> int:
        return self.bounds[entry[0] * self.dimension + entry[1]]

    def constraints(self) -> Iterator[Constraint]:
        """The finite entries off the diagonal."""
        for i in range(self.dimension):
            for j in range(self.dimension):
                if i != j and self[i, j] < INFINITY:
                    yield i, j, self[i, j]

    def __str__(self) -> str:
        def text(i: int, j: int, raw: int) -> str:
            return f"x{i}-x{j}{'<' if is_strict(raw) else '<='}{bound_value(raw)}"

        return " ".join(text(*c) for c in self.constraints())


Federation = list[Zone]
"""A union of zones; the empty list is the empty set."""


def close(dimension: int, bounds: Iterable[int]) -> Zone | None:
    """The canonical zone of any matrix of bounds (Floyd and Warshall, the intermediate clock in the outermost loop)."""
    m = list(bounds)
    n = dimension
    for k in range(n):
        for i in range(n):
            through = m[i * n + k]
            if through >= INFINITY:
                continue
            for j in range(n):
                candidate = add(through, m[k * n + j])
                if candidate < m[i * n + j]:
                    m[i * n + j] = candidate
    if any(m[i * n + i] < LESS_EQUAL_ZERO for i in range(n)):
        return None
    return Zone(n, tuple(m))


def point(values: Sequence[int]) -> Zone:
    """The zone where the clocks have these values."""
    clocks = (0, *values)
    return Zone(len(clocks), tuple(raw_bound(x - y, strict=False) for x in clocks for y in clocks))


def universe(dimension: int) -> Zone:
    """The zone of all non-negative valuations."""
    return Zone(
        dimension,
        tuple(LESS_EQUAL_ZERO if i == 0 or i == j else INFINITY for i in range(dimension) for j in range(dimension)),
    )


def constrain(zone: Zone, constraint: Constraint) -> Zone | None:
    """The part of the zone where the constraint holds: only paths through the new entry can change.

    As a zone is canonical, a path from ``p`` through the new entry to any clock is shorter than the old one only if the
    one to ``j`` is, and a path from any clock to ``q`` only if the one from ``i`` is.
    """
    i, j, raw = constraint
    n, d = zone.dimension, zone.bounds
    if raw >= d[i * n + j]:
        return zone
    if add(raw, d[j * n + i]) < LESS_EQUAL_ZERO:
        return None
    from_j = [(q, d[j * n + q]) for q in range(n) if add(raw, d[j * n + q]) < d[i * n + q]]
    bounds = list(d)
    for p in range(n):
        to_j = add(d[p * n + i], raw)
        if to_j < d[p * n + j]:
            for q, rest in from_j:
                bounds[p * n + q] = min(bounds[p * n + q], add(to_j, rest))
    return Zone(n, tuple(bounds))


def constrain_all(zone: Zone, constraints: Iterable[Constraint]) -> Zone | None:
    """The part of the zone where all the constraints hold."""
    result: Zone | None = zone
    for constraint in constraints:
        if result is None:
            return None
        result = constrain(result, constraint)
    return result


def intersect(left: Zone, right: Zone) -> Zone | None:
    return constrain_all(left, right.constraints())


def up(zone: Zone, stopped: frozenset[int] = frozenset()) -> Zone:
    """All valuations reached by letting time pass.

    With stopped clocks this is the smallest zone that contains them: only what relates a running clock from above to a
    standing one is lost (Cassez and Larsen 2000), which is an over-approximation.
    """
    n = zone.dimension
    standing = stopped | {0}
    bounds = tuple(
        INFINITY if i not in standing and j in standing else raw
        for i in range(n)
        for j, raw in enumerate(zone.bounds[i * n : i * n + n])
    )
    if not stopped:
        return Zone(n, bounds)  # canonical: a path to clock 0 was cut everywhere
    result = close(n, bounds)
    assert result is not None
    return result


def down(zone: Zone) -> Zone:
    """All non-negative valuations from which the zone is reached by letting time pass."""
    n = zone.dimension
    bounds = list(zone.bounds)
    for j in range(1, n):
        bounds[j] = min([LESS_EQUAL_ZERO, *(zone[i, j] for i in range(1, n) if i != j)])
    return Zone(n, tuple(bounds))


ClockValues = tuple[tuple[int, int, int], ...]
"""Triples (clock, source, value): all at once, clocks are set to what other clocks (0: none) are, and so much more."""


def reset(zone: Zone, clock: int, value: int) -> Zone:
    """The images of the zone's valuations when the clock is set to a constant."""
    return assign(zone, ((clock, 0, value),))


def assign(zone: Zone, values: ClockValues) -> Zone:
    """The images of the zone's valuations when clocks are set."""
    n = zone.dimension
    become = _become(n, values)

    def entry(i: int, j: int) -> int:
        (of_i, more), (of_j, less) = become[i], become[j]
        return LESS_EQUAL_ZERO if i == j else add(zone[of_i, of_j], raw_bound(more - less, strict=False))

    return Zone(n, tuple(entry(i, j) for i in range(n) for j in range(n)))


def _become(dimension: int, values: ClockValues) -> list[tuple[int, int]]:
    """The new value of every clock, if only itself."""
    become = [(clock, 0) for clock in range(dimension)]
    for clock, source, value in values:
        become[clock] = source, value
    return become


def free(zone: Zone, clock: int) -> Zone:
    """Forgets the value of a clock: it may be any non-negative number."""
    n = zone.dimension

    def entry(i: int, j: int) -> int:
        if i == j:
            return LESS_EQUAL_ZERO
        if i == clock:
            return INFINITY
        if j == clock:
            return zone[i, 0]
        return zone[i, j]

    return Zone(n, tuple(entry(i, j) for i in range(n) for j in range(n)))


def undo_assign(zone: Zone, values: ClockValues) -> Zone | None:
    """The valuations that are in the zone after clocks are set."""
    become = _become(zone.dimension, values)

    def before() -> Iterator[Constraint]:
        for i, j, raw in zone.constraints():
            (of_i, more), (of_j, less) = become[i], become[j]
            yield of_i, of_j, add(raw, raw_bound(less - more, strict=False))

    return constrain_all(universe(zone.dimension), before())


def includes(outer: Zone, inner: Zone) -> bool:
    return all(o >= i for o, i in zip(outer.bounds, inner.bounds, strict=True))


def subtract(zone: Zone, removed: Zone) -> Federation:
    """``zone`` without ``removed``, as pairwise disjoint zones."""
    pieces: Federation = []
    rest: Zone | None = zone
    for constraint in removed.constraints():
        if rest is None:
            break
        if constraint[2] >= rest[constraint[0], constraint[1]]:
            continue
        outside = constrain(rest, complement(constraint))
        if outside is not None:
            pieces.append(outside)
        rest = constrain(rest, constraint)
    return pieces if rest is not None else [zone]


def subtract_all(federation: Iterable[Zone], removed: Iterable[Zone]) -> Federation:
    """The union of the federation without all of the removed zones."""
    rest = list(federation)
    for hole in removed:
        rest = [piece for zone in rest for piece in subtract(zone, hole)]
    return rest


def without_covered(federation: Iterable[Zone]) -> Federation:
    """The same valuations in no zones that another one includes."""
    maximal: Federation = []
    for zone in federation:
        if not any(includes(other, zone) for other in maximal):
            maximal = [other for other in maximal if not includes(zone, other)] + [zone]
    return maximal


def contains(zone: Zone, clocks: Sequence[Fraction]) -> bool:
    """True if a point, given without clock 0, lies in the zone."""
    point = (Fraction(0), *clocks)
    return all(holds(constraint, point) for constraint in zone.constraints())


def holds(constraint: Constraint, point: Sequence[Fraction]) -> bool:
    """True if the constraint holds for a point, given with clock 0."""
    i, j, raw = constraint
    difference = point[i] - point[j]
    return raw >= INFINITY or (difference < bound_value(raw) if is_strict(raw) else difference <= bound_value(raw))


def extrapolate_max(zone: Zone, maximum: Sequence[int]) -> Zone:
    """ExtraM: ``maximum`` has the largest constant of each clock, -1 if it has none; entry 0 is 0. Clocks stay >= 0."""
    n = zone.dimension
    widened = (
        LESS_EQUAL_ZERO
        if i == j
        else min(_widened(zone, i, j, maximum), LESS_EQUAL_ZERO)
        if i == 0
        else _widened(zone, i, j, maximum)
        for i in range(n)
        for j in range(n)
    )
    result = close(n, widened)
    assert result is not None
    return result


def _widened(zone: Zone, i: int, j: int, maximum: Sequence[int]) -> int:
    raw = zone[i, j]
    if raw >= INFINITY or bound_value(raw) > maximum[i]:
        return INFINITY
    if -bound_value(raw) > maximum[j]:
        return raw_bound(-maximum[j], strict=True)
    return raw
