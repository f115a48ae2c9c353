"""Speed and memory of tachk, beside other programs and beside earlier runs.

    python -m bench run
    python -m bench run --only fischer=9,10 fddi --tck-reach stock=/path/to/tck-reach tuned=/other/tck-reach
    python -m bench run --tchecker-examples /path/to/tchecker/examples --tck-reach stock=/path/to/tck-reach \\
        --tarzan stock=/path/to/tarzan_reach --memory 3 --output RESULT.json
    python -m bench page RESULT.json
    python -m bench run --against /path/to/another/checkout --repeat 5
    python -m bench zones --program build/bench/zone_operations

`run` generates each family at the given sizes and lets each program check the same network; the programs take turns.
CPU seconds are user and system time of whole processes by wait4, with their start: what others do on the machine adds
little to them. The exit status is 1 if two programs give different answers.

Every run is added to a history, and compared with the last one of the same machine there. `page` writes tables, curves
and losses from a stored run into docs/performance.md. `zones` measures the zone operations one by one
(bench/zone_operations.cpp, built with -D TACHK_BENCH=ON).
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from datetime import datetime
from importlib.metadata import version
from pathlib import Path

from bench import stored_runs
from bench.families import GROUPS, OURS, ROOT, TCHECKER, Instance
from bench.page import write
from bench.processes import finished
from bench.side_by_side import (
    HEAD,
    TARZAN_SETTINGS,
    TCHECKER_SETTINGS,
    Contest,
    Program,
    ResourceLimits,
    Row,
    compared,
    disagreement,
    lines,
    stored,
)
from bench.stored_runs import StoredRun


def machine() -> str:
    """The processor and how many cores there are."""
    text = Path("/proc/cpuinfo").read_text(encoding="utf-8") if Path("/proc/cpuinfo").exists() else ""
    names = [line.split(":", 1)[1].strip() for line in text.splitlines() if line.startswith("model name")]
    return f"{names[0] if names else platform.machine()}, {os.cpu_count()} cores"


def families(only: Sequence[str], sizes: int | None, *, theirs: bool) -> Iterator[tuple[str, tuple[int, ...]]]:
    """Those asked for, with their sizes: families by name, each perhaps with its sizes, as in `fischer=9,10`."""
    known = {name: family.sizes for group in GROUPS.values() for name, family in group.items()}
    wanted = [name.partition("=") for name in only] or [
        (name, "", "") for name in known if theirs or name not in TCHECKER
    ]
    for name, _, given in wanted:
        if name not in known:
            raise SystemExit(f"there is no family {name}: {', '.join(known)}")
        yield name, tuple(map(int, given.split(","))) if given else known[name][:sizes]


def instance(name: str, size: int, examples: Path | None, folder: Path, *, exported: bool) -> Instance:
    if name in OURS:
        return OURS[name].instance(size, folder, exported=exported)
    if examples is None:
        raise SystemExit(f"{name} needs --tchecker-examples")
    return TCHECKER[name].instance(size, folder, examples)


def programs(given: argparse.Namespace) -> list[Program]:
    found = [Program("tachk", options=tuple(given.option))]
    if given.against is not None:
        found.append(Program("tachk before", source=given.against / "src"))
    for texts, program, settings in (
        (given.tck_reach, "TChecker", TCHECKER_SETTINGS),
        (given.tarzan, "TARZAN", TARZAN_SETTINGS),
    ):
        for text in texts:
            name, _, executable = text.rpartition("=")
            found.append(Program(f"{program} {name}".strip(), executable=executable, settings=settings))
    return found


def run(given: argparse.Namespace) -> int:
    print(f"{machine()}, load {os.getloadavg()[0]:.1f}, median of {given.repeat}, at most {given.seconds:g} s each\n")
    print("\n".join(HEAD))
    rows: list[Row] = []
    wrong: list[str] = []
    commit = described_commit()
    exported = bool(given.tck_reach or given.tarzan)
    limits = ResourceLimits(given.seconds, int(given.memory * 1e9) if given.memory else None)
    for name, sizes in families(given.only, given.sizes, theirs=given.tchecker_examples is not None):
        contest = Contest(name, given.repeat, limits)
        smaller: dict[str, Row] = {}
        for size in sizes:
            with tempfile.TemporaryDirectory() as folder:
                asked = instance(name, size, given.tchecker_examples, Path(folder), exported=exported)
                found = contest.measure(size, asked, programs(given))
            if not found:
                break
            print("\n".join(lines(found, smaller)), flush=True)
            if (told := disagreement(found)) is not None:
                wrong.append(f"{name} {size}: {told}")
                print(f"    answers differ: {told}", flush=True)
            smaller.update({row.program: row for row in found})
            rows += found
            if not found[0].finished:
                break
        if given.output is not None:
            now = datetime.now().isoformat(timespec="minutes")
            done = StoredRun(now, machine(), commit, given.seconds, given.memory, given.repeat, tuple(rows))
            stored_runs.write(done, given.output)
    for told in wrong:
        print(f"answers differ: {told}")
    remember(given.history, rows)
    return 1 if wrong else 0


def remember(path: Path, rows: Sequence[Row]) -> None:
    """Adds a run to the history; prints what has changed since the last one of this machine."""
    history = json.loads(path.read_text(encoding="utf-8")) if path.exists() else []
    earlier = [entry for entry in history if entry["machine"] == machine()]
    if earlier:
        print(f"\nSince {earlier[-1]['date']} ({earlier[-1]['commit']}):\n")
        print("\n".join(compared(rows, earlier[-1]["rows"])))
    history.append(
        {
            "date": datetime.now().isoformat(timespec="minutes"),
            "machine": machine(),
            "load": round(os.getloadavg()[0], 1),
            "commit": described_commit(),
            "rows": stored(rows),
        }
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(history, indent=1) + "\n", encoding="utf-8")


def described_commit() -> str:
    """Of the checkout; the version of tachk where there is no git."""
    if shutil.which("git") is None:
        return version("tachk")
    command = ["git", "describe", "--always", "--dirty"]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False).stdout.strip()


def page(given: argparse.Namespace) -> int:
    write(stored_runs.read(given.result), given.output)
    return 0


def zones(given: argparse.Namespace) -> int:
    print(finished([str(given.program)]).output, end="")
    return 0


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="python -m bench", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    commands = parser.add_subparsers(required=True)
    run_parser = commands.add_parser("run", help="families of networks, beside other programs")
    run_parser.set_defaults(command=run)
    run_parser.add_argument("--only", nargs="+", default=[], metavar="FAMILY[=SIZES]")
    run_parser.add_argument("--sizes", type=int, help="of each family only so many sizes, the smallest ones")
    run_parser.add_argument("--repeat", type=int, default=3, help="runs of each program; the median counts")
    run_parser.add_argument("--seconds", type=float, default=60, help="CPU time that one run may take")
    run_parser.add_argument("--memory", type=float, help="address space that one run may have, in GB")
    run_parser.add_argument("--option", action="append", default=[], help="for `tachk verify`: --option=-D...")
    run_parser.add_argument("--against", type=Path, metavar="FOLDER", help="another checkout of tachk")
    run_parser.add_argument("--tck-reach", nargs="+", default=[], metavar="NAME=PATH", help="builds of TChecker")
    run_parser.add_argument("--tarzan", nargs="+", default=[], metavar="NAME=PATH", help="builds of tarzan_reach.cpp")
    run_parser.add_argument("--tchecker-examples", type=Path, metavar="FOLDER", help="with TChecker's generators")
    run_parser.add_argument("--history", type=Path, default=ROOT / "build" / "bench_history.json", metavar="FILE")
    run_parser.add_argument("--output", type=Path, metavar="FILE", help="the run as JSON, for a page")
    pages = commands.add_parser("page", help="the generated part of docs/performance.md, from a stored run")
    pages.set_defaults(command=page)
    pages.add_argument("result", type=Path, metavar="RESULT", help="what `run --output` has written")
    pages.add_argument("--output", "-o", type=Path, default=ROOT / "docs" / "performance.md", metavar="FILE")
    operations = commands.add_parser("zones", help="the zone operations one by one")
    operations.set_defaults(command=zones)
    operations.add_argument("--program", type=Path, default=ROOT / "build" / "bench" / "zone_operations")
    given = parser.parse_args()
    command: int = given.command(given)
    return command


if __name__ == "__main__":
    sys.exit(main())
