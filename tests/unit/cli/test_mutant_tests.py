"""`tachk tests --cover mutants`."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import jsonschema
from click.testing import CliRunner

from tachk.cli.main import app

ROOT = Path(__file__).parents[3]
THERMOSTAT = ROOT / "examples" / "thermostat" / "thermostat.ta"
SCHEMA = ROOT / "docs/schema/mutant_tests.schema.json"


def made(*given: object) -> tuple[int, str]:
    outcome = CliRunner().invoke(app, ["tests", *map(str, given), "--cover", "mutants"])
    return outcome.exit_code, outcome.output


def report(*given: object) -> dict[str, Any]:
    status, output = made(*given, "--format", "json")
    assert status == 0, output
    document: dict[str, Any] = json.loads(output)
    jsonschema.validate(document, json.loads(SCHEMA.read_text(encoding="utf-8")))
    return document


def test_mutants_of_the_thermostat(tmp_path: Path) -> None:
    document = report(THERMOSTAT, "-o", tmp_path)
    results = {each["name"]: each["result"] for each in document["mutants"]}
    assert len(results) == document["count"] == 48
    killed = {name for name, result in results.items() if result == "killed"}
    assert killed == {name for script in document["scripts"] for name in script["kills"]}
    assert len(killed) == document["killed"]
    assert killed >= {
        "Thermostat: Off -> Resting: edge missing",
        "Thermostat: Resting -> On: bound smaller (rest >= REST by 11)",
        "Thermostat: Stopping -> Off: clocks not set",
        "Thermostat: Starting -> On: sends nothing",
        "Thermostat.Resting: invariant larger (rest <= REST + REACTION by 11)",
    }
    # The room changes no faster than every 30 ms, and the thermostat has switched by then.
    equivalent = {name for name, result in results.items() if result == "equivalent"}
    assert {name.split(":")[1].strip() for name in equivalent} == {"Starting -> Off", "Stopping -> On"}
    # Whoever is earlier than he must be does what the model allows.
    assert results["Thermostat.Stopping: invariant smaller (since <= REACTION by 11)"] == "survived"
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_mutants.py"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert f"{len(document['scripts'])} passed" in done.stdout, done.stdout
    for script in document["scripts"]:
        inputs = str(tmp_path / script["file"])
        repeated = ["test", str(THERMOSTAT), "--simulate", str(THERMOSTAT), "--inputs", inputs, "--quiet"]
        assert CliRunner().invoke(app, repeated).exit_code == 0


def test_without_time_mutants_are_not_tried() -> None:
    """What was found by then is in the report."""
    for seconds in ("0.3", "1.5"):
        status, output = made(THERMOSTAT, "--max-seconds", seconds)
        assert (status, "not tried, as the time was over" in output) in ((20, True), (0, False)), output


def test_a_test_that_a_limit_ended_is_not_survived() -> None:
    status, output = made(THERMOSTAT, "--max-states", "1")
    assert status == 20 and "0 of 48" in output and "survived" not in output and "state limit" in output, output


def test_a_mutant_that_cannot_receive_an_input_has_no_verdict() -> None:
    mutants = report(THERMOSTAT)["mutants"]
    reasons = {each["name"]: each["reason"] for each in mutants if each["result"] == "inconclusive"}
    assert "cannot receive `reading`" in reasons["Thermostat: Off -> Starting: clocks not set"]
    assert all(reasons.values())


def test_the_model_needs_an_environment() -> None:
    status, output = made(ROOT / "models" / "classics" / "fischer.ta")
    assert status == 2 and "does not say what can be seen" in output
