"""``python -m tests.fuzz.run --inputs N --commands M --seed S``: does tachk answer whatever it is given?

Every case runs in a process of its own, bounded by processor time. A finding is a status that no command should end
with (70 above all), a traceback, a signal, or no end. Findings are kept as folders with the files and the command.
"""

from __future__ import annotations

import argparse
import shlex
import sys
from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path
from random import Random

from tests.fuzz.commands import random_command
from tests.fuzz.inputs import random_input, sound_cases
from tests.fuzz.worker import Case, Finding, prepare, run_all

BATCH = 40
"""How many cases one child runs."""


def cases(inputs: int, commands: int, seed: int) -> Iterator[tuple[str, Case]]:
    """The cases, each with a name that says how to make it again."""
    for number in range(inputs):
        yield f"input-{seed}-{number}", random_input(Random(f"input {seed} {number}"))
    for number in range(commands):
        yield f"command-{seed}-{number}", random_command(Random(f"command {seed} {number}"))


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz.run", description=__doc__)
    parser.add_argument("--inputs", type=int, default=2000, metavar="N", help="damaged inputs")
    parser.add_argument("--commands", type=int, default=500, metavar="M", help="random command lines")
    parser.add_argument("--seed", type=int, default=1, metavar="S")
    parser.add_argument("--only", action="append", default=[], metavar="NAME", help="this case, such as input-1-37")
    parser.add_argument("--folder", type=Path, default=Path("build/fuzz"), help="where findings are kept")
    given = parser.parse_args(arguments)
    prepare(sound_cases())
    chosen = (
        (name, case)
        for name, case in cases(given.inputs, given.commands, given.seed)
        if not given.only or name in given.only
    )
    count, seen = 0, dict[str, int]()
    while batch := list(islice(chosen, BATCH)):
        for (name, _), found in zip(batch, run_all([case for _, case in batch]), strict=True):
            count += 1
            if found is not None:
                seen[found.what] = seen.get(found.what, 0) + 1
                _keep(given.folder / name, found)
                if seen[found.what] <= 3:
                    print(f"{name}: {found.what}\n    tachk {shlex.join(found.case.arguments)}", flush=True)
            if count % 1000 == 0:
                print(f"{count} cases, {sum(seen.values())} findings", flush=True)
    print(f"{count} cases, {sum(seen.values())} findings, {len(seen)} different")
    return 1 if seen else 0


def _keep(folder: Path, found: Finding) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in found.case.files.items():
        (folder / name).write_bytes(content)
    (folder / "command").write_text(f"tachk {shlex.join(found.case.arguments)}\n{found.what}\n\n{found.said}")


if __name__ == "__main__":
    sys.exit(main())
