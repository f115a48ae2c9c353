"""``python -m tests.fuzz.run --inputs N --commands M --seed S``: does tachk answer whatever it is given?

N damaged files are given to each reader (readers.py), then M random command lines are run. Each runs in a child that
is bounded by processor time and memory. A finding is a status that no command should end with (70 above all), a
traceback, a warning of Python, a signal, no end, or more time or memory than the command's limits allow by a fifth.
Findings are kept as folders with the files and the command.
"""

from __future__ import annotations

import shlex
import sys
from argparse import ArgumentParser, BooleanOptionalAction
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice
from math import inf
from pathlib import Path
from random import Random
from time import monotonic

from tests.fuzz.commands import random_command
from tests.fuzz.readers import READERS
from tests.fuzz.worker import Case, Finding, prepare, run_all

BATCH = 100
"""How many cases one child runs."""
COMMANDS = "command lines"


@dataclass(slots=True)
class Tally:
    """What came of the cases of one reader."""

    cases: int = 0
    found: Counter[str] = field(default_factory=Counter)


def cases(reader: str, count: int, seed: int, first: int = 0) -> Iterator[tuple[str, Case]]:
    """The cases of a reader, or of random command lines, each with a name that says how to make it again."""
    for number in range(first, first + count):
        name = f"{reader.replace(' ', '-')}-{seed}-{number}"
        random = Random(name)
        if reader == COMMANDS:
            yield name, random_command(random)
        else:
            yield name, READERS[reader].case(random, READERS[reader].seeds())


def campaign(
    counts: dict[str, int], seed: int, only: Sequence[str], folder: Path, limits: bool, seconds: float
) -> dict[str, Tally]:
    """Runs so many cases of each reader until the time is over, and keeps the findings. The readers take turns."""
    end = monotonic() + seconds
    tallies = {reader: Tally() for reader in counts}
    prepare(case for reader in READERS.values() if reader.warms for case in reader.sound_cases(reader.seeds()[:1]))
    going = {reader: cases(reader, count, seed) for reader, count in counts.items()}
    while going:
        for reader, rest in list(going.items()):
            batch = list(islice(rest, BATCH)) if monotonic() < end else []
            if not batch:
                del going[reader]
            chosen = [(name, case) for name, case in batch if not only or name in only]
            if not limits:
                chosen = [(name, replace(case, seconds=None, memory=None)) for name, case in chosen]
            for (name, _), found in zip(chosen, run_all([case for _, case in chosen]), strict=True):
                tallies[reader].cases += 1
                if found is not None:
                    _keep(folder, name, found, tallies[reader])
    return tallies


def _keep(folder: Path, name: str, found: Finding, tally: Tally) -> None:
    tally.found[found.what] += 1
    command = f"tachk {shlex.join(found.case.arguments)}"
    if tally.found[found.what] <= 3:
        print(f"{name}: {found.what}\n    {command[:300]}", flush=True)
        (folder / name).mkdir(parents=True, exist_ok=True)
        for file, content in found.case.files.items():
            (folder / name / file).write_bytes(content)
        (folder / name / "command").write_text(f"{command}\n{found.what}\n\n{found.said}")


def main(arguments: Sequence[str] | None = None) -> int:
    parser = ArgumentParser(prog="python -m tests.fuzz.run", description=__doc__)
    parser.add_argument("--inputs", type=int, default=100, metavar="N", help="damaged files for each reader")
    parser.add_argument("--commands", type=int, default=500, metavar="M", help="random command lines")
    parser.add_argument("--reader", action="append", default=[], choices=[*READERS], help="this reader only")
    parser.add_argument("--seconds", type=float, default=inf, metavar="T", help="begin nothing new after this time")
    parser.add_argument("--limits", action=BooleanOptionalAction, default=True, help="judge time and memory, too")
    parser.add_argument("--seed", type=int, default=1, metavar="S")
    parser.add_argument("--only", action="append", default=[], metavar="NAME", help="this case, such as models-1-37")
    parser.add_argument("--folder", type=Path, default=Path("build/fuzz"), help="where findings are kept")
    given = parser.parse_args(arguments)
    counts = dict.fromkeys(given.reader or READERS, given.inputs) | {COMMANDS: given.commands}
    tallies = campaign(counts, given.seed, given.only, given.folder, given.limits, given.seconds)
    print(f"{'reader':<24} {'inputs':>9} {'findings':>9} {'different':>9}")
    for reader, tally in tallies.items():
        print(f"{reader:<24} {tally.cases:>9,} {tally.found.total():>9,} {len(tally.found):>9,}")
    total = sum(tally.found.total() for tally in tallies.values())
    print(f"{'all':<24} {sum(tally.cases for tally in tallies.values()):>9,} {total:>9,}")
    return 1 if total else 0


if __name__ == "__main__":
    sys.exit(main())
