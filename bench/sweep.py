"""How much of two processors a sweep uses: `python bench/sweep.py [CELLS] [MILLISECONDS] [--dask]`.

Each cell computes for some milliseconds of processor time. Prints how much of the wall-clock time of all processes
went into cells, with everything that `tachk sweep` does beside them: giving them out, and a transaction in the file for
each. The time before the first cell is printed apart. The machine should be idle. With --dask the cells go to a Dask
cluster of two workers on this machine.
"""

from __future__ import annotations

import argparse
import time
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from tachk.model.grid import Values, grid_of
from tachk.verify.campaign.cluster import compute_on_cluster
from tachk.verify.campaign.job import COLUMNS
from tachk.verify.campaign.local import compute_locally
from tachk.verify.campaign.run import Computing, Progress, run_campaign

PROCESSES = 2


class Burning:
    """Stands for a check that takes a known time."""

    names = ("N",)
    asked = ("p",)

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds

    def parts(self) -> dict[str, str]:
        return {}

    def rows(self, values: Values) -> tuple[dict[str, Any], ...]:
        ends = time.process_time() + self._seconds
        while time.process_time() < ends:
            pass
        return ({**dict.fromkeys(COLUMNS), "property": "p", "answer": "holds"},)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("cells", type=int, nargs="?", default=10_000)
    parser.add_argument("milliseconds", type=float, nargs="?", default=10)
    parser.add_argument("--dask", action="store_true")
    asked = parser.parse_args()
    if asked.dask:
        from distributed import LocalCluster

        with LocalCluster(n_workers=PROCESSES, threads_per_worker=1, dashboard_address=None) as cluster:
            measure(
                asked.cells, asked.milliseconds / 1000, partial(compute_on_cluster, address=cluster.scheduler_address)
            )
    else:
        measure(asked.cells, asked.milliseconds / 1000, partial(compute_locally, processes=PROCESSES))


def measure(cells: int, seconds: float, compute: Computing) -> None:
    started = time.monotonic()
    first: list[float] = []

    def progress(now: Progress) -> None:
        if not first:
            first.append(time.monotonic())

    with TemporaryDirectory() as folder:
        job: Any = Burning(seconds)
        run_campaign(grid_of([f"N=1..{cells}"]), job, Path(folder) / "cells.sqlite", compute, None, progress)
    ended = time.monotonic()
    used = cells * seconds / PROCESSES
    beside = (ended - first[0] - used) * PROCESSES / cells
    print(f"{cells} cells of {seconds * 1000:g} ms on {PROCESSES} processes: {ended - started:.2f} s")
    print(f"before the first cell: {first[0] - started:.2f} s; beside each cell: {beside * 1000:.2f} ms of a processor")
    print(f"efficiency with it {used / (ended - started):.1%}, without {used / (ended - first[0]):.1%}")


if __name__ == "__main__":
    main()
