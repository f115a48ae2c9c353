"""Temporal properties of models: verdicts, runs without the observer, what is refused."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from itertools import starmap

import pytest

from tachk.base.span import Source
from tachk.engine.options import Options
from tachk.formats.loading.load import load_model
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import replay
from tachk.transform.observed import ObserverMove
from tachk.verify.plan import Task, plan
from tachk.verify.verdict import Answer, Verdict
from tachk.verify.verify import verify

DOOR = """
clock global;
process Door() {
    clock x;
    bool locked = false;
    init location Closed {
        invariant x <= 4;
        to Open { guard x >= 3; assign x = 0; }
    }
    location Open {
        invariant x <= 6;
        to Closed { guard x >= 1; assign x = 0; }
    }
}
system Door;
"""

Verdicts = Callable[..., dict[str, Verdict]]


@pytest.mark.parametrize(
    ("formula", "answer"),
    [
        ("G(Door.Closed -> F[0,4] Door.Open)", Answer.HOLDS),
        ("G(Door.Closed -> F[0,4) Door.Open)", Answer.FAILS),
        ("G(Door.Closed -> F[0,3] Door.Open)", Answer.FAILS),
        ("G(rise(Door.Open) -> G[0,1) Door.Open)", Answer.HOLDS),
        ("G(rise(Door.Open) -> G[0,1] Door.Open)", Answer.FAILS),
        ("G(rise(Door.Open) -> F(0,6] !Door.Open)", Answer.HOLDS),
        ("G F[0,4] Door.Open", Answer.HOLDS),
        ("F[0,4] Door.Open", Answer.HOLDS),
        ("F[0,3] Door.Open", Answer.FAILS),
        ("G(Door.Open -> O[0,6] Door.Closed)", Answer.HOLDS),
        ("G(Door.Open -> O[0,5] Door.Closed)", Answer.FAILS),
        ("!Door.Open W Door.Closed", Answer.HOLDS),
        ("G[0,3) Door.Closed", Answer.HOLDS),
        ("G[0,3] Door.Closed", Answer.FAILS),
        ("whenever Door.Closed becomes true, within 4, Door.Open must be true.", Answer.HOLDS),
    ],
)
def test_temporal_properties_of_a_door(verdicts: Verdicts, formula: str, answer: Answer) -> None:
    assert verdicts(f"{DOOR} property p : {formula};")["p"].answer is answer


def test_values_that_last_for_no_time_do_not_count(verdicts: Verdicts) -> None:
    model = """
    bool p, q;
    process P() {
        clock x;
        init location A { invariant x <= 1; to B { guard x >= 1; assign p = true; } }
        committed location B { to C { assign q = true; } }
        location C { invariant x <= 2; to D { guard x >= 2; assign q = false; } }
        urgent location D { to E { assign p = false; } }
        location E;
    }
    system P;
    property together : G(p -> q);
    property seen : A[] p imply q;
    property never : G !P.D;
    """
    found = verdicts(model)
    assert found["together"].answer is Answer.HOLDS
    assert found["seen"].answer is Answer.FAILS
    assert found["never"].answer is Answer.HOLDS


def test_a_run_is_that_of_the_model_alone_and_the_moves_of_the_observer_stand_beside_it(verdicts: Verdicts) -> None:
    model = load_model(Source("door.ta", f"{DOOR} property p : G(rise(Door.Open) -> F[0,5] Door.Closed);"))
    (verdict,) = verify(model.network, model.queries)
    assert verdict.trace is not None
    replay(prepare(model.network), verdict.trace)
    assert [step.delay for step in verdict.trace.steps] == [Fraction(3), Fraction(11, 2)]
    assert verdict.moves == (ObserverMove(Fraction(3), "Triggered"), ObserverMove(Fraction(17, 2), "Bad"))


def test_each_temporal_property_is_searched_with_its_own_observer_only() -> None:
    text = f"{DOOR} property a : A[] !Door.locked; property b : G !Door.Open; property c : G !Door.Open;"
    searches = plan(starmap(Task, enumerate(load_model(Source("door.ta", text)).queries)))
    assert [[task.query.name for task in search.tasks] for search in searches] == [["a"], ["b"], ["c"]]
    assert [search.observer is None for search in searches] == [True, False, False]


def test_an_observer_costs_deadlock_nothing(verdicts: Verdicts) -> None:
    model = "process P() { init location A; } system P; property d : A[] !deadlock; property t : G P.A;"
    found = verdicts(model)
    assert found["d"].answer is Answer.FAILS
    assert found["t"].answer is Answer.HOLDS


def test_priorities_reject_temporal_properties_only(verdicts: Verdicts) -> None:
    model = """
    chan a, b;
    chan priority a < default < b;
    process P() { init location A; }
    system P;
    property t : G P.A;
    property q : A[] P.A;
    """
    found = verdicts(model)
    assert found["t"].unsupported is not None and found["t"].unsupported.code == "E0732"
    assert found["q"].answer is Answer.HOLDS


@pytest.mark.parametrize(
    ("formula", "code", "place"),
    [
        ("G (rise(H[0, 3] Door.Open) -> Door.Open)", "E0730", "H[0, 3] Door.Open"),
        ("G(Door.x > 2 -> Door.Open)", "E0731", "Door.x"),
        ("G(global > 2 -> Door.Open)", "E0731", "global"),
    ],
)
def test_what_cannot_be_checked_is_listed_with_its_place(formula: str, code: str, place: str) -> None:
    model = load_model(Source("door.ta", f"{DOOR} property p : {formula};"))
    assert model.queries == ()
    (found,) = model.unchecked[0].diagnostics
    assert (found.code, found.span.text) == (code, place)


def test_a_run_time_error_in_a_condition_is_reported_without_the_observer(verdicts: Verdicts) -> None:
    model = """
    int n = 0;
    int a[2] = { 0, 0 };
    process P() { clock x; init location A { to A { guard x >= 1 && n < 2; assign n = n + 1, x = 0; } } }
    system P;
    property p : G(a[n] == 0);
    """
    verdict = verdicts(model)["p"]
    assert verdict.answer is Answer.UNKNOWN
    assert verdict.fault is not None and verdict.fault.run is not None
    assert {p.process for step in verdict.fault.path for p in step.participants} == {0}
    assert verdict.fault.transition is not None
    assert {p.process for p in verdict.fault.transition.participants} == {0}


def test_change_compares_values_of_any_size(verdicts: Verdicts) -> None:
    model = """
    int[0, 100000] n = 70000;
    process P() {
        clock x;
        init location A { invariant x <= 2; to B { guard x >= 2; assign n = n + 1, x = 0; } }
        location B { invariant x <= 2; to C { guard x >= 2; assign n = n, x = 0; } }
        location C;
    }
    system P;
    property a : G(change(n) -> P.B);
    property b : G(change(n) -> P.C);
    """
    found = verdicts(model, options=Options())
    assert (found["a"].answer, found["b"].answer) == (Answer.HOLDS, Answer.FAILS)


@pytest.mark.parametrize(
    "never", ["false", "fall(false)", "fall(true)", "rise(false)", "rise(P.A && !P.A)", "P.A && fall(P.A && !P.A)"]
)
def test_what_no_run_can_satisfy_is_violated_also_where_time_stops(verdicts: Verdicts, never: str) -> None:
    model = f"""
    process P() {{ clock x; init location A {{ invariant x <= 5; }} }}
    system P;
    property within : F[0,12) ({never});
    property met : F[0,12) ({never} || P.A);
    """
    found = verdicts(model, options=Options())
    assert (found["within"].answer, found["met"].answer) == (Answer.FAILS, Answer.HOLDS)
