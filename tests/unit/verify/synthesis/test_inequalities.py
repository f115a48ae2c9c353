"""Regions in words: what is said agrees with every cell."""

from __future__ import annotations

from itertools import product
from random import Random

import numpy as np
import pytest

from tachk.verify.synthesis.inequalities import Points, describe
from tests.support.seeds import seeds

NAMES = ["A", "B", "C", "D"]


def box(*sizes: int) -> Points:
    return np.array(list(product(*(range(size) for size in sizes))), dtype=np.int64)


def said(points: Points, inside: object) -> str | None:
    chosen = np.asarray(inside)
    found = describe(points[chosen], points[~chosen])
    return None if found is None else found.text(NAMES[: points.shape[1]])


def test_one_inequality() -> None:
    points = box(8, 8)
    a, b = points.T
    assert said(points, a <= b) == "A <= B"
    assert said(points, a < b) == "A < B"
    assert said(points, a + 2 < b) == "A + 2 < B"
    assert said(points, a <= 3) == "A <= 3"
    assert said(points, a >= 5) == "A > 4"
    assert said(points, 2 * a + b < 9) == "2*A + B <= 8"


def test_the_law_of_sleep_heartbeat_and_dead_time() -> None:
    points = box(4, 5, 4, 9)
    q, sleep, period, dead = points.T
    assert said(points, q + sleep + 2 * period < dead) == "A + B + 2*C < D"


def test_several_inequalities() -> None:
    points = box(9, 9)
    a, b = points.T
    assert said(points, (a <= b) & (b <= 6)) in ("A <= B and B <= 6", "B <= 6 and A <= B")
    assert said(points, (a > b) | (b > 6)) in ("not (A <= B and B <= 6)", "not (B <= 6 and A <= B)")


def test_as_few_inequalities_as_are_found() -> None:
    points = box(6, 6)
    a, b = points.T
    assert said(points, (a >= 3) & (a <= b)) in ("A > 2 and A <= B", "A <= B and A > 2")


def test_nothing_is_said_where_nothing_fits_or_nothing_differs() -> None:
    points = box(9, 9)
    a, b = points.T
    assert said(points, (a + b) % 2 == 0) is None
    assert said(points, a >= 0) is None
    assert said(points, a < 0) is None


def test_points_on_the_border_are_inside() -> None:
    assert said(np.array([[0, 0], [1, 1], [1, 0]], dtype=np.int64), np.array([True, True, False])) == "A <= B"


def test_only_the_given_points_count() -> None:
    points = np.array([[10], [20], [30], [40]], dtype=np.int64)
    assert said(points, points[:, 0] <= 20) == "A <= 20"


@pytest.mark.parametrize("seed", seeds(range(20)))
def test_a_description_agrees_with_every_point(seed: int) -> None:
    random = Random(seed)
    points = box(*(random.randint(2, 6) for _ in range(random.randint(1, 3))))
    chosen = np.ones(len(points), dtype=bool)
    for _ in range(random.randint(1, 2)):
        sums = points @ np.array([random.randint(-3, 3) for _ in range(points.shape[1])])
        chosen &= sums <= random.choice(sums.tolist())
    if random.random() < 0.3:
        chosen[random.randrange(len(points))] ^= True
    found = describe(points[chosen], points[~chosen])
    if found is not None:
        assert (found.holds(points) == chosen).all()
