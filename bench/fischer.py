"""Fischer's mutual exclusion: tachk and, where it is at hand, TChecker on the same network in one run.

    python bench/fischer.py 9
    python bench/fischer.py 8 9 10 --tck-reach /path/to/tck-reach

The network for TChecker is written by this script, location for location the one of models/classics/fischer.ta; the
question there is whether two processes can be in their critical sections, which by symmetry is the whole property.
CPU seconds are those of the whole process with its start, by wait4; memory is its largest resident set.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import statistics
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from processes import finished

ROOT = Path(__file__).resolve().parents[1]
DELAY = 10


@dataclass(frozen=True, slots=True)
class Measurement:
    """One program on one instance: the median of its runs."""

    answer: str
    stored: int
    explored: int
    transitions: int
    cpu_seconds: float
    memory_bytes: int


def tchecker_network(processes: int) -> str:
    """The network in TChecker's input format."""
    lines = [f"system:fischer_{processes}", "event:tau", f"int:1:0:{processes}:0:id"]
    for i in range(1, processes + 1):
        lines += [
            f"process:P{i}",
            f"clock:1:x{i}",
            f"location:P{i}:idle{{initial:}}",
            f"location:P{i}:request{{invariant:x{i}<={DELAY}}}",
            f"location:P{i}:waiting{{}}",
            f"location:P{i}:critical{{labels:critical{i}}}",
            f"edge:P{i}:idle:request:tau{{provided:id==0 : do:x{i}=0}}",
            f"edge:P{i}:request:waiting:tau{{provided:x{i}<={DELAY} : do:x{i}=0;id={i}}}",
            f"edge:P{i}:waiting:request:tau{{provided:id==0 : do:x{i}=0}}",
            f"edge:P{i}:waiting:critical:tau{{provided:x{i}>{DELAY}&&id=={i}}}",
            f"edge:P{i}:critical:idle:tau{{do:id=0}}",
        ]
    return "\n".join(lines) + "\n"


def median_of(runs: list[Measurement]) -> Measurement:
    """The run with the median CPU time."""
    middle = statistics.median_low(sorted(m.cpu_seconds for m in runs))
    return next(m for m in runs if m.cpu_seconds == middle)


def measure_tachk(processes: int) -> Measurement:
    """`tachk verify` on the model's mutual exclusion."""
    model = ROOT / "models/classics/fischer.ta"
    command = [sys.executable, "-m", "tachk", "verify", str(model), "-D", f"N={processes}"]
    process = finished([*command, "--property", "mutual_exclusion", "--format", "json"])
    result = json.loads(process.output)["runs"][0]["results"][0]
    stats = result["stats"]
    return Measurement(
        result["answer"],
        stats["states_stored"],
        stats["states_explored"],
        stats["transitions"],
        process.cpu_seconds,
        process.memory_bytes,
    )


def measure_tchecker(tck_reach: str, processes: int) -> Measurement:
    """`tck-reach`, breadth first with covering: its best general setting on this model."""
    with tempfile.TemporaryDirectory() as folder:
        network = Path(folder) / "fischer.tck"
        network.write_text(tchecker_network(processes), encoding="utf-8")
        command = [tck_reach, "-a", "covreach", "-s", "bfs", "-l", "critical1,critical2", str(network)]
        process = finished(command)
    values = dict(re.findall(r"^(\w+) (\S+)$", process.output, re.MULTILINE))
    return Measurement(
        "fails" if values["REACHABLE"] == "true" else "holds",
        int(values["STORED_STATES"]),
        int(values["VISITED_STATES"]),
        int(values["VISITED_TRANSITIONS"]),
        process.cpu_seconds,
        process.memory_bytes,
    )


def row(processes: int, program: str, m: Measurement, ratio: str) -> str:
    """One line of the table."""
    rate = m.transitions / m.cpu_seconds
    cells = (
        processes, program, m.answer, f"{m.stored:,}", f"{m.explored:,}", f"{m.transitions:,}",
        f"{m.cpu_seconds:.2f}", f"{rate:,.0f}", f"{m.memory_bytes / 1e6:.0f}", ratio,
    )  # fmt: skip
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def main() -> None:
    """Prints the table in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("processes", type=int, nargs="*", default=[9])
    parser.add_argument("--tck-reach", default=os.environ.get("TCK_REACH"), help="TChecker's program (or $TCK_REACH)")
    parser.add_argument("--repeat", type=int, default=3, help="runs of each program; the median counts")
    arguments = parser.parse_args()
    print(f"load average {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores, median of {arguments.repeat}\n")
    print("| N | program | answer | stored | explored | transitions | CPU s | transitions/s | MB | times faster |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for n in arguments.processes:
        ours: list[Measurement] = []
        theirs: list[Measurement] = []
        for _ in range(arguments.repeat):
            ours.append(measure_tachk(n))
            if arguments.tck_reach:
                theirs.append(measure_tchecker(arguments.tck_reach, n))
        mine = median_of(ours)
        ratio = f"{median_of(theirs).cpu_seconds / mine.cpu_seconds:.1f}" if theirs else "-"
        print(row(n, "tachk", mine, ratio))
        if theirs:
            print(row(n, "TChecker", median_of(theirs), "1.0"))


if __name__ == "__main__":
    main()
