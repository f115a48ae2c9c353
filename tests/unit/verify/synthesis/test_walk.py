"""The staircase: every cell as if each had been asked, and few of them asked."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from random import Random

import numpy as np
import pytest
from numpy.typing import NDArray

from tachk.verify.synthesis.walk import AxisKind, Cell, CellStatus, PendingCell, walk
from tests.support.seeds import seeds


def monotone_box(random: Random, shape: Sequence[int], axes: Sequence[AxisKind]) -> NDArray[np.int8]:
    """Random statuses that are monotone along the axes that say so."""
    reached = np.zeros(shape, dtype=bool)
    for _ in range(random.randrange(5)):
        reached[tuple(random.randrange(size) for size in shape)] = True
    for number, axis in enumerate(axes):
        if axis is AxisKind.SAME:
            reached[:] = reached.any(axis=number, keepdims=True)
        elif axis is not AxisKind.ANY:
            way = slice(None, None, int(axis))
            turned = np.moveaxis(reached, number, 0)
            turned[way] = np.maximum.accumulate(turned[way], axis=0)
    return np.where(reached, CellStatus.REACHED, CellStatus.UNREACHED).astype(np.int8)


def walked(
    truth: NDArray[np.int8],
    axes: Sequence[AxisKind],
    may_infer: Callable[[Sequence[Cell]], bool] = lambda corners: True,
) -> tuple[NDArray[np.int8], list[PendingCell]]:
    asked: list[PendingCell] = []

    def decide(one: PendingCell) -> CellStatus:
        asked.append(one)
        return CellStatus(int(truth[one.cell]))

    statuses = np.zeros(truth.shape, dtype=np.int8)
    walk(statuses, axes, decide, may_infer)
    return statuses, asked


@pytest.mark.parametrize("seed", seeds(range(60)))
def test_every_cell_is_known_as_if_it_had_been_asked(seed: int) -> None:
    random = Random(seed)
    shape = [random.randint(1, 6) for _ in range(random.randint(1, 4))]
    axes = [random.choice(list(AxisKind)) for _ in shape]
    truth = monotone_box(random, shape, axes)
    statuses, asked = walked(truth, axes)
    assert (statuses == truth).all()
    assert len({one.cell for one in asked}) == len(asked)
    assert all(one.left >= 1 for one in asked)


@pytest.mark.parametrize("seed", seeds(range(60)))
def test_what_is_unknown_stays_so_only_where_nothing_implies_it(seed: int) -> None:
    random = Random(seed)
    shape = [random.randint(1, 7) for _ in range(random.randint(1, 3))]
    axes = [random.choice(list(AxisKind)) for _ in shape]
    truth = monotone_box(random, shape, axes)
    seen = truth.copy()
    seen[np.array([random.random() < 0.3 for _ in range(truth.size)]).reshape(shape)] = CellStatus.UNKNOWN
    statuses, _ = walked(seen, axes)
    assert (statuses != CellStatus.OPEN).all()
    decided = statuses != CellStatus.UNKNOWN
    assert (statuses[decided] == truth[decided]).all()
    if AxisKind.SAME not in axes:
        assert (seen[~decided] == CellStatus.UNKNOWN).all()


def test_the_border_is_enough() -> None:
    size = 50
    rows, columns = np.indices((size, size))
    truth = np.where(rows > columns, CellStatus.REACHED, CellStatus.UNREACHED).astype(np.int8)
    _, asked = walked(truth, [AxisKind.MORE, AxisKind.LESS])
    assert len(asked) < 3 * size
    _, asked = walked(truth, [AxisKind.MORE, AxisKind.ANY])
    assert len(asked) <= size * 7


def test_one_value_stands_for_all_where_nothing_depends_on_it() -> None:
    truth = np.full((30,), CellStatus.UNREACHED, dtype=np.int8)
    assert len(walked(truth, [AxisKind.SAME])[1]) == 1


def test_a_box_whose_corners_do_not_allow_it_is_tried_cell_by_cell() -> None:
    truth = np.full((4, 5), CellStatus.UNREACHED, dtype=np.int8)
    boxes: list[Sequence[Cell]] = []

    def may_infer(corners: Sequence[Cell]) -> bool:
        boxes.append(corners)
        return corners[0][0] != 2

    _, asked = walked(truth, [AxisKind.ANY, AxisKind.MORE], may_infer)
    assert boxes == [[(row, 0), (row, 4)] for row in range(4)]
    assert sum(one.cell[0] == 2 for one in asked) == 5
    assert sum(one.cell[0] == 1 for one in asked) < 5
