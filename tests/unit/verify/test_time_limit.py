"""The limit on time: how searches share it, and that it ends what comes before them. The clocks are made up."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count
from pathlib import Path
from typing import Any

import pytest

from tachk.base import job as module
from tachk.base.job import OutOfTimeError, check_job, current_job, limited
from tachk.base.resources import data_root
from tachk.base.span import Source
from tachk.cli.actions.run_report import RunReporting
from tachk.cli.actions.verify import VerifyArguments, run_verify
from tachk.cli.exit_status import ExitStatus
from tachk.cli.reporting import ReportForm
from tachk.engine.options import Limits
from tachk.engine.outcome import TIME_LIMIT, GoalOutcome, Outcome, Statistics, Status
from tachk.formats.loading.load import load_model
from tachk.meaning.discrete import prepare
from tachk.verify import over_approximations, reachability
from tachk.verify.verdict import Answer, Verdict
from tachk.verify.verify import verify

SELECT = """
process P() { init location A { to B { select i : int[0, 2000], j : int[0, 2000]; guard i == j; } } location B; }
system P;
property p : E<> P.B;
"""
ENDLESS = """
int f() { int i = 0; while (true) i = 0; return i; }
const int C = f();
process P() { init location A; }
system P;
property p : E<> P.A;
"""
THREE = """
process P() { clock x, y, z; init location A { to A { guard x > 1; assign x = 0, y = 0, z = 0; } } }
system P;
property a : A[] P.x < 9;
property b : A[] P.y < 9;
property c : A[] P.z < 9;
property also_c : A[] P.z < 8;
"""


@pytest.fixture
def looks(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A clock that goes on by a second whenever the time is looked at."""
    ticks = count()
    monkeypatch.setattr(module, "monotonic", lambda: float(next(ticks)))
    return ticks


def answers(text: str, limits: Limits) -> list[Verdict]:
    model = load_model(Source("m.ta", text))
    return list(verify(model.network, model.queries, limits=limits))


def test_without_a_limit_there_is_none(looks: Iterator[int]) -> None:
    with limited(None):
        check_job()
    check_job()
    assert next(looks) == 0


def test_the_narrower_of_two_limits_counts(looks: Iterator[int]) -> None:
    def look(outer: float, inner: float) -> None:
        with limited(outer), limited(inner):
            for _ in range(10):
                check_job()

    for outer, inner in ((5, 100), (100, 5)):
        with pytest.raises(OutOfTimeError):
            look(outer, inner)
    look(100, 100)


def test_no_time_is_over_at_once() -> None:
    with pytest.raises(OutOfTimeError), limited(0):
        pytest.fail("nothing is begun")


XML = "<nta><template><name>P</name>" + "<location id='a'/>" * 3000 + "</template></nta>"
TCHECKER = "system:s\n" + "".join(f"int:1:0:1:0:n{i}\n" for i in range(3000))


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        (ENDLESS, 2000),
        ("int n;" * 5000, 2000),
        (f"int n = {'(' * 90}1{')' * 90};" * 50, 2000),
        (XML, 2000),
        (TCHECKER, 2000),
    ],
)
def test_reading_ends(looks: Iterator[int], text: str, seconds: float) -> None:
    with pytest.raises(OutOfTimeError), limited(seconds):
        load_model(Source("m.ta", text))
    assert next(looks) < seconds + 10


def test_instantiating_ends(looks: Iterator[int]) -> None:
    with pytest.raises(OutOfTimeError), limited(15_000):
        load_model(data_root() / "models/classics/fischer.ta", {"N": 30_000})


def test_compiling_ends(looks: Iterator[int]) -> None:
    model = load_model(Source("m.ta", SELECT))
    (verdict,) = verify(model.network, model.queries, limits=Limits(seconds=3000))
    assert (verdict.answer, verdict.reason) == (Answer.UNKNOWN, TIME_LIMIT)
    assert verdict.statistics == Statistics()


def test_no_time_at_all_is_no_answer() -> None:
    assert {(v.answer, v.reason) for v in answers(THREE, Limits(seconds=0))} == {(Answer.UNKNOWN, TIME_LIMIT)}
    assert {(v.answer, v.reason) for v in answers(THREE, Limits(seconds_each=0))} == {(Answer.UNKNOWN, TIME_LIMIT)}


@pytest.mark.parametrize(
    ("limits", "used", "given"),
    [
        (Limits(seconds=80), [20, 20, 40], [20, 20, 40]),
        (Limits(seconds=80), [2, 3, 0], [20, 26, 75]),
        (Limits(seconds=80, seconds_each=25), [2, 3, 0], [20, 25, 25]),
        (Limits(seconds_each=7), [7, 7, 7], [7, 7, 7]),
        (Limits(), [5, 5, 5], [None, None, None]),
    ],
)
def test_properties_share_the_time_and_leave_what_they_do_not_need(
    monkeypatch: pytest.MonkeyPatch, limits: Limits, used: list[float], given: list[float | None]
) -> None:
    """Two of the four properties share a search, which has two shares."""
    now = [0.0]
    seen: list[float | None] = []

    def explore(program: Any, goals: Any, options: Any, limits: Limits) -> Outcome:
        seen.append(current_job().seconds_left)
        now[0] += used[len(seen) - 1]
        return Outcome(tuple(GoalOutcome(Status.UNREACHABLE) for _ in goals), Statistics())

    monkeypatch.setattr(module, "monotonic", lambda: now[0])
    monkeypatch.setattr(reachability, "explore", explore)
    assert len(answers(THREE, limits)) == 4
    assert seen == given


@pytest.mark.parametrize("text", [ENDLESS, SELECT])
def test_a_time_limit_is_no_error(tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str) -> None:
    model = tmp_path / "m.ta"
    model.write_text(text, encoding="utf-8")
    as_json = RunReporting(ReportForm.JSON)
    assert run_verify(VerifyArguments((str(model),)), limits=Limits(seconds=0), reporting=as_json) is ExitStatus.UNKNOWN
    captured = capsys.readouterr()
    assert captured.err == "error: the time limit was over before there was a result\n"
    assert "the time limit was over" in captured.out


def test_no_time_to_leave_out_what_only_blocks_decides_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def late(*_: object) -> None:
        raise OutOfTimeError

    monkeypatch.setattr(over_approximations, "without_blocking", late)
    text = "process P() { init location A { to B; } location B; } system P; property p : E<> P.B;"
    (verdict,) = answers(text, Limits(seconds=60.0))
    assert verdict.answer is Answer.HOLDS


def test_making_the_instances_of_edges_ends(looks: Iterator[int]) -> None:
    model = prepare(load_model(Source("m.ta", SELECT)).network)
    with pytest.raises(OutOfTimeError), limited(50):
        _ = model.instances
