"""Instances of families, checked by tachk and by others in turn: answers, states, memory, CPU time and their growth."""

from __future__ import annotations

import json
import re
import statistics
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path

from bench.families import Instance
from bench.processes import OutOfMemory, Stopped, finished, tachk

TCHECKER_SETTINGS = ("covreach bfs", "covreach dfs", "aLU-covreach bfs", "concur19 bfs", "reach bfs")
"""TChecker's algorithms and orders; what a program refuses is left out."""

TARZAN_SETTINGS = ("dfs", "bfs")

PATIENCE, AT_LEAST = 10.0, 3.0
"""Others are given up after so many times what tachk took, but not before so many seconds."""

ONCE = 3.0
"""What takes longer than this is measured once."""

OUT_OF_TIME, OUT_OF_MEMORY, GIVEN_UP = "out of time", "out of memory", "given up"
UNKNOWN, FAILED = "unknown", "ended with an error"
UNFINISHED = (OUT_OF_TIME, OUT_OF_MEMORY, GIVEN_UP, UNKNOWN, FAILED)


@dataclass(frozen=True, slots=True)
class Program:
    """Something that is measured.

    Attributes:
        name: in tables and histories.
        source: of a tachk, the folder that holds the package, where it is not the one that Python finds by itself.
        executable: TChecker's tck-reach, or TARZAN's driver; empty for a tachk.
        settings: with which the executable may be run; empty for a tachk.
        options: more arguments of `tachk verify`.
    """

    name: str
    source: Path | None = None
    executable: str = ""
    settings: tuple[str, ...] = ()
    options: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ResourceLimits:
    """What a run may take: CPU seconds, and bytes of address space; `whole` if no run may take more."""

    seconds: float
    memory: int | None = None
    whole: bool = True


@dataclass(frozen=True, slots=True)
class Row:
    """One program on one instance: the run with the median CPU time.

    Attributes:
        answer: whether the target is reached; why not, if that was not found out.
        setting: of another program the fastest of its settings.
        search_seconds: wall time of the search alone, where the program tells it.
        memory: largest resident set of the process, in bytes.
        search_memory: what the search says it took, in bytes.
    """

    family: str
    size: int
    program: str
    setting: str
    answer: str
    stored: int
    explored: int
    transitions: int
    cpu_seconds: float
    search_seconds: float
    memory: int
    search_memory: int

    @property
    def finished(self) -> bool:
        return self.answer not in UNFINISHED


@dataclass(slots=True)
class Contest:
    """Programs on the sizes of one family, from the smallest up.

    A program that has not finished one size is not asked about larger ones, unless tachk does not decide one. Of its
    settings the fastest goes on, and the second one if it took at most three times as long.
    """

    family: str
    repeat: int
    limits: ResourceLimits
    settings: dict[str, tuple[str, ...]] = field(default_factory=dict)
    ended: set[str] = field(default_factory=set)

    def measure(self, size: int, instance: Instance, programs: Sequence[Program]) -> list[Row]:
        """The rows of those that have words for the instance; those of tachk stand first if they do in `programs`."""
        rows: list[Row] = []
        for program in programs:
            undecided = bool(rows) and not rows[0].finished
            if program.name in self.ended and not (undecided and program.executable):
                continue
            if program.executable:
                ours = next((row.cpu_seconds for row in rows if row.finished), self.limits.seconds)
                seconds = min(self.limits.seconds, max(AT_LEAST, PATIENCE * ours))
                whole = seconds >= self.limits.seconds
                row = self._other(size, instance, program, ResourceLimits(seconds, self.limits.memory, whole))
            else:
                row = _repeated(partial(_by_tachk, self.family, size, instance, program, self.limits), self.repeat)
            if row is not None:
                rows.append(row)
                if not row.finished:
                    self.ended.add(program.name)
        return rows

    def _other(self, size: int, instance: Instance, program: Program, limits: ResourceLimits) -> Row | None:
        ask = _by_tarzan if program.settings == TARZAN_SETTINGS else _by_tchecker
        best = limits
        rows: list[Row] = []
        for setting in self.settings.get(program.name, program.settings):
            row = ask(self.family, size, instance, program, setting, best)
            if row is None:
                continue
            rows.append(row)
            if row.finished:
                best = ResourceLimits(min(best.seconds, max(1.0, 5 * row.cpu_seconds)), limits.memory, whole=False)
        done = sorted((row for row in rows if row.finished), key=lambda row: row.cpu_seconds)
        if not rows and program.name in self.settings:  # it had words for smaller sizes
            setting = self.settings[program.name][0]
            return _unfinished(self.family, size, program.name, setting, FAILED, Stopped(0.0, 0))
        if not done:
            return rows[0] if rows else None
        near = [row.setting for row in done if row.cpu_seconds <= 3 * max(done[0].cpu_seconds, 0.1)]
        self.settings[program.name] = tuple(near[:2])
        again = partial(ask, self.family, size, instance, program, done[0].setting, limits)
        return _repeated(again, self.repeat, done[0])


