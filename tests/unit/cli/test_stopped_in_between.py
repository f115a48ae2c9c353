"""What is known where a limit stops a command in the middle: told, and the rest is unknown with the reason."""

from __future__ import annotations

import importlib
import json
from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from click.testing import CliRunner

from tachk.api import times
from tachk.base.job import OutOfTimeError
from tachk.cli.main import app
from tachk.simulation import tables
from tachk.simulation.runs import Runs
from tachk.simulation.statistics import trajectories
from tachk.simulation.statistics.estimate import estimate
from tachk.simulation.tables import decimal_time
from tachk.simulation.tally import Tally

SCHEMAS = Path(__file__).parents[3] / "docs" / "schema"
MODEL = """
const int N = 1;
clock x;
process P() { init location A { invariant x <= N; to B { guard x >= N; } } location B; }
system P;
property a : Pr[<=10](<> P.B);
property b : Pr[<=20](<> P.B);
property c : Pr[<=30](<> P.B);
"""


@pytest.fixture
def model(tmp_path: Path) -> str:
    (tmp_path / "m.ta").write_text(MODEL, encoding="utf-8")
    return str(tmp_path / "m.ta")


def run(*arguments: str) -> tuple[int, str]:
    result = CliRunner().invoke(app, arguments)
    return result.exit_code, result.stdout


def validate(told: object, name: str) -> None:
    jsonschema.validate(told, json.loads((SCHEMAS / f"{name}.schema.json").read_text(encoding="utf-8")))


def stopping_after(count: int, original: Callable[..., Any], error: type[BaseException]) -> Callable[..., Any]:
    calls = iter(range(count))

    def call(*arguments: Any, **named: Any) -> Any:
        if next(calls, None) is None:
            raise error
        return original(*arguments, **named)

    return call


@pytest.mark.parametrize(
    ("error", "status", "reason"), [(OutOfTimeError, 20, "time limit"), (KeyboardInterrupt, 130, "interrupted")]
)
def test_estimates(
    model: str, monkeypatch: pytest.MonkeyPatch, error: type[BaseException], status: int, reason: str
) -> None:
    monkeypatch.setattr("tachk.simulation.statistics.estimate.estimate", stopping_after(1, estimate, error))
    found, output = run("estimate", model, "--runs", "10", "--format", "json")
    answers = json.loads(output)["answers"]
    validate(json.loads(output), "estimate")
    assert (found, [each["kind"] for each in answers]) == (status, ["probability", "unknown", "unknown"])
    assert answers[2] == {"name": "c", "query": "Pr[<=30](<> P.B)", "kind": "unknown", "reason": reason}


