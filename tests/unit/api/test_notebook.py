"""What a notebook shows of models, reports and runs."""

from __future__ import annotations

import pickle
from pathlib import Path

import pytest

import tachk
from tachk.model.builder import NetworkBuilder

FISCHER = Path(__file__).parents[3] / "models/classics/fischer.ta"


@pytest.fixture(scope="module")
def report() -> tachk.Report:
    return tachk.load(FISCHER, N=2, WAIT=9).verify(options=tachk.Options().off("symmetry"))


def test_a_model_is_a_picture_with_its_constants() -> None:
    model = tachk.load(FISCHER, N=3)
    assert repr(model) == f"<Model {FISCHER}, N=3>"
    html = model._repr_html_()
    assert "N = 3, " in html
    assert "<svg" in html
    assert repr(model.network) == "<Network of P(1), P(2), P(3)>"


def test_a_model_that_cannot_be_drawn_has_its_name() -> None:
    network = NetworkBuilder()
    a = network.process("P").location("a")
    network.process("Q").location("b", invariant=a.reached)
    assert tachk.Model(network.build(), "<mine>")._repr_html_() == "<p><b>&lt;mine&gt;</b></p>"


def test_a_report_has_its_runs_below_the_table() -> None:
    html = tachk.load(FISCHER, N=2).verify("A[] not P(1).critical", "E<> P(1).critical")._repr_html_()
    assert html.startswith("<table>")
    unexpected, expected = html.split("<details")[1:]
    assert unexpected.startswith(" open>")
    assert "q1 is violated by this run of 3 steps" in unexpected
    assert "idle → request" in unexpected
    assert not expected.startswith(" open")


def test_a_query_that_is_not_checked_is_in_the_table() -> None:
    model = tachk.loads("process P() { init location a; } system P; property s : control: A[] P.a;")
    assert "not checked: game query" in model.verify()._repr_html_()


def test_a_probability_is_in_the_table() -> None:
    model = tachk.loads("process P() { init location a; } system P; property s : Pr[<=10](<> P.a);")
    assert "<td>0.9245 to 1.0000</td>" in model.verify()._repr_html_()


def test_a_run_is_reported_by_names(report: tachk.Report) -> None:
    run = report.run("mutual_exclusion")
    assert run is not None
    assert repr(run) == "<Run of 6 steps about mutual_exclusion>"
    assert "P(1): idle → request" in str(run)
    assert run.states[0].locations == (("P(1)", "idle"), ("P(2)", "idle"))
    assert dict(run.states[-1].locations) == {"P(1)": "critical", "P(2)": "critical"}
    assert dict(run.states[-1].variables)["id"] == 2
    assert [len(step.event.moves) for step in run.steps if step.event] == [1] * 6
    assert "P(1): idle → request" in run._repr_html_()
    assert repr(pickle.loads(pickle.dumps(run))) == repr(run)


def test_where_there_is_no_run_there_is_none(report: tachk.Report) -> None:
    assert report["deadlock_free"].answer is tachk.Answer.HOLDS
    assert report.run("deadlock_free") is None


def test_values_are_in_the_table_and_in_rows() -> None:
    found = tachk.load(FISCHER, N=2).verify("sup{P(1).request}: P(1).x", "E<> P(1).critical")
    assert "P(1).x ≤ 10" in found._repr_html_().split("<details")[0]
    assert [row["values"] for row in found.to_rows()] == ["P(1).x ≤ 10", None]
    (line,) = [line for line in found.to_text().splitlines() if line.startswith("  q1 ")]
    assert "P(1).x ≤ 10" in line and "holds" not in line


PLAIN = """const int C = 1; int n; clock x;
process P() { init location A { invariant x <= 3; to B { guard x > C; } } location B; }
system P;
property reached : E<> P.B;
"""


def test_what_python_prints_is_what_the_program_prints() -> None:
    model = tachk.loads(PLAIN)
    times, deep = model.time(None, "P.B"), model.check()
    estimates = model.estimate("Pr[<=9](<> P.B)", "Pr[<=9](<> P.B) >= 0.5")
    assert str(times) == "best: > 1, worst: 3, waits: 3"
    assert repr(times) == "<Times best: > 1, worst: 3, waits: 3>"
    assert repr(times.worst) == "Extreme(value=3, strict=False)"
    assert len(repr(estimates[0])) < 500
    assert repr(model.time("P.B", "P.B")) == "<Times best: -, worst: -, waits: for ever>"
    assert repr(model.time(None, "P.B", limits=tachk.Limits(depth=0))).endswith("waits: ? (depth limit)>")
    assert repr(model.properties) == "(<Query reached: E<> P.B>,)"
    assert repr(deep) == "<DeepCheck of all states, findings: 2>"
    assert "time-locks " in str(deep) and "W0608: the variable `n` is never used" in str(deep)
    assert repr(estimates) == "<Estimates of <text>: q1: 0.9245 to 1.0000, q2: holds>"
    assert str(estimates) == estimates.to_text()
    assert repr(estimates[0].query) == "<StatisticalQuery q1: Pr[<=9](<> P.B)>"


def test_texts_in_notebooks() -> None:
    model = tachk.loads(PLAIN)
    over = "C=0..1"
    shown = (model.time(None, "P.B"), model.check(), model.estimate("Pr[<=9](<> P.B)"))
    for each in (*shown, model.synthesize("E<> P.B", over=over), model.sweep("E<> P.B", over=over, processes=1)):
        html = each._repr_html_()
        assert html.startswith("<pre") and html.count("<") == 2
        assert html.count("\n") == str(each).count("\n")
