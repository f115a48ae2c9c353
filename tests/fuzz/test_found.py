"""What damaged inputs have shown: each of these ended in a traceback, took all memory, or went on beyond its limit."""

from __future__ import annotations

import contextlib
import json
import sqlite3
from pathlib import Path
from typing import Any

import pytest

from tachk.base.awaited_pipe import GrowingFile
from tachk.base.job import OutOfTimeError, limited
from tachk.cli.main import app
from tachk.meaning.judge.certificate import MAGIC, encoded
from tachk.recordings.traces.trace_header import read_header
from tests.fuzz.samples import DIMMER, LAMP, RULES, SMALL
from tests.unit.xrce.proxy.test_counterexample import STALE

LONG = "9" * 5000
"""Python makes no number of so many digits."""


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str]:
    """The status of a command, and what it writes to standard error."""
    with pytest.raises(SystemExit) as ended:
        app(list(arguments), prog_name="tachk")
    return int(ended.value.code or 0), capsys.readouterr().err


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name, text in (("lamp.ta", LAMP), ("dimmer.ta", DIMMER), ("small.xml", SMALL), ("g.csv", "time,x\n0,1\n")):
        Path(name).write_text(text, encoding="utf-8")
    return tmp_path


@pytest.mark.parametrize(
    "command",
    [
        ("sweep", "lamp.ta", "-D", f"LIMIT={LONG}"),
        ("sweep", "lamp.ta", "-D", f"LIMIT=1..{LONG}"),
        ("sweep", "lamp.ta", "-D", "LIMIT=1..3", "--part", f"{LONG}/3"),
        ("synthesize", "lamp.ta", "--over", f"LIMIT=1..3:{LONG}", "--property", "few"),
        ("chart", "g.csv", "--from", LONG),
        ("xrce", "proxy", "--listen", LONG, "--show"),
        ("xrce", "proxy", "--listen", "9001", "--show", "--rule", f"drop DATA {LONG}"),
        ("xrce", "proxy", "--listen", "9001", "--show", "--rule", f"drop the {LONG}th DATA"),
        ("xrce", "proxy", "--listen", "9001", "--show", "--rule", f"drop {LONG} % of DATA"),
        ("xrce", "proxy", "--listen", "9001", "--show", "--rule", f"drop DATA on {LONG}"),
        ("estimate", "lamp.ta", "Pr[<=1e99999999](<> n == 2)"),
        ("simulate", "lamp.ta", "-o", "x.csv", "--fault", f"loss={LONG}"),
    ],
    ids=lambda command: " ".join(word[:12] for word in command),
)
def test_a_number_of_too_many_digits_is_none(capsys: pytest.CaptureFixture[str], command: tuple[str, ...]) -> None:
    status, said = run(capsys, *command)
    assert (status, "Traceback" in said) == (2, False)


