"""Unexpected answers at the lines of their properties, beside the report for people."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path

import pytest

from tachk.cli.main import app

MODEL = """\
int n;
process P() { clock x; init location a { invariant x <= 2; to b { guard x >= 1; assign n = 1; } } location b; }
system P;
property never "n stays 0" : A[] n == 0;
property some : E<> n == 1;
property wide : A[] n < 5 expect fails;
"""
WRONG = "process P() { init location a { to nowhere; } } system P;\n"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("m.ta").write_text(MODEL)
    Path("wrong.ta").write_text(WRONG)


def verify(line: str, capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    status = app.main(["verify", *shlex.split(line)], prog_name="tachk", standalone_mode=False)
    assert isinstance(status, int)
    return status, capsys.readouterr().out


def without_times(text: str) -> str:
    return re.sub(r'time="[^"]*"', "", text)


def test_sarif_has_a_result_at_the_line_of_each_unexpected_answer(capsys: pytest.CaptureFixture[str]) -> None:
    status, out = verify("m.ta wrong.ta 'E<> n == 7' --format sarif", capsys)
    assert status == 2
    (run,) = json.loads(out)["runs"]
    query, mistake = run["results"]
    assert query["message"]["text"] == "q1 fails, expected holds" and query["locations"] == []
    assert "nowhere" in mistake["message"]["text"] and mistake["locations"]
    rules = [rule["id"] for rule in run["tool"]["driver"]["rules"]]
    assert [rules[result["ruleIndex"]] for result in (query, mistake)] == ["unexpected-answer", "E0209"]
    assert run["invocations"][0]["toolExecutionNotifications"] == []

    status, out = verify("gone.ta --format sarif", capsys)
    (complaint,) = json.loads(out)["runs"][0]["invocations"][0]["toolExecutionNotifications"]
    assert status == 2 and "gone.ta" in complaint["message"]["text"]

    assert verify("m.ta --format sarif", capsys)[0] == 10
    status, out = verify("m.ta --format sarif", capsys)
    results = json.loads(out)["runs"][0]["results"]
    assert [result["locations"][0]["physicalLocation"]["region"]["startLine"] for result in results] == [4, 6]
    assert results[0]["message"]["text"].startswith("never fails, expected holds\n")
    assert "P: a → b" in results[0]["message"]["text"]


def test_github_gets_the_report_and_a_line_for_each_unexpected_answer(capsys: pytest.CaptureFixture[str]) -> None:
    plain = verify("m.ta", capsys)[1]
    status, out = verify("m.ta --format github", capsys)
    report, annotations = out.split("::", 1)
    assert status == 10
    assert [line.split() for line in report.splitlines()[-3:]] == [line.split() for line in plain.splitlines()[-3:]]
    first, second = f"::{annotations}".splitlines()
    assert first.startswith("::error file=m.ta,line=4,endLine=4,col=")
    assert ",title=unexpected-answer::never fails, expected holds%0A" in first
    assert second.startswith("::error file=m.ta,line=6,")


def test_an_unknown_answer_is_a_warning(capsys: pytest.CaptureFixture[str]) -> None:
    status, out = verify("m.ta --property wide --max-states 1 --format github", capsys)
    assert status == 20
    assert "::warning file=m.ta,line=6," in out and "title=unknown-answer::wide is unknown: " in out


def test_files_beside_the_report_are_those_of_the_formats(capsys: pytest.CaptureFixture[str]) -> None:
    status, beside = verify("m.ta --junit j.xml --sarif s.sarif", capsys)
    assert status == 10 and "1 passed, 2 failed" in beside
    assert json.loads(Path("s.sarif").read_text()) == json.loads(verify("m.ta --format sarif", capsys)[1])
    assert without_times(Path("j.xml").read_text()) == without_times(verify("m.ta --format junit", capsys)[1])
    assert verify("m.ta --quiet --junit k.xml", capsys) == (10, "")
    assert Path("k.xml").exists()


def test_one_report_cannot_go_to_two_places(capsys: pytest.CaptureFixture[str]) -> None:
    assert verify("m.ta --format junit --junit j.xml", capsys)[0] == 2
    assert not Path("j.xml").exists()


def test_check_writes_sarif_beside_its_report(capsys: pytest.CaptureFixture[str]) -> None:
    assert app.main(["check", "m.ta", "wrong.ta", "--sarif", "c.sarif"], prog_name="t", standalone_mode=False) == 2
    shown = capsys.readouterr()
    assert "m.ta: 1 process" in shown.out and "nowhere" in shown.err
    app.main(["check", "m.ta", "wrong.ta", "--format", "sarif"], prog_name="t", standalone_mode=False)
    assert json.loads(Path("c.sarif").read_text()) == json.loads(capsys.readouterr().out)
