"""Verdicts of z3, alone and beside those of the zone engine."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import CliRunner

from tachk.cli.exit_status import ExitStatus
from tachk.cli.main import app
from tachk.engine.options import Engine, Limits, Options
from tachk.engine.outcome import GoalOutcome, Outcome, Statistics, Status
from tachk.engine.smt import search
from tachk.verify.strategy import DisagreementError
from tachk.verify.verdict import Answer, Verdict

Verdicts = Callable[..., dict[str, Verdict]]

SMT, BOTH = Options(engine=Engine.SMT), Options(engine=Engine.BOTH)

MODEL = """
process P() {
    clock x;
    init location A { invariant x <= 3; to B { guard x >= 2; } }
    location B;
}
system P;
property reached : E<> P.B;
property in_time : A[] P.A imply P.x <= 3;
property late : E<> P.A && P.x > 3;
property prompt : G (rise(P.B) -> F[0, 1] P.A);
"""


@pytest.mark.parametrize("options", [SMT, BOTH])
def test_answers_and_runs_are_those_of_the_zone_engine(verdicts: Verdicts, options: Options) -> None:
    expected, found = verdicts(MODEL), verdicts(MODEL, options=options)
    assert {name: v.answer for name, v in found.items()} == {name: v.answer for name, v in expected.items()}
    assert {name: v.trace is None for name, v in found.items()} == {n: v.trace is None for n, v in expected.items()}
    assert all(verdict.notes == () for verdict in found.values())


def test_where_one_engine_gives_up_the_other_answers(verdicts: Verdicts) -> None:
    text = """
    int half(int k) { double d = k; return fint(d / 2); }
    process P() { init location A { to B { guard half(3) == 1; } } location B; }
    system P;
    property p : E<> P.B;
    """
    found = verdicts(text, options=BOTH)["p"]
    assert found.answer is Answer.HOLDS
    assert "only the zone engine" in found.notes[0]
    refused = verdicts(text, options=SMT)["p"]
    assert refused.answer is Answer.UNKNOWN
    assert refused.unsupported is not None
    assert refused.unsupported.code == "E0745"


def claims_the_opposite(network: object, goals: list[object], *_: object) -> Outcome:
    return Outcome(tuple(GoalOutcome(Status.UNREACHABLE) for _ in goals), Statistics())


def test_a_contradiction_is_an_internal_error(verdicts: Verdicts, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search, "explore", claims_the_opposite)
    with pytest.raises(DisagreementError) as caught:
        verdicts(MODEL, options=BOTH)
    assert caught.value.query.name == "reached"
    assert (caught.value.one.strategy, caught.value.other.strategy) == ("zones", "smt")
    assert (caught.value.one.answer, caught.value.other.answer) == (Answer.HOLDS, Answer.FAILS)


def test_a_contradiction_is_written_to_a_file(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(search, "explore", claims_the_opposite)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    model = tmp_path / "model.ta"
    model.write_text(MODEL, encoding="utf-8")
    result = CliRunner().invoke(app, ["verify", str(model), "--engine", "both", "--property", "reached"])
    assert result.exit_code == ExitStatus.INTERNAL_ERROR
    (report,) = tmp_path.glob("tachk-disagreement-*.json")
    assert str(report) in result.output
    content = json.loads(report.read_text(encoding="utf-8"))
    assert content["text"] == MODEL
    assert content["query"] == "E<> P.B"
    assert content["zones"]["results"][0]["answer"] == "holds"
    assert content["smt"]["results"][0]["answer"] == "fails"


def test_a_limit_on_depth_is_obeyed(verdicts: Verdicts) -> None:
    found = verdicts(MODEL, options=SMT, limits=Limits(depth=0))["reached"]
    assert (found.answer, found.reason) == (Answer.UNKNOWN, "depth limit")
