"""`tachk tests`."""

from __future__ import annotations

import ast
import json
import os
import subprocess
import sys
from pathlib import Path

import jsonschema
import pytest
from click.testing import CliRunner

from tachk.cli.main import app
from tachk.report.covering.replaying_file import pytest_file
from tests.unit.simulation.testing.test_tester import DRIVEN, LAMP, program

ROOT = Path(__file__).parents[3]
FISCHER = ROOT / "models" / "classics" / "fischer.ta"
THERMOSTAT = ROOT / "examples" / "thermostat" / "thermostat.ta"
UNREACHED = """
process P() {
    clock x;
    init location A {
        invariant x <= 2;
        to B { guard x >= 2; }
        to C { guard x > 2; }
    }
    location B {}
    location C { to A {} }
}
system P;
"""


def made(*given: object) -> tuple[int, str]:
    outcome = CliRunner().invoke(app, ["tests", *map(str, given)])
    return outcome.exit_code, outcome.output if outcome.exit_code == 2 else outcome.stdout


def report(*given: object) -> tuple[int, dict]:
    status, output = made(*given, "--format", "json")
    document = json.loads(output)
    jsonschema.validate(document, json.loads((ROOT / "docs/schema/tests.schema.json").read_text(encoding="utf-8")))
    return status, document


@pytest.mark.parametrize("cover", ["edges", "locations"])
def test_every_run_that_is_written_replays(tmp_path: Path, cover: str) -> None:
    status, document = report(FISCHER, "-D", "N=3", "--cover", cover, "-o", tmp_path / "suite")
    assert (status, document["covered"], document["unknown"]) == (0, document["count"], [])
    assert {path.name for path in (tmp_path / "suite").iterdir()} == {
        "test_cover.py",
        *(name for run in document["runs"] for name in run["files"]),
    }
    for run in document["runs"]:
        (name,) = run["files"]
        replayed = CliRunner().invoke(app, ["replay", str(FISCHER), str(tmp_path / "suite" / name), "--quiet"])
        assert replayed.exit_code == 0, replayed.output
    assert len(set().union(*(run["covered"] for run in document["runs"]))) == document["covered"]


def test_a_suite_fails_for_a_changed_model(tmp_path: Path) -> None:
    model = tmp_path / "thermostat.ta"
    text = THERMOSTAT.read_text(encoding="utf-8")
    model.write_text(text, encoding="utf-8")
    status, output = made(model, "-o", tmp_path / "suite")
    assert (status, "1 run with 8 steps takes 8 of 10 edges; 2 cannot be taken" in output) == (0, True)

    def replayed() -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "suite/test_cover.py"]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)

    assert "3 passed" in replayed().stdout
    changed = text.replace("rest >= REST", "rest >= REST + 1")
    assert changed != text
    model.write_text(changed, encoding="utf-8")
    assert "failed" in replayed().stdout


