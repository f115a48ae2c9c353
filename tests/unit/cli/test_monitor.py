"""`tachk monitor` on standard input and on a file that grows."""

from __future__ import annotations

import io
import itertools
import json
import os
from collections.abc import Callable
from pathlib import Path

import jsonschema
import pytest

from tachk.base import awaited_pipe, job
from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.job import limited
from tachk.cli import monitor_online
from tachk.cli.commands.monitor import run_monitor
from tachk.cli.exit_status import ExitStatus
from tachk.cli.guard import guarded
from tachk.cli.reporting import Reporting, ViolationReporting
from tachk.cli.row_by_row import RowByRow
from tachk.cli.trace_arguments import TraceArguments, exit_status
from tachk.recordings.traces.conventions import EvaluationOptions, TraceEnding
from tachk.recordings.traces.node_signal import Truth

TEXT = "time [s],p,q\n0,0,0\n1,1,0\n2,0,0\n9,0,0\n20,0,1\n"


class Pieces(io.RawIOBase):
    """A pipe that gives one piece at a time, and notes how often it was asked."""

    def __init__(self, pieces: list[str]) -> None:
        self.pieces = [piece.encode() for piece in pieces]

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        if not self.pieces:
            return 0
        piece = self.pieces.pop(0)
        buffer[: len(piece)] = piece
        return len(piece)


def feed(monkeypatch: pytest.MonkeyPatch, pieces: list[str]) -> Pieces:
    pipe = Pieces(pieces)
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BufferedReader(pipe)))
    return pipe


def test_standard_input_is_evaluated_row_by_row(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = TEXT.splitlines(keepends=True)
    pipe = feed(monkeypatch, lines)
    status = run_monitor(TraceArguments("G (p -> F[0, 3 s] q)", "-"), EvaluationOptions(robustness=False))
    assert status is ExitStatus.NOT_AS_EXPECTED
    assert pipe.pieces == [lines[-1].encode()]  # decided by the row before: nothing more is asked for
    out = capsys.readouterr().out
    assert out.startswith("9 s: p1 is false\n  trigger: `p` becomes true at 1 s\n")
    assert "-: 4 rows, from 0 s to 9 s" in out


def test_a_dump_on_standard_input_is_called_after_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    feed(monkeypatch, ["$timescale 1 ms $end\n$var wire 1 ! p $end\n$enddefinitions $end\n#0\nx!\n#1\n0!\n#2\n1!\n"])
    assert run_monitor(TraceArguments("G (p || !p)", "-")) is ExitStatus.AS_EXPECTED
    assert capsys.readouterr().out.startswith("-: 2 rows, from 1 ms to 2 ms")


@pytest.mark.parametrize(
    ("formula", "end", "status"),
    [
        ("G (p -> F[0, 30 s] p)", TraceEnding.UNDETERMINED, ExitStatus.AS_EXPECTED),
        ("G (q -> F[0, 3 s] p)", TraceEnding.UNDETERMINED, ExitStatus.UNKNOWN),
        ("G (q -> F[0, 3 s] p)", TraceEnding.WEAK, ExitStatus.AS_EXPECTED),
        ("G (q -> F[0, 3 s] p)", TraceEnding.STRONG, ExitStatus.NOT_AS_EXPECTED),
    ],
)
def test_the_end_of_standard_input(
    monkeypatch: pytest.MonkeyPatch, formula: str, end: TraceEnding, status: ExitStatus
) -> None:
    feed(monkeypatch, [TEXT[:17], TEXT[17:]])
    assert run_monitor(TraceArguments(formula, "-"), EvaluationOptions(end), reporting=Reporting(quiet=True)) is status


def test_a_false_formula_counts_more_than_one_that_is_open() -> None:
    assert exit_status({Truth.TRUE}) is ExitStatus.AS_EXPECTED
    assert exit_status({Truth.TRUE, Truth.UNDETERMINED}) is ExitStatus.UNKNOWN
    assert exit_status({Truth.TRUE, Truth.UNDETERMINED, Truth.FALSE}) is ExitStatus.NOT_AS_EXPECTED


def test_a_growing_file_is_waited_for(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "log.csv"
    parts = [TEXT[:5], TEXT[5:20], TEXT[20:30], TEXT[30:]]
    path.write_text("")

    def grow(_: float) -> None:
        if not parts:
            raise KeyboardInterrupt
        with path.open("a") as file:
            file.write(parts.pop(0))

    monkeypatch.setattr(monitor_online.time, "sleep", grow)
    status = run_monitor(
        TraceArguments("G (p -> F[0, 19 s] q)", str(path)), EvaluationOptions(robustness=False), RowByRow(follow=True)
    )
    assert status is ExitStatus.AS_EXPECTED
    assert "5 rows, from 0 s to 20 s" in capsys.readouterr().out


def test_a_file_is_read_to_its_end_for_the_bounds(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "x.csv").write_text("time,x\n0,1\n1,6\n2,10\n3,1\n")
    status = run_monitor(TraceArguments("G (x < 5)", str(tmp_path / "x.csv")), rows=RowByRow(online=True))
    assert status is ExitStatus.NOT_AS_EXPECTED
    out = capsys.readouterr().out
    assert "4 rows, from 0 to 3" in out
    assert "robustness -5\n" in out


@pytest.mark.parametrize("online", [False, True])
def test_times_with_many_digits_are_rounded_and_the_report_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], online: bool
) -> None:
    (tmp_path / "x.csv").write_text("time,x\n0,1\n0.12345678901234567890123,6\n")
    status = run_monitor(TraceArguments("G (x < 5)", str(tmp_path / "x.csv")), rows=RowByRow(online=online))
    assert status is ExitStatus.NOT_AS_EXPECTED
    out = capsys.readouterr().out
    assert "from 0 to 0.123456789\ntimes are rounded to 9 decimals\n" in out