def test_estimates_in_words(model: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tachk.simulation.statistics.estimate.estimate", stopping_after(0, estimate, OutOfTimeError))
    status, output = run("estimate", model)
    assert (status, output.splitlines()[0]) == (20, "a: Pr[<=10](<> P.B): unknown (time limit)")


def test_runs(model: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    drawn = Runs.draw

    def two(*arguments: Any) -> Iterator[Any]:
        yield from islice(drawn(*arguments), 2)
        raise OutOfTimeError

    monkeypatch.setattr(Runs, "draw", two)
    monitored = importlib.import_module("tachk.simulation.monitored")
    evaluated = monitored.evaluated

    def two_evaluated(*arguments: Any) -> Iterator[Any]:
        yield from islice(evaluated(*arguments), 2)
        raise OutOfTimeError

    monkeypatch.setattr(monitored, "evaluated", two_evaluated)
    file = tmp_path / "runs.csv"
    asked = ("simulate", model, "--runs", "5", "--monitor", "F[0, 0.5] P.B", "-o", str(file))
    status, output = run(*asked)
    assert (status, "2 of 5 runs" in output) == (10, True)  # a violation that was found stays one
    assert "unknown what the other runs do (time limit)" in output
    assert {line.split(",")[0] for line in file.read_text().splitlines()[1:]} == {"0", "1"}
    status, output = run("simulate", model, "--runs", "5", "--format", "json")
    told = json.loads(output)
    validate(told, "simulate")
    assert (status, told["runs"], told["not_drawn"], told["reason"]) == (20, 2, 3, "time limit")


def test_a_run_that_is_not_counted_yet(model: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Tally, "add", stopping_after(1, Tally.add, KeyboardInterrupt))
    status, output = run("simulate", model, "--runs", "3", "--seed", "1")
    assert (status, "1 of 3 runs" in output) == (130, True)
    monkeypatch.setattr("tachk.simulation.tally.decimal_time", stopping_after(0, decimal_time, KeyboardInterrupt))
    status, output = run("simulate", model, "--format", "json")
    assert (status, json.loads(output)["runs"]) == (130, 0)


@pytest.mark.parametrize(
    ("error", "status", "reason"), [(OutOfTimeError, 20, "time limit"), (KeyboardInterrupt, 130, "interrupted")]
)
@pytest.mark.parametrize("file", ["runs.csv", "runs.jsonl", "runs.parquet", "runs-{run}.vcd", "runs-{run}.run"])
def test_runs_are_written_until_one_is_stopped(
    file: str,
    error: type[BaseException],
    status: int,
    reason: str,
    model: str,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    if "parquet" in file:
        pytest.importorskip("pyarrow.parquet")
    monkeypatch.chdir(tmp_path)
    whole = Path("whole") / file
    whole.parent.mkdir()
    assert run("simulate", model, "--runs", "2", "-o", str(whole))[0] == 0
    # A limit comes where the third run becomes a trace, or is told step by step. Parquet takes many runs together.
    if "parquet" in file:
        drawn = Runs.draw

        def two(*arguments: Any) -> Iterator[Any]:
            yield from islice(drawn(*arguments), 2)
            raise error

        monkeypatch.setattr(Runs, "draw", two)
    else:
        writer = "stepping.run_file:steps_text" if ".run" in file else "runs:recording"
        module, name = writer.split(":")
        stopped = importlib.import_module(f"tachk.simulation.{module}")
        monkeypatch.setattr(stopped, name, stopping_after(2, getattr(stopped, name), error))
    found, output = run("simulate", model, "--runs", "5", "-o", file)
    assert (found, output.startswith(f"{model}: 2 of 5 runs")) == (status, True)
    assert f"unknown what the other runs do ({reason})" in output
    for each in whole.parent.iterdir():
        assert Path(each.name).read_bytes() == each.read_bytes()
    assert len([*Path().glob("runs*")]) == len([*whole.parent.iterdir()])


@pytest.mark.parametrize(("error", "status"), [(OutOfTimeError, 20), (KeyboardInterrupt, 130)])
def test_runs_that_are_counted_are_in_the_table(
    error: type[BaseException], status: int, model: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A limit comes where the rows of the second run are made, before the third one is taken."""
    parquet = pytest.importorskip("pyarrow.parquet")
    rows, calls = Runs.rows, iter(range(9))

    def interrupted(*arguments: Any) -> Any:
        if next(calls) == 1:
            raise error
        return rows(*arguments)

    monkeypatch.setattr(Runs, "rows", interrupted)
    monkeypatch.setattr("tachk.simulation.tables._ROW_GROUP", 1)
    file = tmp_path / "runs.parquet"
    found, output = run("simulate", model, "--runs", "5", "-o", str(file))
    assert (found, output.startswith(f"{model}: 2 of 5 runs")) == (status, True)
    assert {*parquet.read_table(file)["run"].to_pylist()} == {0, 1}


@pytest.mark.parametrize("file", ["runs.csv", "runs.jsonl"])
def test_half_a_run_is_taken_back(file: str, model: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    assert run("simulate", model, "--runs", "1", "-o", f"whole-{file}")[0] == 0
    monkeypatch.setattr("tachk.simulation.tables._rows", _half_a_run_after_one(tables._rows))
    status, output = run("simulate", model, "--runs", "3", "-o", file)
    assert (status, "1 of 3 runs" in output) == (130, True)
    assert Path(file).read_text() == Path(f"whole-{file}").read_text()


def _half_a_run_after_one(rows: Callable[[Any], Iterator[Any]]) -> Callable[[Any], Iterator[Any]]:
    calls = iter(range(1))

    def some(trace: Any) -> Iterator[Any]:
        if next(calls, None) is not None:
            yield from rows(trace)
            return
        yield next(rows(trace))
        raise KeyboardInterrupt

    return some


def test_damaged_rows_are_not_kept(model: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    monkeypatch.setattr("tachk.simulation.tables._ROW_GROUP", 1)
    writing = stopping_after(1, parquet.ParquetWriter.write_table, KeyboardInterrupt)
    monkeypatch.setattr(parquet.ParquetWriter, "write_table", lambda *given, **named: writing(*given, **named))
    file = tmp_path / "runs.parquet"
    file.write_text("old")
    status, output = run("simulate", model, "--runs", "3", "-o", str(file))
    assert (status, "2 of 3 runs" in output) == (130, True)
    assert file.read_text() == "old"


@pytest.mark.parametrize("file", ["runs.csv", "runs.jsonl", "runs.parquet", "run.vcd", "run.run"])
@pytest.mark.parametrize("before", [None, "old"])
def test_no_run_no_file(
    file: str, before: str | None, model: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def none(*_: Any) -> Iterator[Any]:
        raise OutOfTimeError
        yield

    if "parquet" in file:
        pytest.importorskip("pyarrow.parquet")
    path = tmp_path / file
    if before is not None:
        path.write_text(before)
    monkeypatch.setattr(Runs, "draw", none)
    status, output = run("simulate", model, "-o", str(path))
    assert (status, "0 of 1 run" in output) == (20, True)
    assert (path.read_text() if path.exists() else None) == before
    assert sorted(tmp_path.iterdir()) == sorted({tmp_path / "m.ta", *([path] if before else [])})


def test_the_numbers_of_trajectories_are_no_list(model: str, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[range] = []

    def none(self: Runs, drawing: Any, numbers: range, recorded: Any) -> Iterator[Any]:
        drawn.append(numbers)
        raise OutOfTimeError
        yield

    monkeypatch.setattr(Runs, "draw", none)
    # 100 million of them took gigabytes, and 20 seconds in which no limit was looked at.
    numbered = trajectories.trajectories
    shown: list[Any] = []
    monkeypatch.setattr(
        "tachk.simulation.statistics.estimate.trajectories",
        lambda network, question, source, numbers: (
            shown.append(numbers) or numbered(network, question, source, numbers)
        ),
    )
    status, output = run("estimate", model, "simulate [<=10;100000] {x}")
    assert (status, "unknown (time limit)" in output) == (20, True)
    assert (shown, drawn) == ([range(100000)], [range(100000)])


def test_times(model: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(times, "measured_times", stopping_after(2, times.measured_times, OutOfTimeError))
    status, output = run("time", model, "--to", "P.B", "--over", "N=1..4", "--format", "json")
    told = json.loads(output)
    validate(told, "time")
    assert (status, [row["reason"] for row in told["rows"]]) == (20, ["", "", "time limit", "time limit"])
