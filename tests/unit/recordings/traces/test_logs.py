"""Logs of other systems: JSON lines, texts as values, dates, several files joined by time."""

from __future__ import annotations

import io
import json
from fractions import Fraction
from pathlib import Path
from random import Random

import pandas as pd
import pytest
from click.testing import CliRunner

import tachk
from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.cli.commands.monitor import run_monitor
from tachk.cli.exit_status import ExitStatus
from tachk.cli.main import app
from tachk.cli.trace_arguments import TraceArguments
from tachk.recordings.traces.conventions import EvaluationOptions
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace_files import open_trace

CSV = """time [s],mode,other,n
0,idle,"a ""b"", c",1
1,ready,,2
2.5,,x,3
4, busy ,x,4
"""


def truths(formulas: list[str], trace: object, **options: object) -> list[str]:
    return [verdict.truth.word for verdict in tachk.monitor(formulas, trace, **options)]  # type: ignore[arg-type]


FORMULAS = [
    'F (mode == "ready")',
    'G (mode != "off")',
    'G (mode == "ready" -> n >= 2 && n <= 3)',
    'G (rise(mode == "busy") -> other == "x")',
    'F (other == "a")',
    "G (change(mode) -> n != 3)",
    "G (mode == other)",
]
EXPECTED = ["true", "true", "true", "true", "false", "true", "false"]


def test_columns_of_texts_are_compared_in_every_format(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(CSV)
    formulas = [each for each in FORMULAS if "change" not in each]
    expected = [word for word, each in zip(EXPECTED, FORMULAS, strict=True) if "change" not in each]
    assert truths(formulas, path) == expected
    frame = pd.DataFrame(
        {
            "time": [0, 1, 2.5, 4],
            "mode": pd.Categorical(["idle", "ready", None, "busy"]),
            "other": ['a "b", c', None, "x", "x"],
            "n": [1, 2, 3, 4],
        }
    )
    assert truths(FORMULAS, frame, unit="s") == EXPECTED
    frame.to_parquet(tmp_path / "log.parquet")
    assert truths(FORMULAS, tmp_path / "log.parquet", unit="s") == EXPECTED
    lines = tmp_path / "log.jsonl"
    rows = [{k: v for k, v in row.items() if isinstance(v, str) or v == v} for row in frame.to_dict("records")]
    lines.write_text("".join(json.dumps(row) + "\n" for row in rows))
    assert truths(FORMULAS, lines, unit="s") == EXPECTED


def test_the_values_of_texts_are_reported_and_have_no_robustness(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(CSV)
    report = tachk.monitor('G (mode != "busy")', path)
    assert 'seen at 4 s: mode = "busy"' in report.to_text()
    assert report[0].robustness == (float("-inf"), float("-inf"))


def test_texts_and_numbers_are_not_mixed(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(CSV)
    for formula, reason in (
        ('G (n + 1 == "a")', "is not a text"),
        ('G (mode < "a")', "no order"),
        ('G (mode == "a" -> mode > 3)', "texts"),
    ):
        with pytest.raises(InputError, match=reason):
            tachk.monitor(formula, path)
    with pytest.raises(InputError, match="holds texts"):
        tachk.monitor("G (abs(mode) < 3)", {"t": [0, 1], "mode": ["a", "b"]})


def test_texts_row_by_row() -> None:
    monitor = tachk.Monitor('G (rise(mode == "ready") -> F[0, 2] (other == mode))')
    monitor.update(0, mode="idle", other="busy")
    monitor.update(1, mode="ready")
    assert monitor.update(2, mode="new", other="new") is Truth.UNDETERMINED
    monitor.update(5, mode="ready")
    assert monitor.update(8, {"other": "x"}) is Truth.FALSE
    assert monitor.verdicts[0].story is not None
    with pytest.raises(UsageError, match="not a text"):
        monitor.update(9, mode=3)


def test_json_lines_begin_when_all_is_known(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (
        '{"t": 0, "pose": {"x": 1}}\n\n{"t": 0.1, "v": [1.5, true]}\n{"t": 0.30, "pose": {"x": null}}\n'
        '{"t": 1.3, "pose": {"x": 9}}\n{"t": 2, "v": [2, false]}\n'
    )
    path = tmp_path / "log.jsonl"
    path.write_text(text)
    trace = open_trace(path).read()
    assert trace.origin == Fraction(1, 10)
    assert {name: values.tolist() for name, values in trace.columns.items()} == {
        "pose.x": [1, 1, 9, 9],
        "v[0]": [1.5, 1.5, 1.5, 2],
        "v[1]": [1, 1, 1, 0],
    }
    formula = "G (pose.x < 5 || v[1])"
    assert tachk.monitor(formula, path)[0].truth is Truth.FALSE
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(text.encode())))
    assert run_monitor(TraceArguments(formula, "-"), EvaluationOptions(robustness=False)) is ExitStatus.NOT_AS_EXPECTED
    assert "from 0.1 to 2" in capsys.readouterr().out
    for wrong in ('{"t": 1', "[1]", '{"x": 1}', '{"t": "soon"}', '{"t": 3}\n{"t": 2}', '{"t": 1, "x": 1e999}'):
        path.write_text(wrong + "\n")
        with pytest.raises(InputError):
            open_trace(path)


def test_a_dump_is_read_from_standard_input(monkeypatch: pytest.MonkeyPatch) -> None:
    text = "$timescale 1 ns $end\n$var wire 1 ! a $end\n$enddefinitions $end\n#0\nx!\n#5\n1!\n#9\n0!\n#12\n"
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BufferedReader(io.BytesIO(text.encode()))))  # type: ignore[arg-type]
    assert run_monitor(TraceArguments("G a", "-")) is ExitStatus.NOT_AS_EXPECTED


