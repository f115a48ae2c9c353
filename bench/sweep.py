"""How much of two processors a sweep uses: `python bench/sweep.py [CELLS] [MILLISECONDS]`.

Each cell computes for some milliseconds of processor time. Prints how much of the wall-clock time of all processes
went into cells, with everything that `tachk sweep` does beside them: giving them out, and a transaction in the file for
each. The time before the first cell is printed apart. The machine should be idle.
"""

from __future__ import annotations

import sys
import time
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from tachk.campaign.grid import Values, grid_of
from tachk.campaign.job import COLUMNS
from tachk.campaign.local import compute_locally
from tachk.campaign.run import Progress, run_campaign

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


def main(arguments: list[str]) -> None:
    cells = int(arguments[0]) if arguments else 10_000
    seconds = float(arguments[1]) / 1000 if len(arguments) > 1 else 0.01
    started = time.monotonic()
    first: list[float] = []

    def progress(now: Progress) -> None:
        if not first:
            first.append(time.monotonic())

    with TemporaryDirectory() as folder:
        job: Any = Burning(seconds)
        compute = partial(compute_locally, processes=PROCESSES)
        run_campaign(grid_of([f"N=1..{cells}"]), job, Path(folder) / "cells.sqlite", compute, None, progress)
    ended = time.monotonic()
    used = cells * seconds / PROCESSES
    print(f"{cells} cells of {seconds * 1000:g} ms on {PROCESSES} processes: {ended - started:.2f} s")
    print(f"before the first cell: {first[0] - started:.2f} s")
    print(f"efficiency with it {used / (ended - started):.1%}, without {used / (ended - first[0]):.1%}")


if __name__ == "__main__":
    main(sys.argv[1:])
