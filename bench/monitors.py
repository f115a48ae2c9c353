"""Monitors: tachk and, where they are at hand, stlrom, reelay, RTAMT and MoonLight on the same traces in one run.

    python bench/monitors.py
    python bench/monitors.py --python PYTHON_WITH_PEERS --reelay-bench DRIVER
    python bench/monitors.py --parts length csv

The shapes and the trace are those of bench/monitor_shapes.py: three columns of numbers, irregular instants, dense time.
All shapes hold on the trace, so that everybody reads all of it; answers are compared. CPU seconds are user and system
time: of the monitoring alone where the samples are in memory already, of the whole process where a file is read.

The driver of reelay's C++ headers is a program `DRIVER dense|robust FORMULA FILE` that feeds a file of rows of four
doubles (time, x, y, z) and prints `... SECONDS s ...`; without one, reelay's Python package is measured only. What
tachk's online monitor is called from C++ is `online_feed`, which CMake builds with -D TACHK_BENCH=ON.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from time import process_time

import monitor_shapes as shapes
import numpy as np
from processes import finished

import tachk
from tachk.recordings.monitors.compiler import compile as compile_formula
from tachk.recordings.monitors.formulas import in_trace_units, read_formulas
from tachk.recordings.traces.core_monitor import monitor_robustness, monitor_truth
from tachk.recordings.traces.monitor_program import MonitorProgram
from tachk.recordings.traces.online_monitor import OnlineMonitor
from tachk.recordings.traces.trace import Trace

COLUMNS = ("x", "y", "z")
REFERENCE_LOOP = 0.55
"""CPU seconds of the calibration loop on the machine that goals were set on."""

CHUNK = 1000
"""Samples of one call, where online monitors take more than one."""

PEER_ROWS = {"stlrom": None, "reelay": 100_000, "moonlight": 100_000, "rtamt": 10_000, "mstlo": 10_000}
"""At most so many rows: those given on the command line, or fewer where a run would take minutes."""

DRIVER_ROWS = {"truth": None, "robustness": 100_000}
"""The same for the driver of reelay's C++ headers."""


def calibrate() -> float:
    """CPU seconds of five million rounds of a counting loop, as the top level of a script runs it."""
    loop = compile("count = 0\nwhile count < 5_000_000:\n    count += 1\n", "loop", "exec")
    begin = process_time()
    exec(loop, {})
    return process_time() - begin


def cpu_of(action: Callable[[], object], repeat: int) -> float:
    """The median CPU seconds of an action; short ones are run several times for each measurement."""
    begin = process_time()
    action()
    rounds = max(1, int(0.1 / max(process_time() - begin, 1e-5)))
    measured = []
    for _ in range(repeat):
        begin = process_time()
        for _ in range(rounds):
            action()
        measured.append((process_time() - begin) / rounds)
    return statistics.median(measured)


# ---- tachk ----


def trace_of(rows: shapes.Rows) -> Trace:
    """As the readers of files make it."""
    times = rows.milliseconds
    return Trace("trace", times, {"x": rows.x, "y": rows.y, "z": rows.z}, int(times[-1]), 1000, "s")


def program_of(shape: str, window: int = 180) -> MonitorProgram:
    """The compiled formula."""
    named = read_formulas(shapes.TACHK[shape].format(w=window))[0]
    return compile_formula(in_trace_units(named, COLUMNS, "s"), COLUMNS, 1000)


def feed_online(program: MonitorProgram, trace: Trace, chunk: int, robustness: bool) -> OnlineMonitor:
    """The monitor after the whole trace, still open."""
    monitor = OnlineMonitor(program, robustness=robustness)
    columns = [trace.columns[name] for name in program.columns]
    for begin in range(0, len(trace.times), chunk):
        end = begin + chunk
        monitor.push(trace.times[begin:end], [column[begin:end] for column in columns])
    return monitor


def feed_single(program: MonitorProgram, samples: Sequence[tuple[int, Sequence[float]]], robustness: bool) -> None:
    """One call of Python for each sample."""
    update = OnlineMonitor(program, robustness=robustness).update
    for time, values in samples:
        update(time, values)