@pytest.mark.parametrize("online", [False, True])
def test_times_that_are_too_fine_say_why(tmp_path: Path, online: bool) -> None:
    (tmp_path / "x.csv").write_text("time,x\n0,1\n1234567890123.12345678901234567890123,6\n")
    with pytest.raises(InputError) as refusal:
        run_monitor(TraceArguments("G (x < 5)", str(tmp_path / "x.csv")), rows=RowByRow(online=online))
    assert "--decimals 9" in str(refusal.value.diagnostics[0].help)


def test_a_clock_that_shows_the_time_since_1970_in_nanoseconds(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    feed(
        monkeypatch, ["time [ns],p\n", "1772323200500000000,1\n", "1772323201250000000,0\n", "1772323202250000000,0\n"]
    )
    assert run_monitor(TraceArguments("G p", "-")) is ExitStatus.NOT_AS_EXPECTED
    assert "1772323202250000000 ns: p1 is false" in capsys.readouterr().out


def test_events_come_as_json_lines(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    folder = Path(__file__).parents[3] / "docs/schema"
    names = ("monitor.schema.json", "monitor_event.schema.json")
    monitor, event = (json.loads((folder / name).read_text()) for name in names)
    schema = {**event, "$defs": monitor["$defs"]}
    schema = json.loads(json.dumps(schema).replace("monitor.schema.json#", "#"))
    feed(monkeypatch, ["time [s],p\n0,1\n2,0\n3,1\n", "5,1\n6,0\n"])
    formulas = TraceArguments("G p", "-")
    every = ViolationReporting(all_violations=True)
    assert run_monitor(formulas, violations=every, reporting=Reporting("jsonl")) is ExitStatus.NOT_AS_EXPECTED
    events = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    for each in events:
        jsonschema.validate(each, schema)
    assert [(each["event"], each.get("from"), each.get("until")) for each in events] == [
        ("violation", "2", None),
        ("verdict", None, None),
        ("violation", "2", "3"),
        ("violation", "6", None),
        ("violation", "6", "6"),
        ("end", None, None),
    ]
    assert events[1]["decided_at"] == "3"


def test_it_can_stop_at_the_first_verdict_that_is_false(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    formulas = tmp_path / "two.stl"
    formulas.write_text("first: G (p -> F[0, 3 s] q)\nsecond: G (q -> F[0, 100 s] p)\n")
    lines = TEXT.splitlines(keepends=True)
    pipe = feed(monkeypatch, [*lines, "30,0,0\n"])
    status = run_monitor(
        TraceArguments(str(formulas), "-"), EvaluationOptions(TraceEnding.WEAK), RowByRow(fail_fast=True)
    )
    assert status is ExitStatus.NOT_AS_EXPECTED
    assert len(pipe.pieces) == 2
    out = capsys.readouterr().out
    assert "second  undetermined" in out  # the trace has not ended, so its end has no meaning yet


@pytest.mark.parametrize("come", ["", "time", "time,p\n", "time,p\n0,1\n1,", '{"time": 0, "p": true}\n', "$date"])
def test_a_silent_pipe_is_waited_for_until_the_time_is_over(
    come: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    looks = itertools.count()
    monkeypatch.setattr(job, "monotonic", lambda: float(next(looks)))
    monkeypatch.setattr(awaited_pipe, "PATIENCE", 0.001)
    reading, writing = os.pipe()
    os.write(writing, come.encode())
    with os.fdopen(reading) as stream:
        monkeypatch.setattr("sys.stdin", stream)
        status = guarded(
            in_time(lambda: run_monitor(TraceArguments("G p", "-"), EvaluationOptions(robustness=False)), 200)
        )
    os.close(writing)
    assert status is ExitStatus.UNKNOWN
    said = capsys.readouterr()
    assert "the time limit was over before" in said.err
    assert ("1 undetermined" in said.out) is come.startswith(("time,p\n0", "{"))


def in_time(action: Callable[[], ExitStatus], seconds: float) -> Callable[[], ExitStatus]:
    def act() -> ExitStatus:
        with limited(seconds):
            return action()

    return act