@pytest.mark.parametrize(("delay", "result"), [(4, "passed"), (7.5, "failed")])
def test_a_suite_tests_a_program(tmp_path: Path, delay: float, result: str) -> None:
    """Without one it says that there is none."""
    model = tmp_path / "lamp.ta"
    model.write_text(LAMP, encoding="utf-8")
    assert made(model, "-o", tmp_path / "suite")[0] == 0
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-rs", "suite/test_cover.py"]
    for adapter, expected in (
        (None, "TACHK_ADAPTER names no system"),
        (f"driven:{program(DRIVEN, delay)}", f"1 {result}"),
    ):
        environment = {**os.environ} if adapter is None else {**os.environ, "TACHK_ADAPTER": adapter}
        run = [*command, "-k", "test_system"]
        done = subprocess.run(run, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
        assert expected in done.stdout, done.stdout


def test_what_cannot_be_covered_has_a_reason(tmp_path: Path) -> None:
    model = tmp_path / "m.ta"
    model.write_text(UNREACHED, encoding="utf-8")
    status, output = made(model)
    assert status == 0
    assert output.splitlines() == [
        f"{model}: 1 run with 1 step takes 1 of 3 edges; 2 cannot be taken",
        "  run 1: 1 step, to 2, 1 more edge",
        "cannot be taken:",
        "  P: A -> C: no run takes it",
        "  P: C -> A: no run reaches the location that it leaves",
    ]
    status, document = report(model, "--cover", "locations")
    assert [each["name"] for each in document["impossible"]] == ["P.C"]


def test_limits_leave_places_unknown(tmp_path: Path) -> None:
    status, document = report(FISCHER, "-D", "N=4", "--max-seconds", "0", "-o", tmp_path)
    assert (status, document["runs"], document["covered"]) == (20, [], 0)
    assert {each["reason"] for each in document["unknown"]} == {"time limit"}
    assert made(FISCHER, "-D", "N=4", "--max-states", "1", "-q") == (20, "")


def test_wrong_arguments(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("", encoding="utf-8")
    status, output = made(FISCHER, "-o", file)
    assert (status, "cannot be made" in output) == (2, True)
    assert made(tmp_path / "none.ta")[0] == 2


def certified(folder: Path, *given: str) -> tuple[int, str]:
    files = [str(folder / f"cannot_be_covered.{end}") for end in ("ta", "cert")]
    outcome = CliRunner().invoke(app, ["certify", *files, *given])
    return outcome.exit_code, outcome.stdout


@pytest.mark.parametrize("cover", ["edges", "locations"])
def test_what_is_impossible_has_a_certificate(tmp_path: Path, cover: str) -> None:
    model = tmp_path / "model.ta"
    model.write_text(UNREACHED.replace("clock x;", "clock x; bool taken_1;"), encoding="utf-8")
    status, document = report(model, "--cover", cover, "-o", tmp_path / "suite")
    assert (status, len(document["impossible"])) == (0, {"edges": 2, "locations": 1}[cover])
    status, output = certified(tmp_path / "suite")
    conditions = {"edges": "!(P.taken__1 || P.taken__2)", "locations": "!(P.C)"}[cover]
    assert status == 0 and f"never_covered: A[] {conditions}" in output, output
    tests = (tmp_path / "suite" / "test_cover.py").read_text(encoding="utf-8")
    assert "def test_proofs" in tests and "cannot_be_covered.cert" in tests


def test_certificate_is_about_the_same_constants(tmp_path: Path) -> None:
    """Without its constants the edge can be taken, and the certificate is rejected."""
    model = tmp_path / "model.ta"
    model.write_text("const int LIMIT = 3;\n" + UNREACHED.replace("x > 2", "x >= LIMIT"), encoding="utf-8")
    assert made(model, "-o", tmp_path / "suite", "-q")[0] == 0
    assert certified(tmp_path / "suite")[0] == 0
    assert certified(tmp_path / "suite", "-D", "LIMIT=2")[0] == 10


def test_certificate_of_an_earlier_suite_does_not_stay(tmp_path: Path) -> None:
    model = tmp_path / "model.ta"
    model.write_text(UNREACHED, encoding="utf-8")
    assert made(model, "-o", tmp_path / "suite", "-q")[0] == 0
    model.write_text(UNREACHED.replace("x > 2", "x >= 2"), encoding="utf-8")
    assert made(model, "-o", tmp_path / "suite", "-q")[0] == 0
    assert {path.name for path in (tmp_path / "suite").iterdir()} & {
        "cannot_be_covered.ta",
        "cannot_be_covered.cert",
    } == set()


def test_the_pytest_file_names_any_model() -> None:
    name = 'mö 😀 {x} "y" \\ z.ta'
    text = pytest_file(name, ["A=1"], [name], [], [])
    assigned = {
        statement.targets[0].id: statement.value
        for statement in ast.parse(text).body
        if isinstance(statement, ast.Assign) and isinstance(statement.targets[0], ast.Name)
    }
    assert ast.literal_eval(assigned["RUNS"]) == [name]
    assert f"FOLDER / {json.dumps(name, ensure_ascii=False)}" in text