def test_a_limit_of_many_digits_is_no_limit(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(capsys, "verify", "small.xml", "-q", "--max-memory", f"{'9' * 400}G")[0] != 70


@pytest.mark.parametrize("size", ["9" * 5000, "9999999999"])
def test_sizes_of_arrays_in_tchecker_files(capsys: pytest.CaptureFixture[str], size: str) -> None:
    Path("m.tck").write_text(f"system:S\nint:{size}:0:1:0:n\nprocess:P\nlocation:P:l{{initial:}}\n")
    assert run(capsys, "check", "m.tck")[0] == 2
    Path("m.tck").write_text(
        f"system:S\nint:1:0:1:0:n\nprocess:P\nevent:e\nlocation:P:l{{initial:}}\nedge:P:l:l:e{{provided: n<{LONG}}}\n"
    )
    assert run(capsys, "check", "m.tck")[0] == 2


def test_selects_of_too_many_values_are_rejected_where_they_are_tried(capsys: pytest.CaptureFixture[str]) -> None:
    Path("m.ta").write_text(
        "int n; process P() { init location A { to A { select i : int[0, 1073741823]; guard i == 5; } } } system P;"
    )
    Path("m.run").write_text("1 P: A -> A\n")
    for command in (("replay", "m.ta", "m.run"), ("convert", "m.ta", "m.muntax"), ("step", "m.ta")):
        status, said = run(capsys, *command)
        assert (status, "E0708" in said) == (3, True)


def test_a_trace_for_the_proxy_is_checked_before_it_is_used(capsys: pytest.CaptureFixture[str]) -> None:
    for place in ("constants", "time_unit", "results"):
        document: Any = json.loads(json.dumps(STALE))
        document["runs"][0][place] = "x\n"
        Path("t.json").write_text(json.dumps(document))
        status, said = run(capsys, "xrce", "proxy", "--listen", "1", "--show", "--from-trace", "t.json")
        assert (status, f"$.runs[0].{place}" in said) == (2, True)


def test_integers_of_reports_are_integers(capsys: pytest.CaptureFixture[str]) -> None:
    document: Any = json.loads(json.dumps(STALE))
    document["runs"][0]["constants"]["PUB_UP"] = 1e15
    Path("t.json").write_text(json.dumps(document))
    status, said = run(capsys, "xrce", "proxy", "--listen", "1", "--show", "--from-trace", "t.json")
    assert (status, "is not of type 'integer'" in said) == (2, True)


@pytest.mark.parametrize("text", ['{"a": ' * 100_000, '{"runs": 1e999}', '{"runs": Infinity}', f'{{"runs": {LONG}}}'])
def test_json_that_no_report_is(capsys: pytest.CaptureFixture[str], text: str) -> None:
    Path("t.json").write_text(text)
    for command in (
        ("replay", "lamp.ta", "t.json"),
        ("draw", "--coverage", "t.json", "dimmer.ta", "-o", "a.svg"),
        ("xrce", "proxy", "--listen", "1", "--show", "--from-trace", "t.json"),
    ):
        assert run(capsys, *command)[0] == 2


@pytest.mark.parametrize(
    "change",
    [
        "update cells set cell = '[' where rowid = 1",
        "update cells set cell = '3' where rowid = 1",
        "update cells set cell = x'ff' where rowid = 1",
        "update cells set seconds = 'x'",
        "update rows set answer = x'ff'",
        "update rows set transitions = 'many'",
    ],
)
def test_damaged_stores_are_reported(capsys: pytest.CaptureFixture[str], change: str) -> None:
    sweep = ("sweep", "lamp.ta", "-D", "LIMIT=1..2", "-j", "1", "--property", "few", "--store", "s.sqlite")
    assert run(capsys, *sweep)[0] == 0
    with contextlib.closing(sqlite3.connect("s.sqlite")) as database:
        database.execute(change)
        database.commit()
    status, said = run(capsys, *sweep)
    assert (status, "in this file is damaged" in said) == (2, True)


@pytest.mark.parametrize("header", ["[" * 50_000, '{"kind": "unreachable", "width": 1e999}'])
def test_headers_of_certificates(capsys: pytest.CaptureFixture[str], header: str) -> None:
    import numpy as np

    Path("m.cert").write_bytes(MAGIC + encoded(np.array([len(header)])) + header.encode() + b"\0\0\0")
    status, said = run(capsys, "certify", "lamp.ta", "m.cert")
    assert (status, "is not a whole certificate" in said) == (2, True)


def test_a_cell_of_an_event_that_is_too_long(capsys: pytest.CaptureFixture[str]) -> None:
    Path("e.csv").write_text(f"time,event\n1,{'a' * 140_000}\n")
    status, said = run(capsys, "conform", "dimmer.ta", "e.csv")
    assert (status, "e.csv, line 2: field larger" in said) == (2, True)


def test_waiting_for_a_capture_ends_with_the_time(folder: Path) -> None:
    Path("c.pcap").write_bytes(b"")
    growing = GrowingFile(Path("c.pcap"), lambda _: None)
    with limited(0.01), pytest.raises(OutOfTimeError):
        list(iter(lambda: growing.read1(10), b""))
    growing.close()


def test_waiting_for_rows_ends_with_the_time(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(capsys, "monitor", "--follow", "--max-seconds", "0.1", "G x < 5", "g.csv")[0] == 20


def test_names_of_columns_with_many_brackets_are_split_once() -> None:
    for cell in ("a" + "[a" * 30_000, "a [" + "(" * 30_000 + "]"):
        assert read_header(("time", cell), None, None, "t").names[1] in (cell, "a")
    cells = {"x [m]": "x", "x[0]": "x[0]", " y  ( k(m ) ": "y", "[m]": "[m]", "a[0] [V]": "a[0]", "b)": "b)"}
    assert read_header(("time[ms]", *cells), None, None, "t").names == ("time", *cells.values())


@pytest.mark.parametrize(
    ("query", "code"),
    [
        ("E<> Lamp.y - deadlock <= 3", "E0706"),
        ("E<> x - Lamp.y <= deadlock", "E0706"),
        ("A[] Lamp.y >= 2 + deadlock", "E0706"),
        ("Lamp.on --> Lamp.y <= deadlock", "E0706"),
        ("sup: n + deadlock", "E0503"),
    ],
)
def test_deadlock_is_no_number(capsys: pytest.CaptureFixture[str], query: str, code: str) -> None:
    with pytest.raises(SystemExit) as ended:
        app(["verify", "lamp.ta", query], prog_name="tachk")
    told = capsys.readouterr()
    assert (ended.value.code in (2, 3), code in told.out + told.err) == (True, True)


def test_rules_are_read(capsys: pytest.CaptureFixture[str]) -> None:
    Path("rules").write_text(RULES)
    listening = ("--listen", "9001", "--listen", "9002")
    assert run(capsys, "xrce", "proxy", *listening, "--show", "--script", "rules")[0] == 0


def test_a_time_beyond_doubles_is_shown(capsys: pytest.CaptureFixture[str]) -> None:
    Path("late.jsonl").write_text('{"t": 0, "x": 1}\n{"t": 1e309, "x": 2}\n')
    status, told = run(capsys, "monitor", "G (x < 9)", "late.jsonl", "--online")
    assert (status, "the time 1e+309 is too large to be counted" in told) == (2, True)
