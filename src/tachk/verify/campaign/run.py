"""A campaign: what is missing in its file is computed and put into it."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import islice
from time import monotonic
from typing import Any

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.model.grid import Grid, Values
from tachk.verify.campaign.cluster import compute_on_cluster
from tachk.verify.campaign.job import ComputedCell, Row, Verification
from tachk.verify.campaign.local import compute_locally
from tachk.verify.campaign.store import Store, opened


@dataclass(frozen=True, slots=True)
class Progress:
    """The progress of a campaign.

    Attributes:
        cells: their number.
        finished: the number of finished cells, those of earlier runs included.
        earlier: the number of cells that were finished before this run.
        seconds: since this run began.
    """

    cells: int
    finished: int
    earlier: int
    seconds: float

    @property
    def seconds_left(self) -> float | None:
        """An estimate; None before the first cell."""
        done = self.finished - self.earlier
        return self.seconds / done * (self.cells - self.finished) if done else None


@dataclass(frozen=True, slots=True)
class GridPart:
    """Every ``of``-th cell, from number ``number`` on: for jobs that compute a grid together.

    Raises UsageError for a number that is not among 1 to ``of``.
    """

    number: int
    of: int

    def __post_init__(self) -> None:
        if not 1 <= self.number <= self.of:
            raise UsageError(f"there is no part {self.number} of {self.of}", "parts count from 1: 1/10 to 10/10")

    def cells(self, grid: Grid) -> tuple[Values, ...]:
        """Neighbours are in different parts, so that parts take about as long as one another."""
        return tuple(islice(grid.cells(), self.number - 1, None, self.of))


@dataclass(frozen=True, slots=True)
class Campaign:
    """The results of a campaign.

    Attributes:
        cells: their number in the part of the grid that is reported.
        rows: of all finished ones of these, in the order of the grid.
        earlier: how many cells were finished before this run.
        unfinished: how many cells are not finished: the time was over, or the user stopped it.
        interrupted: the user stopped it.
        seconds: of this run, in wall-clock time.
    """

    grid: Grid
    job: Verification
    cells: int
    rows: tuple[Row, ...]
    earlier: int
    unfinished: int
    interrupted: bool
    seconds: float


Computing = Callable[[Verification, tuple[Values, ...], float | None], Iterator[ComputedCell]]
"""Computes cells, in any order, until so many seconds have passed."""


def computing(processes: int | None, dask: Any) -> Computing:
    """The function that computes cells: on a Dask cluster if there is one, else in processes here.

    Args:
        dask: the address of its scheduler, a `distributed.Client` or a cluster; or None.
        processes: their number; None: as many as the machine has cores.
    """
    if dask is not None:
        return partial(compute_on_cluster, cluster=dask)
    return partial(compute_locally, processes=processes or os.cpu_count() or 1)


def run_campaign(
    grid: Grid,
    job: Verification,
    file: str | os.PathLike[str] | None,
    compute: Computing,
    seconds: float | None = None,
    progress: Callable[[Progress], None] | None = None,
    part: GridPart = GridPart(1, 1),
    others: Iterable[str | os.PathLike[str]] = (),
) -> Campaign:
    """Computes the cells that the file does not have.

    Args:
        file: None to keep what is found in memory only.
        compute: see `computing`.
        part: the cells that are computed and reported.
        others: files of the same campaign, whose cells are taken over before.
        seconds: the limit on the time of this run; what is not finished then can be computed by another run.

    Raises UsageError where the file cannot be used.
    """
    began = monotonic()
    interrupted = False
    with opened(file, grid.names, job.parts()) as store:
        for other in others:
            _take_over(store, other, grid.names, job.parts())
        known = store.finished()
        cells = part.cells(grid)
        missing = tuple(values for values in cells if values not in known)
        finished = earlier = len(cells) - len(missing)
        try:
            for cell in compute(job, missing, seconds):
                store.add(cell.values, cell.rows, cell.seconds)
                finished += 1
                if progress is not None:
                    progress(Progress(len(cells), finished, earlier, monotonic() - began))
        except KeyboardInterrupt:
            interrupted = True
        rows = tuple(store.rows(cells))
    return Campaign(grid, job, len(cells), rows, earlier, len(cells) - finished, interrupted, monotonic() - began)


def _take_over(store: Store, path: str | os.PathLike[str], names: tuple[str, ...], parts: Mapping[str, str]) -> None:
    """Adds the cells that another file has."""
    if not os.path.exists(path):
        raise UsageError(f"there is no file {os.fspath(path)} to merge")
    with opened(path, names, parts) as other:
        for values, seconds in other.times().items():
            store.add(values, [{**row} for row in other.rows([values])], seconds)
