"""`tachk monitor` on standard input and on a file that grows."""

from __future__ import annotations

import io
from pathlib import Path

import pytest

from tachk.cli import monitor_online
from tachk.cli.exit_status import ExitStatus
from tachk.cli.monitor import run_monitor
from tachk.cli.monitor_request import MonitorRequest, exit_status
from tachk.runtime.node_signal import Truth

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


def test_standard_input_is_judged_row_by_row(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = TEXT.splitlines(keepends=True)
    pipe = feed(monkeypatch, lines)
    status = run_monitor(MonitorRequest("G (p -> F[0, 3 s] q)", "-", robustness=False))
    assert status is ExitStatus.NOT_AS_EXPECTED
    assert pipe.pieces == [lines[-1].encode()]  # decided by the row before: nothing more is asked for
    out = capsys.readouterr().out
    assert out.startswith("9 s: p1 is false\n  trigger: `p` becomes true at 1 s\n")
    assert "-: 4 rows, from 0 s to 9 s" in out


@pytest.mark.parametrize(
    ("formula", "end", "status"),
    [
        ("G (p -> F[0, 30 s] p)", "undetermined", ExitStatus.AS_EXPECTED),
        ("G (q -> F[0, 3 s] p)", "undetermined", ExitStatus.UNKNOWN),
        ("G (q -> F[0, 3 s] p)", "weak", ExitStatus.AS_EXPECTED),
        ("G (q -> F[0, 3 s] p)", "strong", ExitStatus.NOT_AS_EXPECTED),
    ],
)
def test_the_end_of_standard_input(monkeypatch: pytest.MonkeyPatch, formula: str, end: str, status: ExitStatus) -> None:
    feed(monkeypatch, [TEXT[:17], TEXT[17:]])
    assert run_monitor(MonitorRequest(formula, "-", end=end, quiet=True)) is status


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
    status = run_monitor(MonitorRequest("G (p -> F[0, 19 s] q)", str(path), follow=True, robustness=False))
    assert status is ExitStatus.AS_EXPECTED
    assert "5 rows, from 0 s to 20 s" in capsys.readouterr().out