def write_program(program: MonitorProgram, path: Path) -> None:
    """For bench/online_feed.cpp."""
    words: list[float] = [len(program.columns), len(program.atoms), len(program.nodes)]
    for atom in program.atoms:
        words.append(int(atom.relation))
        for code in (atom.left, atom.right):
            words.append(len(code))
            for instruction in code:
                words += [int(instruction.operator), instruction.operand]
    for node in program.nodes:
        words += [int(node.kind), max(node.atom, 0), node.lower, node.upper, int(node.lower_closed)]
        words += [int(node.upper_closed), len(node.operands), *node.operands]
    path.write_text(" ".join(repr(word) for word in words) + "\n")


def feed_from_cpp(online_feed: str, program: MonitorProgram, rows: Path, kind: str) -> float:
    """CPU seconds of one sample a call, without Python. Raises CalledProcessError."""
    path = rows.with_suffix(".program")
    write_program(program, path)
    command = [online_feed, str(path), str(rows), "".join(program.columns), kind]
    output = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    return float(output.split()[2])


def single_samples(program: MonitorProgram, trace: Trace) -> list[tuple[int, Sequence[float]]]:
    """What `feed_single` takes, made beforehand."""
    columns = [trace.columns[name].tolist() for name in program.columns]
    return list(zip(trace.times.tolist(), zip(*columns, strict=True), strict=True))


JOBS: Mapping[str, Callable[[MonitorProgram, Trace], object]] = {
    "offline robustness": monitor_robustness,
    "offline truth": monitor_truth,
    "online bounds": lambda program, trace: feed_online(program, trace, CHUNK, robustness=True),
    "online truth": lambda program, trace: feed_online(program, trace, CHUNK, robustness=False),
}


# ---- the others ----


@dataclass(frozen=True, slots=True)
class Peer:
    """What one tool did: CPU seconds for a number of rows, and its answer; or why there is neither."""

    tool: str
    rows: int = 0
    cpu: float = 0.0
    answer: float | None = None
    missing: str = ""

    @property
    def rate(self) -> float:
        return self.rows / self.cpu


