from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from tachk.cli.commands.check import run_check
from tachk.cli.exit_status import ExitStatus
from tachk.formats.uppaal.versions import UppaalVersion

SCHEMA = Path(__file__).parents[3] / "docs/schema/check.schema.json"
GOOD = "process P() { init location a { to b; } location b; }\nsystem P;\n"
WRONG = "process P() {\n    init location a { to c; }\n}\nsystem P;\n"
ODD = "process P() { init location a; location c; }\nsystem P;\n"


@pytest.fixture
def models(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[str, ...]:
    monkeypatch.chdir(tmp_path)
    for name, text in {"good.ta": GOOD, "wrong, 1%.ta": WRONG, "odd.ta": ODD}.items():
        Path(name).write_text(text, encoding="utf-8")
    return "good.ta", "wrong, 1%.ta", "odd.ta", "gone.ta"


def report(models: tuple[str, ...], format: str, capsys: pytest.CaptureFixture[str], **more: Any) -> str:
    assert run_check(models, (), form=format, **more) is ExitStatus.BAD_INPUT
    captured = capsys.readouterr()
    assert captured.err == ""
    return captured.out


def test_json_has_every_model_and_follows_its_schema(
    models: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    data = json.loads(report(models, "json", capsys))
    jsonschema.validate(data, json.loads(SCHEMA.read_text(encoding="utf-8")))
    good, wrong, odd, gone = data["models"]
    assert good["size"] == {"processes": 1, "locations": 2, "edges": 1, "properties": 0}
    assert good["findings"] == []
    assert wrong["size"] is None
    (finding,) = wrong["findings"]
    assert finding["severity"] == "error"
    assert finding["place"] == {"file": "wrong, 1%.ta", "line": 2, "column": 26, "end_line": 2, "end_column": 27}
    assert [found["severity"] for found in odd["findings"]] == ["warning"]
    assert gone["findings"][0]["message"] == "there is no file gone.ta"


def test_portability_is_apart(models: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    data = json.loads(report(models, "json", capsys, version=UppaalVersion.UPPAAL_4_1))
    jsonschema.validate(data, json.loads(SCHEMA.read_text(encoding="utf-8")))
    assert isinstance(data["models"][0]["portability"], list)
    assert data["models"][1]["portability"] is None


def test_sarif_names_rules_places_and_what_has_no_place(
    models: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    data = json.loads(report(models, "sarif", capsys))
    assert data["version"] == "2.1.0"
    (run,) = data["runs"]
    rules = run["tool"]["driver"]["rules"]
    error, warning = run["results"]
    assert (error["level"], warning["level"]) == ("error", "warning")
    for result in (error, warning):
        assert rules[result["ruleIndex"]]["id"] == result["ruleId"]
        assert rules[result["ruleIndex"]]["fullDescription"]["text"]
    physical = error["locations"][0]["physicalLocation"]
    assert physical["artifactLocation"]["uri"] == "wrong%2C%201%25.ta"
    assert physical["region"] == {"startLine": 2, "startColumn": 26, "endLine": 2, "endColumn": 27}
    (invocation,) = run["invocations"]
    assert invocation["executionSuccessful"] is False
    assert "gone.ta" in invocation["toolExecutionNotifications"][0]["message"]["text"]


def test_github_gets_one_escaped_line_for_each_finding(
    models: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    error, warning, gone = report(models, "github", capsys).splitlines()
    assert error.startswith("::error file=wrong%2C 1%25.ta,line=2,endLine=2,col=26,endColumn=27,title=E")
    assert warning.startswith("::warning file=odd.ta,line=1,")
    assert gone.startswith("::error title=tachk::gone.ta: there is no file gone.ta")


def test_a_report_goes_to_a_file(models: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    assert report(models, "json", capsys, output=Path("r.json")) == ""
    assert len(json.loads(Path("r.json").read_text(encoding="utf-8"))["models"]) == 4


def test_a_deep_check_in_every_form(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any) -> None:
    monkeypatch.chdir(tmp_path)
    Path("stuck.ta").write_text("process P() { clock x; init location a { invariant x <= 3; } }\nsystem P;\n")
    assert run_check(("stuck.ta",), (), form="json", deep=True) is ExitStatus.AS_EXPECTED
    data = json.loads(capsys.readouterr().out)
    jsonschema.validate(data, json.loads(SCHEMA.read_text(encoding="utf-8")))
    deep = data["models"][0]["deep"]
    assert deep["complete"]
    finding, always = [finding for question in deep["questions"] for finding in question["findings"]]
    assert (always["code"], always["trace"]) == ("W0610", None)
    assert (finding["code"], finding["place"]["line"], finding["place"]["column"]) == ("W0605", 1, 52)
    assert [state["time"] for state in finding["trace"]] == ["0"]
    run_check(("stuck.ta",), (), form="sarif", deep=True)
    assert [found["ruleId"] for found in json.loads(capsys.readouterr().out)["runs"][0]["results"]] == [
        "W0605",
        "W0610",
    ]
    run_check(("stuck.ta",), (), form="github", deep=True)
    assert capsys.readouterr().out.startswith("::warning file=stuck.ta,line=1,endLine=1,col=52")
    run_check(("stuck.ta",), (), deep=True)
    captured = capsys.readouterr()
    assert "time-locks                      reached by every run" in captured.out
    assert "W0605 at stuck.ta:1:52 is reached by this run" in captured.out
    assert "warning[W0605]" in captured.err


def test_a_deep_check_that_ends_early_is_undecided(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("fault.ta").write_text("int[0,3] n;\nprocess P() { init location a { to a { assign n++; } } }\nsystem P;\n")
    assert run_check(("fault.ta",), (), deep=True) is ExitStatus.UNKNOWN
    out = capsys.readouterr().out
    assert "then not on: run-time error" in out
    assert "time-locks                      not decided (run-time error)" in out
