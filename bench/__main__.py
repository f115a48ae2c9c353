"""Speed and memory of tachk, beside other programs and beside earlier runs.

    python -m bench run
    python -m bench run --only fischer=9,10 fddi --tck-reach stock=/path/to/tck-reach tuned=/other/tck-reach
    python -m bench run --tchecker-examples /path/to/tchecker/examples --tck-reach stock=/path/to/tck-reach
    python -m bench run --against /path/to/another/checkout --repeat 5
    python -m bench zones --program build/bench/zone_operations

`run` generates each family at the given sizes and lets each program check the same network; the programs take turns.
CPU seconds are user and system time of whole processes by wait4, with their start: what others do on the machine adds
little to them. The exit status is 1 if two programs give different answers.

Every run is added to a history, and compared with the last one of the same machine there. `zones` measures the zone
operations one by one (bench/zone_operations.cpp, built with -D TACHK_BENCH=ON).
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from datetime import datetime
from pathlib import Path

from bench.families import OURS, ROOT, THEIRS, Instance
from bench.processes import finished
from bench.side_by_side import HEAD, Program, Row, compared, disagreement, lines, measure, stored


def machine() -> str:
    """The processor and how many cores there are."""
    text = Path("/proc/cpuinfo").read_text(encoding="utf-8") if Path("/proc/cpuinfo").exists() else ""
    names = [line.split(":", 1)[1].strip() for line in text.splitlines() if line.startswith("model name")]
    return f"{names[0] if names else platform.machine()}, {os.cpu_count()} cores"


def instances(
    only: Sequence[str], examples: Path | None, sizes: int | None, folder: Path, *, exported: bool
) -> Iterator[tuple[str, int, Instance]]:
    """Those asked for: families by name, each perhaps with its sizes, as in `fischer=9,10`."""
    wanted = [name.partition("=") for name in only] or [
        (name, "", "") for name in [*OURS, *(THEIRS if examples else ())]
    ]
    for name, _, given in wanted:
        if name not in OURS and name not in THEIRS:
            raise SystemExit(f"there is no family {name}: {', '.join([*OURS, *THEIRS])}")
        family = OURS[name] if name in OURS else THEIRS[name]
        for size in map(int, given.split(",")) if given else family.sizes[:sizes]:
            if name in OURS:
                yield name, size, OURS[name].instance(size, folder, exported=exported)
            elif examples is None:
                raise SystemExit(f"{name} needs --tchecker-examples")
            else:
                yield name, size, THEIRS[name].instance(size, folder, examples)


def programs(given: argparse.Namespace) -> list[Program]:
    found = [Program("tachk", options=tuple(given.option))]
    if given.against is not None:
        found.append(Program("tachk before", source=given.against / "src"))
    for text in given.tck_reach:
        name, _, executable = text.rpartition("=")
        found.append(Program(f"TChecker {name}".strip(), executable=executable))
    return found


def run(given: argparse.Namespace) -> int:
    print(f"{machine()}, load {os.getloadavg()[0]:.1f}, median of {given.repeat}, at most {given.seconds:g} s each\n")
    print("\n".join(HEAD))
    rows: list[Row] = []
    smaller: dict[str, dict[str, Row]] = {}
    wrong = False
    with tempfile.TemporaryDirectory() as folder:
        exported = bool(given.tck_reach)
        asked = instances(given.only, given.tchecker_examples, given.sizes, Path(folder), exported=exported)
        for name, size, instance in asked:
            measured = [
                measure(name, size, instance, program, given.repeat, given.seconds) for program in programs(given)
            ]
            found = [row for row in measured if row is not None]
            before = smaller.setdefault(name, {})
            print("\n".join(lines(found, measured[0], before)), flush=True)
            if (told := disagreement(found)) is not None:
                wrong = True
                print(f"    answers differ: {told}")
            before.update({row.program: row for row in found})
            rows += found
    remember(given.history, rows)
    return 1 if wrong else 0


def remember(path: Path, rows: Sequence[Row]) -> None:
    """Adds a run to the history; prints what has changed since the last one of this machine."""
    history = json.loads(path.read_text(encoding="utf-8")) if path.exists() else []
    earlier = [entry for entry in history if entry["machine"] == machine()]
    if earlier:
        print(f"\nSince {earlier[-1]['date']} ({earlier[-1]['commit']}):\n")
        print("\n".join(compared(rows, earlier[-1]["rows"])))
    described = subprocess.run(
        ["git", "describe", "--always", "--dirty"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    history.append(
        {
            "date": datetime.now().isoformat(timespec="minutes"),
            "machine": machine(),
            "load": round(os.getloadavg()[0], 1),
            "commit": described.stdout.strip(),
            "rows": stored(rows),
        }
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(history, indent=1) + "\n", encoding="utf-8")


def zones(given: argparse.Namespace) -> int:
    print(finished([str(given.program)]).output, end="")
    return 0


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="python -m bench", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    commands = parser.add_subparsers(required=True)
    families = commands.add_parser("run", help="families of networks, beside other programs")
    families.set_defaults(command=run)
    families.add_argument("--only", nargs="+", default=[], metavar="FAMILY[=SIZES]")
    families.add_argument("--sizes", type=int, help="of each family only so many sizes, the smallest ones")
    families.add_argument("--repeat", type=int, default=3, help="runs of each program; the median counts")
    families.add_argument("--seconds", type=float, default=60, help="CPU time that one run may take")
    families.add_argument("--option", action="append", default=[], help="an argument of `tachk verify`: --option=-D...")
    families.add_argument("--against", type=Path, metavar="FOLDER", help="another checkout of tachk")
    families.add_argument("--tck-reach", nargs="+", default=[], metavar="NAME=PATH", help="builds of TChecker")
    families.add_argument("--tchecker-examples", type=Path, metavar="FOLDER", help="with TChecker's generators")
    families.add_argument("--history", type=Path, default=ROOT / "build" / "bench_history.json", metavar="FILE")
    operations = commands.add_parser("zones", help="the zone operations one by one")
    operations.set_defaults(command=zones)
    operations.add_argument("--program", type=Path, default=ROOT / "build" / "bench" / "zone_operations")
    given = parser.parse_args()
    command: int = given.command(given)
    return command


if __name__ == "__main__":
    sys.exit(main())
