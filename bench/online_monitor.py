"""Samples that the online monitor takes in a second of CPU time: `python -m bench.online_monitor [SAMPLES]`.

Three columns of random numbers, one row a second on average at irregular instants, laid out so that no formula is
violated before the end: a monitor that knows its verdict has nothing left to do. `pushed` counts samples in arrays of
65,536 rows, `single` calls with one sample each. `memory` is the most that the engine held.
"""

from __future__ import annotations

import sys
import time

import numpy as np
from numpy.typing import NDArray

from tachk.recordings.monitors.compiler import compile as compile_formula
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.online_monitor import OnlineMonitor
from tests.support.tricky import read_formula

SHAPES = {
    "BR": "G (x > 0.3 -> F[0,{window}] y > 0.6)",
    "BI": "G (x > 0.3 -> G[0,50] !(y > 0.6))",
    "ND": "G (x > 0.3 -> y > 0.5)",
    "NE": "G (x > 0.3 -> F[0,{window}] (y > 0.6 && G[0,20] z > 0.0))",
    "S3": "G (x > 0.3 -> F[{window},{window}] y > -2)",
}
ROWS = 65_536
SINGLE = 200_000


def columns(shape: str, count: int) -> tuple[NDArray[np.int64], dict[str, NDArray[np.float64]]]:
    """Milliseconds and values."""
    random = np.random.default_rng(1)
    times = np.cumsum(random.integers(200, 1801, count)).astype(np.int64)
    x, y, z = (random.uniform(-1, 1, count) for _ in range(3))
    if shape == "BI":
        phase = times % 400_000
        x = np.where(phase < 150_000, x, -abs(x))
        y = np.where((phase > 220_000) & (phase < 390_000), y, -abs(y))
    elif shape == "ND":
        y = np.where(x > 0.3, 0.6 + abs(y), y)
    elif shape == "NE":
        z = np.where(times % 150_000 < 60_000, abs(z) + 0.1, z)
    return times, {"x": x, "y": y, "z": z}


def measure(shape: str, window: int, robustness: bool, count: int) -> str:
    times, named = columns(shape, count)
    program = compile_formula(read_formula(SHAPES[shape].format(window=window)), tuple("xyz"), 1000)
    values = [named[name] for name in program.columns]

    monitor, memory = OnlineMonitor(program, robustness=robustness), 0
    start = time.process_time()
    for first in range(0, count, ROWS):
        monitor.push(times[first : first + ROWS], [column[first : first + ROWS] for column in values])
        memory = max(memory, monitor.bytes_used)
    pushed = count / (time.process_time() - start)
    assert monitor.verdict is Truth.UNDETERMINED

    monitor, single = OnlineMonitor(program, robustness=robustness), min(count, SINGLE)
    rows = list(
        zip(times[:single].tolist(), zip(*(column[:single].tolist() for column in values), strict=True), strict=True)
    )
    start = time.process_time()
    for instant, row in rows:
        monitor.update(instant, row)
    singly = single / (time.process_time() - start)
    kind = "robustness" if robustness else "truth"
    return f"{shape} {window:6} {kind:10} {pushed / 1e6:8.1f} {singly / 1e6:8.2f} {memory / 1024:8.0f}"


def main(arguments: list[str]) -> int:
    count = int(arguments[0]) if arguments else 2_000_000
    print("shape window what       pushed/M single/M memory/KiB")
    for shape, formula in SHAPES.items():
        for window in (180, 18_000) if "{window}" in formula else (180,):
            for robustness in (False, True):
                print(measure(shape, window, robustness, count), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
