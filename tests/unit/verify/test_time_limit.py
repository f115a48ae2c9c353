"""The limit on time: how searches share it, and that it ends what comes before them. The clocks are made up."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count
from pathlib import Path
from time import monotonic
from typing import Any

import pytest

from tachk.base import job as module
from tachk.base.job import OutOfTimeError, check_job, current_job, limited
from tachk.base.resources import data_root
from tachk.base.span import Source
from tachk.cli.exit_status import ExitStatus
from tachk.cli.reporting import RunReporting
from tachk.cli.verification import VerifyArguments, run_verify
from tachk.engine import core_search, liveness, measuring, taking_turns, zone
from tachk.engine.options import Limits, Options
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
    as_json = RunReporting("json")
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


MANY = """
int[0, 3] n; chan c;
process P() {
    clock x;
    init location A { invariant x <= 5; to B { guard x >= 1; sync c!; assign n = (n + 1) % 4; } }
    location B { invariant x <= 9; to A { assign x = 0; } }
}
process Q() { init location I { to I { sync c?; } } }
system P, Q;
property reached : E<> P.B && n == 2;
property always : A[] n < 4;
property fails : A[] n < 2;
property inevitable : A<> n == 3;
property leads : P.A --> P.B;
property soon : P.A -->[<= 2] P.B;
property stays : E[] n <= 2;
property most : sup: n;
property latest : sup: P.x;
property formula : G (P.A -> F[0,2] P.B);
property wrong : A[] 1 / (2 - n) >= 0;
"""


@pytest.mark.parametrize("name", [query.name for query in load_model(Source("m.ta", MANY)).queries])
def test_what_the_search_decides_at_the_last_moment_is_reported(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The time is over as soon as the first search of the engine has ended."""
    model = load_model(Source("m.ta", MANY))
    (query,) = (query for query in model.queries if query.name == name)
    options = Options().off("unblocked", "sliced")
    (usual,) = verify(model.network, [query], options)
    late = [0.0]

    def ended(*arguments: Any) -> Any:
        found = core_search.run_in_slices(*arguments)
        late[0] = 1e9
        return found

    monkeypatch.setattr(module, "monotonic", lambda: monotonic() + late[0])
    for engine in (zone, taking_turns, liveness, measuring):
        monkeypatch.setattr(engine, "run_in_slices", ended)
    (hurried,) = verify(model.network, [query], options, Limits(seconds=1000))
    assert late[0] > 0
    assert (hurried.answer, hurried.reason, hurried.trace) == (usual.answer, usual.reason, usual.trace)
    assert (hurried.fault is None) is (usual.fault is None)


def test_a_query_that_takes_all_the_time_leaves_the_others_their_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [0.0]
    text = "clock x; process P() { init location A { to A { guard x >= 1; } } } system P;"
    text += "property quick : A[] P.A; property slow : A[] x >= 0 && P.A;"
    usual = answers(text, Limits())
    assert [verdict.answer for verdict in usual] == [Answer.HOLDS] * 2
    real = reachability.explore

    def last_is_slow(program: Any, goals: Any, options: Any, limits: Limits) -> Outcome:
        found = real(program, goals, options, limits)
        if program.maximum_constants and current_job().about == ("slow",):
            now[0] += 1000
            return Outcome((GoalOutcome(Status.UNDECIDED),), Statistics(), TIME_LIMIT)
        return found

    monkeypatch.setattr(module, "monotonic", lambda: now[0])
    monkeypatch.setattr(reachability, "explore", last_is_slow)
    quick, slow = answers(text, Limits(seconds=100))
    assert (quick.answer, slow.answer, slow.reason) == (Answer.HOLDS, Answer.UNKNOWN, TIME_LIMIT)