@dataclass(slots=True)
class Peers:
    """The other monitors that are at hand.

    Attributes:
        python: a Python with their packages; None: there are none.
        reelay_bench: the driver of reelay's C++ headers.
        folder: where tables of samples are kept for them.
    """

    python: str | None
    reelay_bench: str | None
    folder: Path
    repeat: int
    absent: set[str] = field(default_factory=set)

    def measure(self, tool: str, job: str, shape: str, rows: int) -> Peer:
        """The median of the runs of a Python package; one run where that takes more than ten seconds."""
        if self.python is None or tool in self.absent:
            return Peer(tool, missing="not at hand")
        rows = min(rows, PEER_ROWS[tool] or rows)
        script = Path(__file__).with_name("monitor_peers.py")
        runs: list[Peer] = []
        while len(runs) < self.repeat and sum(run.cpu for run in runs) < 10:
            done = subprocess.run(
                [self.python, str(script), tool, job, shape, str(self.table(rows))], capture_output=True, text=True
            )
            if done.returncode != 0:
                return Peer(tool, missing="fails: " + (done.stderr.strip().splitlines() or ["?"])[-1][:60])
            answer = json.loads(done.stdout.splitlines()[-1])
            if "missing" in answer:
                if "installed" in answer["missing"]:
                    self.absent.add(tool)
                return Peer(tool, missing=answer["missing"])
            runs.append(Peer(tool, rows, answer["cpu"], answer["answer"]))
        return sorted(runs, key=lambda run: run.cpu)[(len(runs) - 1) // 2]

    def measure_driver(self, job: str, shape: str, rows: int) -> Peer:
        """The same for reelay's C++ headers."""
        if self.reelay_bench is None:
            return Peer("reelay C++", missing="not at hand")
        mode = "dense" if job == "truth" else "robust"
        rows = min(rows, DRIVER_ROWS[job] or rows)
        plain = self.plain_table(rows)
        measured: list[float] = []
        while len(measured) < self.repeat and sum(measured) < 10:
            done = subprocess.run(
                [self.reelay_bench, mode, shapes.REELAY[shape], str(plain)], capture_output=True, text=True, check=True
            )
            found = re.search(r"([\d.]+) s\b", done.stdout)
            if found is None:
                raise RuntimeError(f"{self.reelay_bench} printed no time: {done.stdout}")
            measured.append(float(found[1]))
        return Peer("reelay C++", rows, statistics.median_low(measured))

    def table(self, rows: int) -> Path:
        """The file of a trace."""
        path = self.folder / f"{rows}.npy"
        if not path.exists():
            np.save(path, shapes.make_rows(rows).table())
        return path

    def plain_table(self, rows: int) -> Path:
        """The same without a header."""
        path = self.folder / f"{rows}.bin"
        if not path.exists():
            np.load(self.table(rows)).tofile(path)
        return path


# ---- tables ----


def heading(*cells: str) -> None:
    print("| " + " | ".join(cells) + " |")
    print("|" + "---|" * len(cells), flush=True)


def line(*cells: str) -> None:
    print("| " + " | ".join(cells) + " |", flush=True)


def rate(samples: float, cpu: float) -> str:
    """Millions of samples for each CPU second."""
    value = samples / cpu / 1e6
    return f"{value:.3f}" if value < 0.1 else f"{value:.2f}" if value < 10 else f"{value:.0f}"


def shown(peer: Peer) -> str:
    return f"- ({peer.missing})" if peer.missing else rate(peer.rows, peer.cpu)


def compared(speed: float, peers: Sequence[Peer]) -> str:
    """How many times faster than the fastest of them."""
    present = [peer for peer in peers if not peer.missing]
    if not present:
        return "-"
    best = max(present, key=lambda peer: peer.rate)
    return f"{speed / best.rate:.0f} ({best.tool})"


def offline_part(job: str, rows: int, peers: Peers, repeat: int) -> None:
    """tachk and everybody else on whole traces."""
    tools = ["stlrom", "reelay", "moonlight", "rtamt"] if job == "robustness" else ["reelay", "moonlight"]
    print(f"\nOffline {job}, {rows:,} rows ({sizes(tools)}), millions of samples for each CPU second\n")
    heading("shape", "tachk", "reelay C++", *tools, "times the fastest", *(["times RTAMT"] if "rtamt" in tools else []))
    trace = trace_of(shapes.make_rows(rows))
    wrong: list[str] = []
    for shape in shapes.NAMES:
        program = program_of(shape)
        cpu = cpu_of(partial(JOBS[f"offline {job}"], program, trace), repeat)
        driver = peers.measure_driver(job, shape, rows)
        others = [peers.measure(tool, job, shape, rows) for tool in tools]
        wrong += [text for peer in others if (text := disagreement(peer, job, shape))]
        rtamt = [compared(rows / cpu, others[-1:]).split(" ")[0]] if "rtamt" in tools else []
        fastest = compared(rows / cpu, [driver, *others])
        line(
            f"{shape} `{shapes.MEANINGS[shape]}`", rate(rows, cpu), shown(driver), *map(shown, others), fastest, *rtamt
        )
    for text in wrong:
        print(f"\n{text}")


def sizes(tools: Sequence[str]) -> str:
    """Which tools get fewer rows."""
    fewer = {f"{tool} {PEER_ROWS[tool]:,}": None for tool in tools if PEER_ROWS[tool] is not None}
    return ", ".join(fewer)


def disagreement(peer: Peer, job: str, shape: str) -> str | None:
    """What an answer is if it is none that a continuation of the trace has."""
    if peer.answer is None:
        return None
    trace = trace_of(shapes.make_rows(peer.rows))
    program = program_of(shape)
    if job == "truth":
        verdict = monitor_truth(program, trace).verdict
        right = int(verdict) == 2 or int(verdict) == int(peer.answer)
        expected = verdict.word
    else:
        robustness = monitor_robustness(program, trace)
        right = robustness.low - 1e-9 <= peer.answer <= robustness.high + 1e-9
        expected = (
            f"{robustness.low:g}" if robustness.low == robustness.high else f"{robustness.low:g} .. {robustness.high:g}"
        )
    return None if right else f"{peer.tool} on {shape}, {peer.rows:,} rows: {peer.answer:g} where tachk has {expected}"


def online_part(rows: int, peers: Peers, online_feed: str | None, repeat: int, scale: float) -> None:
    """Sample by sample, from C++ and from Python, and in chunks."""
    trace = trace_of(shapes.make_rows(rows))
    for kind in ("truth", "bounds"):
        print(f"\nOnline {kind}, {rows:,} rows, millions of samples for each CPU second\n")
        ways = ["C++, 1 row a call", "Python, 1 row a call", "100 rows", f"{CHUNK:,} rows"]
        if kind == "truth":
            heading("shape", *ways, "reelay C++, 1 row a call", *(f"{way}, times reelay" for way in ("C++", "Python")))
        else:
            heading("shape", *ways, *(f"on the reference machine: {way}" for way in (ways[0], ways[-1])))
        for shape in shapes.NAMES:
            program = program_of(shape)
            speeds = online_speeds(program, trace, kind, peers, online_feed, repeat)
            cells = ["-" if speed is None else rate(speed, 1) for speed in speeds]
            if kind == "truth":
                driver = peers.measure_driver("truth", shape, rows)
                cells.append(shown(driver))
                known = [None if driver.missing else speed for speed in speeds[:2]]
                cells += ["-" if speed is None else f"{speed / driver.rate:.1f}" for speed in known]
            else:
                ends = (speeds[0], speeds[-1])
                cells += ["-" if speed is None else rate(speed * scale, 1) for speed in ends]
            line(shape, *cells)


def online_speeds(
    program: MonitorProgram, trace: Trace, kind: str, peers: Peers, online_feed: str | None, repeat: int
) -> list[float | None]:
    """Samples a second: one a call from C++ and from Python, in chunks of 100 and `CHUNK`."""
    robustness = kind == "bounds"
    samples = single_samples(program, trace)
    measured: list[float | None] = [None]
    if online_feed is not None:
        plain = peers.plain_table(trace.rows)
        measured[0] = statistics.median(feed_from_cpp(online_feed, program, plain, kind) for _ in range(repeat))
    measured.append(cpu_of(lambda: feed_single(program, samples, robustness), repeat))
    measured.append(cpu_of(lambda: feed_online(program, trace, 100, robustness), repeat))
    measured.append(cpu_of(lambda: feed_online(program, trace, CHUNK, robustness), repeat))
    return [None if cpu is None else trace.rows / cpu for cpu in measured]


def window_part(rows: int, repeat: int) -> None:
    """Windows a hundred times as long."""
    print(f"\nA window of 18,000 s instead of 180 s, {rows:,} rows: how many times the CPU time\n")
    heading("shape", *JOBS)
    trace = trace_of(shapes.make_rows(rows))
    for shape in shapes.WINDOWED:
        cells = []
        for job in JOBS.values():
            narrow, wide = (cpu_of(partial(job, program_of(shape, window), trace), repeat) for window in (180, 18_000))
            cells.append(f"{wide / narrow:.2f}")
        line(shape, *cells)


def length_part(rows: int, folder: Path, repeat: int) -> None:
    """Ten times as many rows: time, and memory of fresh processes."""
    print(f"\n{10 * rows:,} rows against {rows:,}: times the CPU time, and at most bytes a row beyond the input\n")
    heading("shape", *(f"{job}, {what}" for job in [*JOBS, "tachk.monitor"] for what in ("time", "bytes")))
    for count in (rows, 10 * rows):
        if not (folder / f"{count}.columns.npy").exists():
            made = shapes.make_rows(count)
            np.save(folder / f"{count}.columns.npy", np.stack([made.milliseconds / 1000, made.x, made.y, made.z]))
    for shape in shapes.NAMES:
        cells = []
        for job in [*JOBS, "tachk.monitor"]:
            small = [in_child(job, shape, folder / f"{rows}.columns.npy") for _ in range(repeat)]
            large = [in_child(job, shape, folder / f"{10 * rows}.columns.npy") for _ in range(max(1, repeat - 2))]
            time = statistics.median(run["cpu"] for run in large) / statistics.median(run["cpu"] for run in small)
            held = statistics.median(run["bytes"] for run in large)
            cells += [
                f"{time:.1f}",
                f"{held / (10 * rows):.1f}" + (f" ({held / 1e6:.1f} MB)" if "online" in job else ""),
            ]
        line(shape, *cells)


def in_child(job: str, shape: str, path: Path) -> dict[str, float]:
    """CPU seconds and peak memory beyond the input, in a process of its own."""
    command = [sys.executable, __file__, "--child", job, shape, str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    result: dict[str, float] = json.loads(done.stdout)
    return result


def child(job: str, shape: str, path: str) -> None:
    """One job; prints JSON."""
    seconds, x, y, z = np.load(path)
    milliseconds = np.empty(len(seconds), dtype=np.int64)
    for begin in range(0, len(seconds), 10_000):
        milliseconds[begin : begin + 10_000] = np.rint(1000 * seconds[begin : begin + 10_000])
    trace = trace_of(shapes.Rows(milliseconds, x, y, z))
    program = program_of(shape)
    action: Callable[[], object] = lambda: JOBS[job](program, trace)  # noqa: E731
    if job == "tachk.monitor":
        formula = shapes.TACHK[shape].format(w=180)
        data = {"time": seconds, "x": x, "y": y, "z": z}
        tachk.monitor(formula, {name: values[:100] for name, values in data.items()}, unit="s")
        action = lambda: tachk.monitor(formula, data, unit="s")  # noqa: E731
    before = resident("VmRSS")
    Path("/proc/self/clear_refs").write_text("5")  # forgets the peak so far
    begin_time = process_time()
    action()
    cpu = process_time() - begin_time
    print(json.dumps({"cpu": cpu, "bytes": resident("VmHWM") - before}))


def resident(what: str) -> int:
    """Bytes of memory of this process, from Linux: VmRSS is what it has now, VmHWM the most it had."""
    status = Path("/proc/self/status").read_text()
    return 1024 * next(int(text.split()[1]) for text in status.splitlines() if text.startswith(what))


SENTENCES = """\
ECFS: At any point of time, whenever true is true, with a delay of at most 180 seconds, written must be true.
ECRA: At any point of time, whenever true is true, with a delay of at most 180 seconds, read must be true.
NIWS: At any point of time, whenever sleep is true, with no delay, not arrive must be true.
RMIO: At any point of time, whenever tenthAtAgent is true, with no delay, toDDS must be true.
RMIO2: At any point of time, whenever tenthAtClient is true, with no delay, fromDDS must be true.
TMRK: At any point of time, whenever lost is true, with a delay of between 0 and 20 seconds, marked must be true.
FARS: At any point of time, whenever behind is true, with a delay of between 0 and 20 seconds, caughtUp must be true.
"""


def csv_part(rows: int, folder: Path, repeat: int) -> None:
    """Files through the command line."""
    print(f"\n`tachk monitor` on CSV files of {rows:,} rows, seven formulas at once, the whole process\n")
    heading("file", "MB", "formulas", "robustness", "CPU s", "million rows/s", "answers")
    made = shapes.make_rows(rows)
    numbers = folder / "numbers.csv"
    write_csv(numbers, made, {"x": made.x, "y": made.y, "z": made.z})
    seven = folder / "shapes.stl"
    seven.write_text("".join(f"{name}: {shapes.TACHK[name].format(w=180)}\n\n" for name in shapes.NAMES))
    flags = folder / "flags.csv"
    write_csv(flags, made, signals_of(made))
    sentences = folder / "sentences.stl"
    sentences.write_text(SENTENCES.replace("\n", "\n\n"))
    for path, formulas, what in ((numbers, seven, "the seven shapes"), (flags, sentences, "the seven sentences")):
        for robustness in ("--no-robustness", "--robustness"):
            runs = [run_cli(formulas, path, robustness) for _ in range(repeat)]
            cpu = statistics.median(run[0] for run in runs)
            cells = [
                path.stem,
                f"{path.stat().st_size / 1e6:.0f}",
                what,
                "yes" if robustness == "--robustness" else "no",
            ]
            line(*cells, f"{cpu:.2f}", f"{rows / cpu / 1e6:.2f}", runs[0][1])


def signals_of(rows: shapes.Rows) -> dict[str, np.ndarray]:
    """Truth values for the sentences, which they satisfy as far as the trace goes."""
    trigger = rows.x > 0.99
    answered = rows.y > 0.9
    return {
        "written": answered, "read": answered, "sleep": rows.z > 0.5, "arrive": rows.z < 0.1, "tenthAtAgent": trigger,
        "toDDS": rows.y > 0.5, "tenthAtClient": trigger, "fromDDS": rows.y > 0.5, "lost": trigger, "marked": ~trigger,
        "behind": trigger, "caughtUp": ~trigger,
    }  # fmt: skip


def write_csv(path: Path, rows: shapes.Rows, columns: Mapping[str, np.ndarray]) -> None:
    """Times with three decimals, numbers with six, truth values as 0 and 1."""
    with path.open("w", encoding="ascii") as file:
        file.write(",".join(["time [s]", *columns]) + "\n")
        form = ",".join(["%.3f", *("%d" if values.dtype == bool else "%.6f" for values in columns.values())]) + "\n"
        for begin in range(0, len(rows.x), 10_000):
            end = begin + 10_000
            cells = [rows.milliseconds[begin:end] / 1000, *(values[begin:end] for values in columns.values())]
            file.write("".join(form % row for row in zip(*(values.tolist() for values in cells), strict=True)))


def run_cli(formulas: Path, trace: Path, robustness: str) -> tuple[float, str]:
    """CPU seconds of the whole process, and the last line of its report."""
    command = [sys.executable, "-m", "tachk", "monitor", robustness, str(formulas), str(trace)]
    process = finished(command, statuses=(0, 10, 20))
    return process.cpu_seconds, process.output.strip().splitlines()[-1]


PARTS = ("robustness", "truth", "online", "window", "length", "csv")


def main() -> None:
    """Prints the tables in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", help="a Python that has stlrom, reelay, rtamt or moonlight")
    parser.add_argument("--reelay-bench", help="the driver of reelay's C++ headers")
    parser.add_argument("--online-feed", help="the program of bench/online_feed.cpp")
    parser.add_argument("--rows", type=float, default=1e6)
    parser.add_argument("--csv-rows", type=float, default=2e6)
    parser.add_argument("--repeat", type=int, default=3, help="measurements of each thing; the median counts")
    parser.add_argument("--parts", nargs="*", choices=PARTS, default=PARTS)
    parser.add_argument("--child", nargs=3, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.child:
        child(*arguments.child)
        return
    rows = int(arguments.rows)
    loop = statistics.median(calibrate() for _ in range(3))
    print(f"load average {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores, median of {arguments.repeat}")
    print(f"calibration loop {loop:.2f} CPU s ({REFERENCE_LOOP} on the reference machine)")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        peers = Peers(arguments.python, arguments.reelay_bench, folder, arguments.repeat)
        for part in arguments.parts:
            match part:
                case "robustness" | "truth":
                    offline_part(part, rows, peers, arguments.repeat)
                case "online":
                    online_part(rows, peers, arguments.online_feed, arguments.repeat, loop / REFERENCE_LOOP)
                case "window":
                    window_part(rows, arguments.repeat)
                case "length":
                    length_part(rows, folder, arguments.repeat)
                case _:
                    csv_part(int(arguments.csv_rows), folder, arguments.repeat)


if __name__ == "__main__":
    main()
