"""What a user of the Python package calls, beside the core and beside other Python packages.

    python bench/public_monitors.py
    python bench/public_monitors.py --python PYTHON_WITH_PEERS

`tachk.monitor` on a dictionary of arrays with times in seconds, `tachk.Monitor.update` with a dictionary for each row,
`tachk.Monitor.push` with a dictionary of arrays: from the text of the formula to the verdict. `tachk.monitor` explains
a verdict when it is asked to; what that takes is told where there is something to explain. The core gets a compiled
formula, and times that are ticks already. User CPU seconds; what is compared is measured in turn, and the median
counts. The shapes and the trace are those of bench/monitor_shapes.py.
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import tempfile
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import monitor_shapes as shapes
from monitors import COLUMNS, JOBS, Peers, feed_online, feed_single, heading, line, program_of, rate, shown, trace_of
from monitors import single_samples as ticked

import tachk
from tachk.recordings.traces.trace import Trace

CHUNKS = (100, 1000)
SINGLE = 200_000
"""Rows that are given one by one."""


def user_seconds(action: Callable[[], object], rounds: int) -> float:
    """User CPU seconds of one round."""
    begin = resource.getrusage(resource.RUSAGE_SELF).ru_utime
    for _ in range(rounds):
        action()
    return (resource.getrusage(resource.RUSAGE_SELF).ru_utime - begin) / rounds


def compared(user: Callable[[], object], core: Callable[[], object], repeat: int) -> tuple[float, float]:
    """Seconds of the user's call, and how many times those of the core."""
    rounds = [max(1, int(0.2 / max(user_seconds(action, 1), 1e-3))) for action in (user, core)]
    measured = [(user_seconds(user, rounds[0]), user_seconds(core, rounds[1])) for _ in range(repeat)]
    return statistics.median(a for a, _ in measured), statistics.median(a / b for a, b in measured)


def whole_part(rows: int, peers: Peers, repeat: int) -> None:
    """`tachk.monitor` on arrays."""
    print(f"\nWhole traces, {rows:,} rows, millions of rows for each CPU second, and times the CPU time of the core\n")
    heading("shape", "truth", "times the core", "robustness", "times the core", "rtamt, robustness")
    made = shapes.make_rows(rows)
    trace = trace_of(made)
    arrays = {"time": made.milliseconds / 1000, "x": made.x, "y": made.y, "z": made.z}
    explained = []
    for shape in shapes.NAMES:
        cells = []
        text, program = shapes.TACHK[shape].format(w=180), program_of(shape)
        for robustness in (False, True):
            call = partial(tachk.monitor, text, arrays, unit="s", robustness=robustness)
            job = partial(JOBS["offline robustness" if robustness else "offline truth"], program, trace)
            seconds, times = compared(call, job, repeat)
            cells += [rate(rows, seconds), f"{times:.2f}"]
        line(f"{shape} `{shapes.MEANINGS[shape]}`", *cells, shown(peers.measure("rtamt", "robustness", shape, rows)))
        judge = partial(tachk.monitor, text, arrays, unit="s", robustness=False)
        if judge()[0].truth is not tachk.Truth.TRUE:
            call, job = partial(explain, judge), partial(JOBS["offline truth"], program, trace)
            explained.append((shape, *compared(call, job, repeat)))
    for shape, seconds, times in explained:
        print(f"\n{shape}, truth with its explanation: {rate(rows, seconds)}, {times:.2f} times the core")


def explain(judge: Callable[[], tachk.MonitorReport]) -> None:
    """A report and all its explanations."""
    for verdict in judge():
        if verdict.finding is None:
            raise AssertionError("there is nothing to explain")


def growing_part(rows: int, peers: Peers, repeat: int) -> None:
    """`tachk.Monitor`, row by row and in chunks."""
    for robustness in (False, True):
        job = "robustness" if robustness else "truth"
        what = "bounds of the robustness" if robustness else "truth"
        print(f"\nGrowing traces, {rows:,} rows, {what}, millions of rows for each CPU second\n")
        ways = [cell for chunk in CHUNKS for cell in (f"push, {chunk:,} rows", "times the core")]
        heading("shape", "update", "times the core", *ways, "mstlo", "reelay")
        for shape in shapes.NAMES:
            cells = growing_cells(shape, trace_of(shapes.make_rows(rows)), robustness, repeat)
            line(shape, *cells, *(shown(peers.measure(tool, job, shape, rows)) for tool in ("mstlo", "reelay")))


def growing_cells(shape: str, trace: Trace, robustness: bool, repeat: int) -> list[str]:
    """Rates, each with how many times the CPU time of the core it takes."""
    program, text = program_of(shape), shapes.TACHK[shape].format(w=180)
    single = min(SINGLE, trace.rows)
    samples = ticked(program, trace)[:single]
    columns = {name: trace.columns[name][:single].tolist() for name in program.columns}
    events = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
    times = (trace.times[:single] / 1000).tolist()

    def update() -> None:
        feed = tachk.Monitor(text, unit="s", robustness=robustness).update
        for time, values in zip(times, events, strict=True):
            feed(time, values)

    seconds, ratio = compared(update, partial(feed_single, program, samples, robustness), repeat)
    cells = [rate(single, seconds), f"{ratio:.2f}"]
    for size in CHUNKS:
        core = partial(feed_online, program, trace, size, robustness)
        seconds, ratio = compared(partial(push, text, trace, size, robustness), core, repeat)
        cells += [rate(trace.rows, seconds), f"{ratio:.2f}"]
    return cells


def push(text: str, trace: Trace, size: int, robustness: bool) -> None:
    """The whole trace in chunks, which are cut as they are given."""
    monitor = tachk.Monitor(text, unit="s", robustness=robustness)
    columns = {name: trace.columns[name] for name in COLUMNS if name in monitor.columns}
    for begin in range(0, trace.rows, size):
        end = begin + size
        monitor.push(trace.times[begin:end], {name: values[begin:end] for name, values in columns.items()}, 3)


def main(arguments: Sequence[str] | None = None) -> None:
    """Prints the tables in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", help="a Python that has mstlo, reelay or rtamt")
    parser.add_argument("--rows", type=float, default=1e6)
    parser.add_argument("--repeat", type=int, default=3, help="measurements of each thing; the median counts")
    chosen = parser.parse_args(arguments)
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    print(f"load average {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores, median of {chosen.repeat}")
    with tempfile.TemporaryDirectory() as name:
        peers = Peers(chosen.python, None, Path(name), chosen.repeat)
        whole_part(int(chosen.rows), peers, chosen.repeat)
        growing_part(int(chosen.rows), peers, chosen.repeat)


if __name__ == "__main__":
    main()