def _repeated(run: Callable[[], Row | None], repeat: int, first: Row | None = None) -> Row | None:
    """The row with the median CPU time; of one run if that takes long or does not finish."""
    first = run() if first is None else first
    if first is None or not first.finished or first.cpu_seconds > ONCE:
        return first
    rows = [first, *(row for row in (run() for _ in range(repeat - 1)) if row is not None)]
    middle = statistics.median_low([row.cpu_seconds for row in rows])
    return next(row for row in rows if row.cpu_seconds == middle)


def _by_tachk(family: str, size: int, instance: Instance, program: Program, limits: ResourceLimits) -> Row | None:
    command = tachk("verify", *instance.ours, "--format", "json", "--trace", "none", *program.options)
    try:
        process = finished(command, program.source, range(256), limits.seconds, limits.memory, told=False)
    except Stopped as spent:
        return _unfinished(family, size, program.name, "", _why(spent, limits), spent)
    try:
        results = json.loads(process.output)["runs"][0]["results"]
    except ValueError:
        error = Stopped(process.cpu_seconds, process.memory_bytes)
        return _unfinished(family, size, program.name, "", FAILED, error)
    if not results:
        return None
    result = results[0]
    found = result["stats"]
    if result["answer"] not in ("holds", "fails"):
        answer = UNKNOWN
    else:
        reached = (result["answer"] == "holds") == result["query"].startswith("E<>")
        answer = "reached" if reached else "not reached"
    return Row(
        family, size, program.name, "", answer,
        found["states_stored"], found["states_explored"], found["transitions"],
        process.cpu_seconds, found["seconds"], process.memory_bytes, found["peak_bytes"],
    )  # fmt: skip


def _by_tchecker(
    family: str, size: int, instance: Instance, program: Program, setting: str, limits: ResourceLimits
) -> Row | None:
    if instance.network is None:
        return None
    algorithm, order = setting.split()
    labels = () if instance.labels is None else ("-l", instance.labels)
    command = [program.executable, "-a", algorithm, "-s", order, *labels, str(instance.network)]
    try:
        process = finished(command, None, range(256), limits.seconds, limits.memory, told=False)
    except Stopped as spent:
        return _unfinished(family, size, program.name, setting, _why(spent, limits), spent)
    told: dict[str, str] = dict(re.findall(r"^(\w+) (\S+)$", process.output, re.MULTILINE))
    if "REACHABLE" not in told:
        return None
    return Row(
        family, size, program.name, setting, "reached" if told["REACHABLE"] == "true" else "not reached",
        int(told.get("STORED_STATES", told["VISITED_STATES"])), int(told["VISITED_STATES"]),
        int(told["VISITED_TRANSITIONS"]),
        process.cpu_seconds, float(told.get("RUNNING_TIME_SECONDS", 0)), process.memory_bytes, 0,
    )  # fmt: skip


