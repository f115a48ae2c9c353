"""From a CSV file to seven verdicts: `python bench/monitor_csv.py [ROWS]`.

Writes a table with five columns beside the time, about 29 bytes a row, and judges it by seven formulas at once, one for
each property of the reliable stream. Prints CPU seconds (the machine may be shared), and those of a counting loop for
comparison with other machines.
"""

from __future__ import annotations

import resource
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from random import Random

from tachk.recordings.monitors.formulas import NamedFormula, read_formulas
from tachk.recordings.monitors.offline import EvaluationOptions, evaluate_formulas, prepare
from tachk.recordings.monitors.online import Monitor
from tachk.recordings.traces.core_monitor import monitor_truth
from tachk.recordings.traces.trace_csv import open_csv

FORMULAS = """\
ECFS: G F[0, 180] q
ECRA: G F[0, 180] r
NIWS: G (p -> !q || r || !r)
RMIO: G (p -> x < 6)
RMIO2: G (q -> x < 6)
TMRK: G (p -> F[0, 180] q)
FARS: G (r -> F[0, 180] !r)
"""


def main(arguments: list[str]) -> None:
    rows = int(arguments[0]) if arguments else 1_000_000
    print(f"counting to five million in a loop: {seconds(count):.3f} s")
    with tempfile.TemporaryDirectory() as folder:
        table, formulas = Path(folder, "trace.csv"), Path(folder, "seven.stl")
        write(table, rows)
        formulas.write_text(FORMULAS)
        named = read_formulas(formulas)
        trace, programs = prepare(named, open_csv(table))
        report("reading alone", rows, lambda: prepare(named, open_csv(table)))
        report("seven verdicts alone", rows, lambda: [monitor_truth(program, trace) for program in programs])
        report("whole, with explanations", rows, lambda: whole(named, table, robustness=False))
        report("whole, with robustness too", rows, lambda: whole(named, table, robustness=True))
        report("row by row in bounded memory", rows, lambda: online(named, table))
        print(f"largest memory of the process: {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000:.0f} MB")


def whole(named: Sequence[NamedFormula], table: Path, robustness: bool) -> None:
    evaluate_formulas(named, open_csv(table), EvaluationOptions(robustness=robustness))


def online(named: Sequence[NamedFormula], table: Path) -> None:
    monitor = Monitor(named, decimals=3)
    for block in open_csv(table).blocks(monitor.columns, 3):
        monitor.push(block.times, block.columns, block.decimals)
    monitor.finish()


def write(path: Path, rows: int) -> None:
    random = Random(1)
    instant = 0
    with path.open("w") as file:
        file.write("time,p,q,r,x,y\n")
        for _ in range(rows):
            instant += random.randint(1, 1999)
            p, q, r = (int(random.random() < share) for share in (0.01, 0.1, 0.5))
            x, y = random.uniform(-1, 5), random.uniform(0, 100)
            file.write(f"{instant // 1000}.{instant % 1000:03},{p},{q},{r},{x:.3f},{y:.2f}\n")


def count() -> None:
    number = 0
    while number < 5_000_000:
        number += 1


def report(what: str, rows: int, action: Callable[[], object]) -> None:
    taken = min(seconds(action) for _ in range(3))
    print(f"{what:30} {taken:.3f} s, {rows / taken / 1e6:.1f} million rows/s")


def seconds(action: Callable[[], object]) -> float:
    started = time.process_time()
    action()
    return time.process_time() - started


if __name__ == "__main__":
    main(sys.argv[1:])
