"""`tachk test`."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree

import jsonschema
import pytest
from click.testing import CliRunner

from tachk.cli.main import app

ROOT = Path(__file__).parents[3]
MODEL = ROOT / "examples" / "thermostat" / "thermostat.ta"


@pytest.mark.parametrize("fails", [False, True])
def test_reports(tmp_path: Path, fails: bool) -> None:
    system = MODEL.with_name("worn_out.ta") if fails else MODEL
    junit, recording = tmp_path / "junit.xml", tmp_path / "test.jsonl"
    given = ["test", str(MODEL), "--simulate", str(system), "--for", "20s", "--shorten", "20"]
    outcome = CliRunner().invoke(app, [*given, "--format", "json", "--junit", str(junit), "--record", str(recording)])
    assert outcome.exit_code == (10 if fails else 0), outcome.output
    report = json.loads(outcome.output)
    jsonschema.validate(report, json.loads((ROOT / "docs/schema/test.schema.json").read_text(encoding="utf-8")))
    assert report["verdict"] == ("fail" if fails else "pass")
    assert report["conformance"]["accepted"] is not fails
    assert (report["shortening"] is not None) is fails
    suite = ElementTree.parse(junit).getroot()[0]
    assert (suite.get("failures"), suite.get("errors")) == ("1" if fails else "0", "0")
    assert len(recording.read_text(encoding="utf-8").splitlines()) == len(report["events"]) + 1
    conform = CliRunner().invoke(app, ["conform", str(MODEL), str(recording), "--quiet"])
    assert conform.exit_code == outcome.exit_code


def test_wrong_arguments(tmp_path: Path) -> None:
    def message(*given: str) -> str:
        outcome = CliRunner().invoke(app, ["test", *given])
        assert outcome.exit_code == 2
        return outcome.output

    closed = tmp_path / "closed.ta"
    closed.write_text("process P() { init location A {} } system P;", encoding="utf-8")
    assert "name one system to test" in message(str(MODEL))
    assert "does not say what can be seen" in message(str(closed), "--simulate", str(closed))
    assert "names no system" in message(str(MODEL), "--adapter", "prozess:./x")
    assert "cannot be started" in message(str(MODEL), "--adapter", "process:/there/is/none")
    assert "is not a duration" in message(str(MODEL), "--simulate", str(MODEL), "--for", "soon")
    simulated = (str(MODEL), "--simulate", str(MODEL))
    assert "has no property 'edge'" in message(*simulated, "--goal", "edge")
    inputs = tmp_path / "inputs.jsonl"
    assert "there is no file" in message(*simulated, "--inputs", str(inputs))
    inputs.write_text('{"time [ms]": 5, "event": "heater", "on": 1}\n', encoding="utf-8")
    assert "the inputs in the model are `reading`" in message(*simulated, "--inputs", str(inputs))
    inputs.write_text('{"time [ms]": 5, "event": "reading", "warm": 1}\n', encoding="utf-8")
    assert "line 1: the event does not say its cold" in message(*simulated, "--inputs", str(inputs))
    assert "have no other goal" in message(*simulated, "--inputs", str(inputs), "--goal", "edges")


def test_a_test_is_repeated_from_its_recording(tmp_path: Path) -> None:
    first, again = tmp_path / "first.jsonl", tmp_path / "again.jsonl"

    def tested(system: Path, *given: str) -> int:
        return CliRunner().invoke(app, ["test", str(MODEL), "--simulate", str(system), *given]).exit_code

    worn_out = MODEL.with_name("worn_out.ta")
    assert tested(worn_out, "--for", "20s", "--record", str(first)) == 10
    assert tested(worn_out, "--inputs", str(first), "--record", str(again)) == 10
    assert tested(MODEL, "--inputs", str(first)) == 0
    assert again.read_text(encoding="utf-8").splitlines()[:-1] == first.read_text(encoding="utf-8").splitlines()[:-1]


def test_inputs_that_the_environment_does_not_send_say_nothing(tmp_path: Path) -> None:
    inputs = tmp_path / "inputs.jsonl"
    inputs.write_text('{"time [ms]": 5, "event": "reading", "cold": 1}\n', encoding="utf-8")
    outcome = CliRunner().invoke(app, ["test", str(MODEL), "--simulate", str(MODEL), "--inputs", str(inputs)])
    assert outcome.exit_code == 20
    assert "the test sent `reading` at a moment at which the environment of the model does not" in outcome.output