def _by_tarzan(
    family: str, size: int, instance: Instance, program: Program, setting: str, limits: ResourceLimits
) -> Row | None:
    if instance.regions is None:
        return None
    command = [program.executable, str(instance.regions), setting, *instance.goals]
    try:
        statuses = {*range(256)} - {2}  # it could not read a file, which is an error of ours
        process = finished(command, None, statuses, limits.seconds, limits.memory, told=False)
    except Stopped as spent:
        return _unfinished(family, size, program.name, setting, _why(spent, limits), spent)
    told = re.search(r"Goal is (not reachable|reachable)\nNumber of regions: (\d+)", process.output)
    if told is None:
        return None
    answer, regions = "reached" if told.group(1) == "reachable" else "not reached", int(told.group(2))
    return Row(
        family, size, program.name, setting, answer, regions, regions, 0,
        process.cpu_seconds, 0.0, process.memory_bytes, 0,
    )  # fmt: skip


def _unfinished(family: str, size: int, program: str, setting: str, answer: str, spent: Stopped) -> Row:
    return Row(family, size, program, setting, answer, 0, 0, 0, spent.cpu_seconds, 0.0, spent.memory_bytes, 0)


def _why(spent: Stopped, limits: ResourceLimits) -> str:
    if isinstance(spent, OutOfMemory):
        return OUT_OF_MEMORY
    return OUT_OF_TIME if limits.whole else GIVEN_UP


HEAD = (
    "| family | size | program | answer | stored | explored | CPU s | search s (wall) | MB | B/state | grows | times |",
    "|---|---|---|---|---|---|---|---|---|---|---|---|",
)


def lines(rows: Sequence[Row], smaller: dict[str, Row]) -> Iterator[str]:
    """A line for each program on one instance.

    Args:
        rows: of the instance; the first one is compared with the others.
        smaller: of each program its row of the size before.
    """
    ours = rows[0]
    for row in rows:
        before = smaller.get(row.program)
        comparable = row.finished and before is not None and before.finished and before.stored and row.stored
        grows = ""
        if comparable and before is not None:
            grows = f"{(row.cpu_seconds / row.stored) / (before.cpu_seconds / before.stored):.2f}"
        bytes_a_state = f"{row.search_memory / row.stored:.0f}" if row.search_memory and row.stored else ""
        times = f"{row.cpu_seconds / ours.cpu_seconds:.2f}" if ours.finished else ""
        cells = (
            row.family, row.size, f"{row.program} {row.setting}".strip(), row.answer, f"{row.stored:,}",
            f"{row.explored:,}", f"{row.cpu_seconds:.2f}", f"{row.search_seconds:.2f}", f"{row.memory / 1e6:.0f}",
            bytes_a_state, grows, times,
        )  # fmt: skip
        yield "| " + " | ".join(str(cell) for cell in cells) + " |"


def disagreement(rows: Sequence[Row]) -> str | None:
    """What is wrong if programs give different answers."""
    answers = {row.answer for row in rows if row.finished}
    if len(answers) < 2:
        return None
    return "; ".join(f"{row.program}: {row.answer}" for row in rows if row.finished)


def stored(rows: Sequence[Row]) -> list[dict[str, object]]:
    """For a history."""
    return [asdict(row) for row in rows]


def compared(rows: Sequence[Row], before: Sequence[dict[str, object]]) -> Iterator[str]:
    """What has changed since an earlier run: rows of the same instances with their ratios of CPU time and memory."""
    known = {(row["family"], row["size"], row["program"]): row for row in before}
    yield "| family | size | program | CPU s before | CPU s | ratio | MB before | MB | stored before | stored |"
    yield "|---|---|---|---|---|---|---|---|---|---|"
    for row in rows:
        old = known.get((row.family, row.size, row.program))
        if old is None or old["answer"] not in ("reached", "not reached") or not row.finished:
            continue
        seconds, memory = float(str(old["cpu_seconds"])), int(str(old["memory"]))
        yield (
            f"| {row.family} | {row.size} | {row.program} | {seconds:.2f} | {row.cpu_seconds:.2f} | "
            f"{row.cpu_seconds / seconds:.2f} | {memory / 1e6:.0f} | {row.memory / 1e6:.0f} | {old['stored']:,} | "
            f"{row.stored:,} |"
        )
