"""What is known where a limit stops a command in the middle: told, and the rest is unknown with the reason."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from click.testing import CliRunner

from tachk.api.model import Model
from tachk.base.job import OutOfTimeError
from tachk.cli.main import app
from tachk.simulation.runs import Runs
from tachk.simulation.statistics.estimate import estimate
from tachk.simulation.tables import decimal_time

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
    monkeypatch.setattr("tachk.simulation.tables.decimal_time", stopping_after(1, decimal_time, KeyboardInterrupt))
    status, output = run("simulate", model, "--runs", "3", "--seed", "1")
    assert (status, "1 of 3 runs" in output) == (130, True)
    monkeypatch.setattr("tachk.simulation.tables.decimal_time", stopping_after(0, decimal_time, KeyboardInterrupt))
    status, output = run("simulate", model, "--format", "json")
    assert (status, json.loads(output)["runs"]) == (130, 0)


def test_times(model: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Model, "time", stopping_after(2, Model.time, OutOfTimeError))
    status, output = run("time", model, "--to", "P.B", "--over", "N=1..4", "--format", "json")
    told = json.loads(output)
    validate(told, "time")
    assert (status, [row["reason"] for row in told["rows"]]) == (20, ["", "", "time limit", "time limit"])
