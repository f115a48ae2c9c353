"""An answer to every request in Fischer's protocol: tachk, its own safety check, and TChecker on the same question.

    python bench/liveness.py 9
    python bench/liveness.py 8 9 --tck-liveness /path/to/tck-liveness

`P(1).request --> P(1).waiting` holds and `P(1).waiting --> P(1).critical` fails. TChecker looks for infinite runs that
visit a label again and again, so its network gets a location in which a process stays once it has guessed that it will
stay for ever; ends of runs it does not look for. The safety check is mutual exclusion, without exchanging processes:
a question about P(1) gains little by that. CPU seconds are those of the whole process with its start, by wait4;
`search` is the user time of the search alone.
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
SAFETY = "A[] forall (i : pid_t) forall (j : pid_t) P(i).critical && P(j).critical imply i == j"
QUESTIONS = {"request": "P(1).request --> P(1).waiting", "waiting": "P(1).waiting --> P(1).critical"}
"""The location in which a run would have to stay, and the question."""


@dataclass(frozen=True, slots=True)
class Measurement:
    """One program on one question: the median of its runs."""

    answer: str
    explored: int
    cpu_seconds: float
    search_seconds: float
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


def measure_tachk(processes: int, query: str) -> Measurement:
    """`tachk verify` of one query, without the run that shows it."""
    code = (
        f"import json, sys, tachk; model = tachk.load('models/classics/fischer.ta', N={processes}); "
        "options = tachk.Options().off('symmetry'); "
        "v = model.verify(sys.argv[1], trace=False, options=options).record.verdicts[0]; "
        "s = v.statistics; print(json.dumps([v.answer.value, s.states_explored, s.user_seconds]))"
    )
    os.chdir(ROOT)
    process = finished([sys.executable, "-c", code, query])
    answer, explored, seconds = json.loads(process.output)
    return Measurement(answer, explored, process.cpu_seconds, seconds, process.memory_bytes)


def staying(processes: int, location: str) -> str:
    """The network with a second copy of a location of the first process, which it never leaves."""
    invariant = f"invariant:x1<={DELAY} : " if location == "request" else ""
    network = tchecker_network(processes)
    return network + f"location:P1:ever{{{invariant}labels:ever}}\nedge:P1:{location}:ever:tau{{}}\n"


def measure_tchecker(tck_liveness: str, processes: int, location: str) -> Measurement:
    """`tck-liveness` with Couvreur's algorithm."""
    with tempfile.TemporaryDirectory() as folder:
        network = Path(folder) / "fischer.tck"
        network.write_text(staying(processes, location), encoding="utf-8")
        process = finished([tck_liveness, "-a", "couvscc", "-l", "ever", str(network)])
    values = dict(re.findall(r"^(\w+) (\S+)$", process.output, re.MULTILINE))
    answer = "fails" if values["CYCLE"] == "true" else "holds"
    return Measurement(answer, int(values["VISITED_STATES"]), process.cpu_seconds, 0.0, process.memory_bytes)


def row(processes: int, program: str, question: str, m: Measurement, of_safety: str) -> str:
    """One line of the table."""
    cells = (
        processes, program, question, m.answer, f"{m.explored:,}", f"{m.cpu_seconds:.2f}",
        f"{m.search_seconds:.2f}" if m.search_seconds else "-", f"{m.memory_bytes / 1e6:.0f}", of_safety,
    )  # fmt: skip
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def main() -> None:
    """Prints the table in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("processes", type=int, nargs="*", default=[9])
    parser.add_argument("--tck-liveness", default=os.environ.get("TCK_LIVENESS"), help="TChecker's program")
    parser.add_argument("--repeat", type=int, default=3, help="runs of each program; the median counts")
    arguments = parser.parse_args()
    print(f"load average {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores, median of {arguments.repeat}\n")
    print("| N | program | question | answer | explored | CPU s | search s | MB | of the safety check |")
    print("|---|---|---|---|---|---|---|---|---|")
    for n in arguments.processes:
        safety = median_of([measure_tachk(n, SAFETY) for _ in range(arguments.repeat)])
        print(row(n, "tachk", "mutual exclusion", safety, "1.00"))
        for location, query in QUESTIONS.items():
            mine = median_of([measure_tachk(n, query) for _ in range(arguments.repeat)])
            print(row(n, "tachk", query, mine, f"{mine.search_seconds / safety.search_seconds:.2f}"))
            if arguments.tck_liveness:
                theirs = [measure_tchecker(arguments.tck_liveness, n, location) for _ in range(arguments.repeat)]
                print(row(n, "TChecker", query, median_of(theirs), "-"))


if __name__ == "__main__":
    main()
