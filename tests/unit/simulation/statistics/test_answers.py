"""Statistical queries among those of a verification: what counts, and how each form of report tells them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import tachk
from tachk.cli.exit_status import ExitStatus
from tachk.cli.reporting import RunReporting
from tachk.cli.verification import VerifyArguments, run_verify
from tachk.engine.options import Limits
from tachk.formats.written_reports import validator
from tachk.report.statistics.verifyta import statistical_lines
from tachk.simulation.statistics.answers import StatisticalAnswer, answer_statistical
from tachk.simulation.statistics.estimate import DrawnRuns, Settings

pytestmark = pytest.mark.drawn

ROOT = Path(__file__).parents[4]
MODEL = """
clock x;
double level = 0.5;
process A() { init location s { invariant x <= 5; to t { assign level = level * 2; } } location t; }
system A;
"""
TESTS = """
property likely : Pr[<=4](<> A.t) >= 0.5;
property rare : Pr[<=1](<> A.t) >= 0.5 expect fails;
property often : Pr[<=4](<> A.t) expect holds;
property doubled : Pr[<=10](<> level > 0.9) expect holds;
"""


def test_expectations_count() -> None:
    report = tachk.loads(MODEL + TESTS).verify()
    assert report.met is True
    assert report.to_text().splitlines()[-1] == "4 passed"
    assert all(answer.met for answer in report.estimates.values())


@pytest.mark.parametrize(
    ("query", "met", "last"),
    [
        ("Pr[<=1](<> A.t) >= 0.5", False, "1 failed"),
        ("Pr[<=1](<> A.t) expect fails", False, "1 failed"),
        ("Pr[<=1; 5](<> A.t) >= 0.2", None, "1 unknown"),
        ("Pr[<=1](<> A.t)", True, "1 estimated"),
        ("E[<=1; 10](max: x)", True, "1 estimated"),
        ("simulate [<=1; 2] {x}", True, "1 estimated"),
    ],
)
def test_what_is_not_as_expected(query: str, met: bool | None, last: str) -> None:
    report = tachk.loads(f"{MODEL}property p : {query};").verify()
    assert report.estimates["p"].met is met
    assert report.met is met
    assert report.to_text().splitlines()[-1] == last


@pytest.mark.parametrize(("divisor", "last"), [(5, 4), (3, 2), (1, None)])
def test_a_recorded_run_ends_before_the_state_that_cannot_be_evaluated(divisor: int, last: int | None) -> None:
    """A state is recorded with all its values or not at all, the initial one too."""
    model = tachk.loads(
        "int[0, 100] n = 1;\n"
        "process P() { clock x; init location a { invariant x <= 2; to a { guard x >= 1; assign n++, x = 0; } } }\n"
        f"system P; property p : simulate [<=20; 1] {{n, 10 / (n - {divisor}), n}};"
    )
    report = model.verify()
    found = report.estimates["p"].found
    assert isinstance(found, DrawnRuns)
    (run,) = found.runs
    assert run.ending.value == "run-time error"
    first, _, third = (list(line.values) for line in run.lines)
    assert first == third
    assert (first[-1] if first else None) == last


def test_a_run_time_error_is_never_as_expected() -> None:
    text = "int[0, 1] n = 1; process P() { init location a { to b { assign n = n + 1; } } location b; } system P;"
    report = tachk.loads(f"{text}property p : Pr[<=100](<> P.b);").verify()
    assert report.estimates["p"].met is False


def test_without_time_there_is_no_answer() -> None:
    loaded = tachk.loads(f"{MODEL}property p : Pr[<=1](<> A.t);").loaded
    answer = answer_statistical(lambda: loaded, loaded.formulas, Settings(), Limits(seconds=0))[1]
    assert isinstance(answer, StatisticalAnswer)
    assert (answer.found, answer.reason, answer.met) == (None, "time limit", None)


def test_a_model_that_only_simulations_read_is_answered() -> None:
    text = MODEL.replace("invariant x <= 5;", "invariant x <= 5 && y' == 3;").replace("clock x;", "clock x, y;")
    report = tachk.loads(f"{text}property p : Pr[<=1](<> y >= 2.9) >= 0.5;").verify()
    assert report.estimates["p"].met is True


def test_wrong_queries() -> None:
    with pytest.raises(tachk.InputError, match="nowhere"):
        tachk.loads(MODEL).verify("Pr[<=1](<> A.nowhere)")
    report = tachk.loads(MODEL).verify("Pr[<=1](<> deadlock)", "E<> A.t")
    assert [query.reason for query in report.record.not_checked] == [
        "`deadlock` is not looked for in runs that are drawn"
    ]
    assert report.met is None


def test_forms_of_reports(tmp_path: Path) -> None:
    path = tmp_path / "m.ta"
    path.write_text(MODEL + TESTS + "property bad : Pr[<=1](<> A.t) >= 0.5;\nproperty s : simulate [<=1; 2] {x};\n")
    out = tmp_path / "out"
    for form in ("json", "junit", "text"):
        status = run_verify(VerifyArguments((str(path),)), reporting=RunReporting(form, out))
        assert status is ExitStatus.NOT_AS_EXPECTED
        text = out.read_text()
        if form == "json":
            document = json.loads(text)
            validator("verify").validate(document)
            (run,) = document["runs"]
            for each in run["estimates"]:
                whole = {**{name: each[name] for name in ("seed", "confidence", "alpha", "beta", "delta")}, "model": ""}
                validator("estimate").validate({**whole, "answers": [each["found"]]})
            assert [each["met"] for each in run["estimates"]] == [True, True, True, True, False, True]
        elif form == "junit":
            assert 'tests="6" failures="1" errors="0" skipped="0"' in text
            assert '<failure message="bad: Pr[&lt;=1](&lt;&gt; A.t) &gt;= 0.5: fails"' in text
        else:
            assert "✗ bad: Pr[<=1](<> A.t) >= 0.5: fails" in text


def test_a_page_has_them() -> None:
    page = tachk.loads(MODEL + TESTS + "property bad : Pr[<=1](<> A.t) >= 0.5;").verify().to_page()
    assert "1 not as expected" in page
    assert "<td>often</td>" in page


def test_estimate_answers_the_same() -> None:
    model = tachk.loads(MODEL + TESTS)
    found = model.verify().estimates["often"].found
    again = model.estimate("Pr[<=4](<> A.t)")[0]
    assert (found.low, found.high) == (again.low, again.high)  # type: ignore[union-attr]


def test_runs_that_are_reported_obey_the_limit_on_memory() -> None:
    text = "int n = 0; process P() { init location a { to a { select i : int[0, 9]; assign n = i; } } } system P;"
    loaded = tachk.loads(text + " property p : simulate [<=1000; 1000000] {n};").loaded
    limits = Limits(seconds=100, memory_bytes=50 << 20)
    answer = answer_statistical(lambda: loaded, loaded.formulas, Settings(), limits)[1]
    assert isinstance(answer, StatisticalAnswer)
    assert (answer.found, answer.reason) == (None, "memory limit")


@pytest.mark.parametrize(
    "query", ["Pr[<=9](<> A.t)", "E[<=9; 5](max: x)", "simulate[<=9] {x}", "simulate[<=9; 5] {x}: A.t"]
)
def test_an_answer_of_runs_that_end_in_errors_counts_as_not_expected(tmp_path: Path, query: str) -> None:
    """The summary and the exit status agree, with and without an expectation."""
    path = tmp_path / "m.ta"
    process = "process A() { clock c; init location s { invariant c <= 5; to t { assign x = 1 / zero; } } location t; }"
    for expect in ("", " expect holds"):
        path.write_text(
            f"int zero = 0, x;\n{process}\nsystem A;\nproperty p : E<> A.s;\nproperty q : {query}{expect};\n"
        )
        report = tachk.load(path).verify()
        assert report.met is False
        assert report.to_text().splitlines()[-1] == "1 passed, 1 failed"


@pytest.mark.parametrize("expect", ["", " expect holds"])
def test_a_mean_of_no_value_is_no_answer(expect: str) -> None:
    """Steps without end take no time in every run, so that none has a value."""
    model = "clock x; process A() { init location s { invariant x <= 0; to s {} } } system A;"
    report = tachk.loads(f"{model} property q : E[<=10; 20](max: x){expect};").verify()
    assert report.estimates["q"].met is None
    assert report.to_text().splitlines()[-1] == "1 unknown"
    text = "\n".join(statistical_lines(report.estimates["q"]))
    assert "no answer: no run has a value" in text
    assert "satisfied" not in text
