"""Instances of families, checked by tachk and by others in turn: answers, states, memory, CPU time and their growth."""

from __future__ import annotations

import json
import re
import statistics
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from bench.families import Instance
from bench.processes import TimeOut, finished, tachk

SETTINGS = (("covreach", "bfs"), ("covreach", "dfs"), ("aLU-covreach", "bfs"), ("concur19", "bfs"), ("reach", "bfs"))
"""TChecker's algorithms and orders; what a program refuses is left out."""


@dataclass(frozen=True, slots=True)
class Program:
    """Something that is measured.

    Attributes:
        name: in tables and histories.
        source: of a tachk, the folder that holds the package, where it is not the one that Python finds by itself.
        executable: of a TChecker its tck-reach; empty for a tachk.
        options: more arguments of `tachk verify`.
    """

    name: str
    source: Path | None = None
    executable: str = ""
    options: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Row:
    """One program on one instance: the run with the median CPU time.

    Attributes:
        answer: whether the target is reached; "out of time" if that was not found out.
        setting: of TChecker the fastest of its algorithms.
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
        return self.answer != OUT_OF_TIME


OUT_OF_TIME = "out of time"


def measure(family: str, size: int, instance: Instance, program: Program, repeat: int, seconds: float) -> Row | None:
    """None where the program has no words for the instance."""
    if not program.executable:
        ours = [_by_tachk(family, size, instance, program, seconds) for _ in range(repeat)]
        return _median([row for row in ours if row is not None])
    if instance.network is None:
        return None
    rows = []
    for algorithm, order in SETTINGS:
        best = min((row.cpu_seconds for row in rows if row.finished), default=seconds)
        if (row := _by_tchecker(family, size, instance, program, (algorithm, order), best)) is not None:
            rows.append(row)
    done = [row for row in rows if row.finished]
    if not done:
        return rows[0] if rows else None
    fastest = min(done, key=lambda row: row.cpu_seconds)
    algorithm, order = fastest.setting.split()
    again = (_by_tchecker(family, size, instance, program, (algorithm, order), seconds) for _ in range(repeat - 1))
    return _median([fastest, *(row for row in again if row is not None)])


def _median(rows: Sequence[Row]) -> Row | None:
    if not rows:
        return None
    middle = statistics.median_low([row.cpu_seconds for row in rows])
    return next(row for row in rows if row.cpu_seconds == middle)


def _by_tachk(family: str, size: int, instance: Instance, program: Program, seconds: float) -> Row | None:
    command = tachk("verify", *instance.ours, "--format", "json", "--trace", "none", *program.options)
    try:
        process = finished(command, program.source, range(256), seconds, told=False)
    except TimeOut as spent:
        return _unfinished(family, size, program.name, "", spent)
    results = json.loads(process.output)["runs"][0]["results"]
    if not results:
        return None
    result = results[0]
    found = result["stats"]
    reached = (result["answer"] == "holds") == result["query"].startswith("E<>")
    return Row(
        family, size, program.name, "", "reached" if reached else "not reached",
        found["states_stored"], found["states_explored"], found["transitions"],
        process.cpu_seconds, found["seconds"], process.memory_bytes, found["peak_bytes"],
    )  # fmt: skip


def _by_tchecker(
    family: str, size: int, instance: Instance, program: Program, setting: tuple[str, str], seconds: float
) -> Row | None:
    algorithm, order = setting
    labels = () if instance.labels is None else ("-l", instance.labels)
    command = [program.executable, "-a", algorithm, "-s", order, *labels, str(instance.network)]
    try:
        process = finished(command, None, range(256), seconds, told=False)
    except TimeOut as spent:
        return _unfinished(family, size, program.name, " ".join(setting), spent)
    told = dict(re.findall(r"^(\w+) (\S+)$", process.output, re.MULTILINE))
    if "REACHABLE" not in told:
        return None
    return Row(
        family, size, program.name, " ".join(setting), "reached" if told["REACHABLE"] == "true" else "not reached",
        int(told.get("STORED_STATES", told["VISITED_STATES"])), int(told["VISITED_STATES"]),
        int(told["VISITED_TRANSITIONS"]),
        process.cpu_seconds, float(told.get("RUNNING_TIME_SECONDS", 0)), process.memory_bytes, 0,
    )  # fmt: skip


def _unfinished(family: str, size: int, program: str, setting: str, spent: TimeOut) -> Row:
    return Row(family, size, program, setting, OUT_OF_TIME, 0, 0, 0, spent.cpu_seconds, 0.0, spent.memory_bytes, 0)


HEAD = (
    "| family | size | program | answer | stored | explored | CPU s | search s (wall) | MB | B/state | grows | times |",
    "|---|---|---|---|---|---|---|---|---|---|---|---|",
)


def lines(rows: Sequence[Row], ours: Row | None, smaller: dict[str, Row]) -> Iterator[str]:
    """A line for each program on one instance.

    Args:
        rows: of the instance.
        ours: that of the tachk that is measured; None if it has no words for the instance.
        smaller: of each program its row of the size before.
    """
    for row in rows:
        before = smaller.get(row.program)
        comparable = row.finished and before is not None and before.finished and before.stored and row.stored
        grows = ""
        if comparable and before is not None:
            grows = f"{(row.cpu_seconds / row.stored) / (before.cpu_seconds / before.stored):.2f}"
        bytes_a_state = f"{row.search_memory / row.stored:.0f}" if row.search_memory and row.stored else ""
        times = f"{row.cpu_seconds / ours.cpu_seconds:.2f}" if ours is not None and ours.finished else ""
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
        if old is None or old["answer"] == OUT_OF_TIME or not row.finished:
            continue
        seconds, memory = float(str(old["cpu_seconds"])), int(str(old["memory"]))
        yield (
            f"| {row.family} | {row.size} | {row.program} | {seconds:.2f} | {row.cpu_seconds:.2f} | "
            f"{row.cpu_seconds / seconds:.2f} | {memory / 1e6:.0f} | {row.memory / 1e6:.0f} | {old['stored']:,} | "
            f"{row.stored:,} |"
        )
