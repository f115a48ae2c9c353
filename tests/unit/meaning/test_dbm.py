"""Zone operations against their definitions, on sampled points."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tachk.meaning import dbm
from tachk.meaning.dbm import LESS_EQUAL_ZERO, Constraint, Zone, raw_bound

DIMENSION = 4
GRID = [Fraction(n, 2) for n in range(11)]


def constraints(low: int = -6, high: int = 6) -> st.SearchStrategy[Constraint]:
    clock = st.integers(0, DIMENSION - 1)
    pair = st.tuples(clock, clock).filter(lambda p: p[0] != p[1])
    return st.builds(lambda p, c, strict: (*p, raw_bound(c, strict)), pair, st.integers(low, high), st.booleans())


def made_of(given_constraints: list[Constraint]) -> Zone | None:
    return dbm.constrain_all(dbm.universe(DIMENSION), given_constraints)


zones = st.lists(constraints(), max_size=6).map(made_of).filter(lambda z: z is not None)
points = st.tuples(*[st.sampled_from(GRID)] * (DIMENSION - 1))
clocks = st.integers(1, DIMENSION - 1)


def sample(zone: Zone) -> tuple[Fraction, ...]:
    """Some point of the zone, without clock 0: clock by clock the middle of what the clocks before it leave open."""
    point: list[Fraction] = [Fraction(0)]
    for i in range(1, zone.dimension):
        low = max((point[j] - dbm.bound_value(zone[j, i])) for j in range(i) if zone[j, i] < dbm.INFINITY)
        highs = [point[j] + dbm.bound_value(zone[i, j]) for j in range(i) if zone[i, j] < dbm.INFINITY]
        if not highs:
            point.append(low + 1)
        else:
            point.append((low + min(highs)) / 2)
    return tuple(point[1:])


@given(st.lists(constraints(), max_size=8))
def test_closing_at_the_end_equals_closing_step_by_step(given_constraints: list[Constraint]) -> None:
    matrix = list(dbm.universe(DIMENSION).bounds)
    for i, j, raw in given_constraints:
        matrix[i * DIMENSION + j] = min(matrix[i * DIMENSION + j], raw)
    assert dbm.close(DIMENSION, matrix) == made_of(given_constraints)


@given(zones)
def test_zones_are_canonical(zone: Zone) -> None:
    n = range(DIMENSION)
    assert all(zone[i, j] <= dbm.add(zone[i, k], zone[k, j]) for i, j, k in product(n, n, n))
    assert all(zone[i, i] == LESS_EQUAL_ZERO for i in n)


def test_closure_uses_the_intermediate_clock_outermost() -> None:
    # c >= 0 and c - d < -2 give d > 2; with b < 9 that gives b - d < 7, through two intermediate clocks.
    zone = dbm.constrain_all(
        dbm.universe(4),
        [
            (3, 0, raw_bound(7, True)),
            (1, 3, raw_bound(9, False)),
            (1, 0, raw_bound(9, True)),
            (2, 3, raw_bound(-2, True)),
        ],
    )
    assert zone is not None
    assert zone[1, 3] == raw_bound(7, True)


@given(zones)
def test_a_sample_lies_in_its_zone(zone: Zone) -> None:
    assert dbm.contains(zone, sample(zone))


@given(zones, points, st.sampled_from(GRID))
def test_up_and_down(zone: Zone, point: tuple[Fraction, ...], duration: Fraction) -> None:
    later = tuple(v + duration for v in point)
    if dbm.contains(zone, point):
        assert dbm.contains(dbm.up(zone), later)
    if dbm.contains(zone, later):
        assert dbm.contains(dbm.down(zone), point)


@given(zones)
def test_up_and_down_add_nothing_else(zone: Zone) -> None:
    late, early = sample(dbm.up(zone)), sample(dbm.down(zone))
    assert meets_line(zone, late, -1)
    assert meets_line(zone, early, +1)


def meets_line(zone: Zone, point: tuple[Fraction, ...], direction: int) -> bool:
    """Whether some point ``point + direction * t`` with t >= 0 lies in the zone."""
    full = (Fraction(0), *point)
    changes = {Fraction(0)}
    for i, j, raw in zone.constraints():
        speed = direction * ((i != 0) - (j != 0))
        if speed:
            changes.add(max(Fraction(0), (dbm.bound_value(raw) - (full[i] - full[j])) / speed))
    ordered = sorted(changes)
    between = [(a + b) / 2 for a, b in zip(ordered, [*ordered[1:], ordered[-1] + 2], strict=True)]
    return any(dbm.contains(zone, tuple(v + direction * t for v in point)) for t in [*ordered, *between])


@given(zones, points, clocks, st.integers(0, 4))
def test_reset_and_its_undoing(zone: Zone, point: tuple[Fraction, ...], clock: int, value: int) -> None:
    after = tuple(Fraction(value) if n == clock else v for n, v in enumerate(point, start=1))
    if dbm.contains(zone, point):
        assert dbm.contains(dbm.reset(zone, clock, value), after)
        assert dbm.contains(dbm.free(zone, clock), after)
    before = dbm.undo_assign(zone, ((clock, 0, value),))
    assert (before is not None and dbm.contains(before, point)) == dbm.contains(zone, after)


changes = st.lists(st.tuples(clocks, st.integers(0, 3), st.integers(0, 4)), unique_by=lambda change: change[0]).map(
    tuple
)


@given(zones, points, changes)
def test_setting_clocks_to_others_and_its_undoing(
    zone: Zone, point: tuple[Fraction, ...], values: tuple[tuple[int, int, int], ...]
) -> None:
    after = list(point)
    for clock, source, value in values:
        after[clock - 1] = value + (point[source - 1] if source else 0)
    image = dbm.assign(zone, values)
    assert dbm.close(image.dimension, image.bounds) == image
    if dbm.contains(zone, point):
        assert dbm.contains(image, after)
    before = dbm.undo_assign(zone, values)
    assert (before is not None and dbm.contains(before, point)) == dbm.contains(zone, after)


@given(zones, clocks, st.integers(0, 4))
def test_reset_of_one_clock_keeps_other_differences(zone: Zone, clock: int, value: int) -> None:
    after = dbm.reset(zone, clock, value)
    assert after[clock, 0] == raw_bound(value, False)
    assert after[0, clock] == raw_bound(-value, False)
    assert all(after[i, j] == zone[i, j] for i in range(4) for j in range(4) if clock not in (i, j))


@given(zones, zones, points)
def test_set_operations_agree_with_points(left: Zone, right: Zone, point: tuple[Fraction, ...]) -> None:
    in_left, in_right = dbm.contains(left, point), dbm.contains(right, point)
    both = dbm.intersect(left, right)
    assert (both is not None and dbm.contains(both, point)) == (in_left and in_right)
    assert sum(dbm.contains(p, point) for p in dbm.subtract(left, right)) == (in_left and not in_right)


@given(zones, zones)
def test_inclusion_agrees_with_subtraction(left: Zone, right: Zone) -> None:
    assert dbm.includes(left, right) == (not dbm.subtract(right, left))


maxima = st.tuples(st.just(0), *[st.integers(0, 4)] * (DIMENSION - 1))


@given(zones, maxima)
def test_extrapolation_only_widens(zone: Zone, maximum: tuple[int, ...]) -> None:
    assert dbm.includes(dbm.extrapolate_max(zone, maximum), zone)


@given(zones, maxima)
def test_extrapolation_adds_only_region_equivalent_points(zone: Zone, maximum: tuple[int, ...]) -> None:
    """What ExtraM adds cannot be told from the zone by any constraint of one clock within the constants."""
    region = region_of(sample(dbm.extrapolate_max(zone, maximum)), maximum)
    assert dbm.constrain_all(zone, region) is not None


def region_of(point: tuple[Fraction, ...], maximum: tuple[int, ...]) -> list[Constraint]:
    """The region of a point for comparisons of single clocks with constants up to the maximum."""
    result: list[Constraint] = []
    near = [(n, v) for n, v in enumerate(point, start=1) if v <= maximum[n]]
    for n, v in enumerate(point, start=1):
        if v > maximum[n]:
            result.append((0, n, raw_bound(-maximum[n], True)))
    for i, v in [(0, Fraction(0)), *near]:
        for j, w in [(0, Fraction(0)), *near]:
            if i != j:
                ceiling = -((w - v) // 1)
                result.append((i, j, raw_bound(int(ceiling), strict=ceiling != v - w)))
    return result


@given(zones, maxima)
def test_extrapolation_is_finite(zone: Zone, maximum: tuple[int, ...]) -> None:
    largest = max(maximum)
    for _, _, raw in dbm.extrapolate_max(zone, maximum).constraints():
        assert abs(dbm.bound_value(raw)) <= 2 * largest + 1


def test_time_leaves_stopped_clocks_alone() -> None:
    zone = dbm.reset(dbm.point((0, 0)), 2, 3)
    later = dbm.up(zone, frozenset({2}))
    assert dbm.contains(later, (Fraction(7), Fraction(3)))
    assert not dbm.contains(later, (Fraction(7), Fraction(4)))


@pytest.mark.parametrize(("left", "right", "total"), [(3, 5, 7), (2, 5, 6), (2, 4, 6), (dbm.INFINITY, 3, dbm.INFINITY)])
def test_bounds_add_and_strictness_wins(left: int, right: int, total: int) -> None:
    assert dbm.add(left, right) == total
