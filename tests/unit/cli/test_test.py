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