def test_files_of_several_rates_are_joined(tmp_path: Path) -> None:
    random = Random(3)
    clocks = {"a": sorted(random.sample(range(40), 12)), "b": sorted(random.sample(range(5, 40), 6))}
    values = {name: [random.randint(0, 9) for _ in times] for name, times in clocks.items()}
    for name, times in clocks.items():
        unit, factor = ("s", Fraction(1, 4)) if name == "a" else ("ms", Fraction(250))
        rows = [f"{float(time * factor)},{value},{value % 2}" for time, value in zip(times, values[name], strict=True)]
        (tmp_path / f"{name}.csv").write_text(f"time [{unit}],{name}x,flag\n" + "\n".join(rows) + "\n")
    trace = open_trace([tmp_path / "a.csv", tmp_path / "b.csv"]).read()
    assert tuple(trace.columns) == ("ax", "a.flag", "bx", "b.flag")
    begin = max(times[0] for times in clocks.values())
    assert trace.clock(0) == Fraction(begin, 4)
    assert trace.clock(trace.end) == Fraction(max(times[-1] for times in clocks.values()), 4)
    for quarter in range(begin, max(times[-1] for times in clocks.values()) + 1):
        tick = (Fraction(quarter, 4) - trace.origin) * trace.ticks_per_unit
        for name, times in clocks.items():
            held = next(value for time, value in zip(times[::-1], values[name][::-1], strict=True) if time <= quarter)
            assert trace.value(f"{name}x", tick) == held
    with pytest.raises(UsageError, match="no column"):
        open_trace([tmp_path / "a.csv", tmp_path / "b.csv"]).read(["flag"])


def test_a_line_of_json_may_say_the_unit_of_its_time(tmp_path: Path) -> None:
    file = tmp_path / "a.jsonl"
    file.write_text('{"time [ms]": 0, "x": 1}\n{"time [ms]": 2.5, "x": 0}\n')
    assert open_trace(file).unit == "ms"
    assert tachk.monitor("G[0, 2 ms] x", file).truth is tachk.Truth.TRUE
    assert tachk.monitor("G[0, 2.5 ms] x", file).truth is tachk.Truth.FALSE
    call = ["monitor", "G[0, 2500 us] x", str(file), "--quiet", "--online"]
    assert CliRunner().invoke(app, call).exit_code == 10
    with pytest.raises(UsageError, match="are in ms, not in s"):
        open_trace(file, unit="s")
    file.write_text('{"time [ms]": 0, "time": 7, "x": 1}\n')
    with pytest.raises(InputError, match="two values 'time'"):
        open_trace(file)
