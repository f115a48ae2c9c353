"""The fastest run of all, and the slowest along a path."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from random import Random

import pytest

from tachk.base.words import QueryKind
from tachk.engine.options import Engine, Limits, Options, Pace
from tachk.engine.outcome import Status
from tachk.model.query import Query
from tachk.verify.time_optimal import _in_time
from tachk.verify.verdict import Verdict
from tachk.verify.verify import verify
from tests.support import Shape, random_case
from tests.support.oracles import reference
from tests.support.seeds import enough, seeds

Verdicts = Callable[..., dict[str, Verdict]]

FASTEST, SLOWEST = Options(pace=Pace.FASTEST), Options(pace=Pace.SLOWEST)

ROUTES = """
process Courier() {
    clock x;
    init location Home { to Across { guard x >= 60; assign x = 0; } to First { assign x = 0; } }
    location First { invariant x <= 30; to Second { guard x LEAVES 10; assign x = 0; } }
    location Second { invariant x <= 30; to Across { guard x >= 10; assign x = 0; } }
    location Across;
}
system Courier;
property arrives : E<> Courier.Across;
"""


def end_of(verdict: Verdict) -> Fraction:
    assert verdict.trace is not None
    return verdict.trace.states[-1].time


@pytest.mark.parametrize("engine", [Engine.ZONE, Engine.SMT])
def test_the_fastest_run_may_have_more_steps_than_the_shortest(verdicts: Verdicts, engine: Engine) -> None:
    text = ROUTES.replace("LEAVES", ">=")
    shortest = verdicts(text, options=Options(shortest=True, engine=engine))["arrives"]
    fastest = verdicts(text, options=Options(pace=Pace.FASTEST, engine=engine))["arrives"]
    assert (end_of(shortest), len(shortest.path)) == (60, 1)
    assert (end_of(fastest), len(fastest.path)) == (20, 3)
    assert fastest.notes == ("no run takes less than 20",)


def test_a_least_time_that_no_run_takes_is_reported(verdicts: Verdicts) -> None:
    found = verdicts(ROUTES.replace("LEAVES", ">"), options=FASTEST)["arrives"]
    assert 20 < end_of(found) < 21
    assert found.notes == ("runs take as little more than 20 as one likes, and none takes 20",)


def test_bisection_finds_a_time_that_is_only_approached(verdicts: Verdicts) -> None:
    edges = " ".join(f"to B {{ guard x >= {least}; }}" for least in range(20, 5, -1))
    text = f"""
    process P() {{ clock x; init location A {{ {edges} to B {{ guard x > 5; }} }} location B; }}
    system P;
    property end : E<> P.B;
    """
    assert "as little more than 5" in verdicts(text, options=FASTEST)["end"].notes[0]


def test_the_slowest_run_keeps_to_its_path(verdicts: Verdicts) -> None:
    text = """
    process P() {
        clock x;
        init location A { invariant x <= 5; to B { guard x >= 1; assign x = 0; } }
        location B { invariant x UPPER 7; to C; }
        location C;
    }
    system P;
    property end : E<> P.C;
    """
    found = verdicts(text.replace("UPPER", "<="), options=SLOWEST)["end"]
    assert end_of(found) == 12
    assert found.notes == ("along this path the last step is at 12 at the latest",)
    strict = verdicts(text.replace("UPPER", "<"), options=SLOWEST)["end"]
    assert Fraction(23, 2) <= end_of(strict) < 12
    assert "as close to 12 as one likes" in strict.notes[0]
    endless = verdicts(ROUTES.replace("LEAVES", ">="), options=SLOWEST)["arrives"]
    assert "as late as one likes" in endless.notes[0]


def test_the_wait_behind_the_last_step_counts(verdicts: Verdicts) -> None:
    text = """
    process P() { clock x; init location A { to B { guard x >= 2; assign x = 0; } } location B; }
    system P;
    property old : E<> P.B && P.x >= 3;
    property dead : E<> deadlock && P.x >= 1;
    property prompt : G (rise(P.B) -> F[0, 4] P.A);
    """
    found = verdicts(text, options=FASTEST)
    assert end_of(found["old"]) == 5
    assert end_of(found["dead"]) == 3
    assert "as little more than 6" in found["prompt"].notes[0]


def test_a_limit_leaves_the_run_that_was_found(verdicts: Verdicts) -> None:
    found = verdicts(ROUTES.replace("LEAVES", ">="), options=FASTEST, limits=Limits(depth=1))["arrives"]
    assert end_of(found) == 60
    assert found.notes == ("a faster run may exist: depth limit",)


def test_no_run_is_faster_than_the_fastest() -> None:
    """On random networks, by the reference engine."""
    compared = 0
    for seed in seeds(range(25)):
        case = random_case(Random(seed), Shape(clocks=2, constant=3, deadlocks=False, processes=2))
        queries = [Query(f"q{n}", QueryKind.POSSIBLY, predicate) for n, predicate in enumerate(case.predicates)]
        for query, verdict in zip(queries, verify(case.network, queries, FASTEST), strict=True):
            if verdict.trace is None or not end_of(verdict):
                continue
            assert query.predicate is not None
            end, attained = end_of(verdict), "no run takes less" in verdict.notes[0]
            total = int(end)  # of a run that is close to a limit, the limit
            assert attained is (end == total), seed
            for strict, expected in ((True, Status.UNREACHABLE), (False, Status.REACHED if attained else None)):
                if strict and total == 0:
                    continue
                timed, in_time = _in_time(case.network, query.predicate, total, strict)
                found = reference.explore(timed.network, [in_time], Limits(states=2000)).goals[0].status
                assert found in (expected or Status.UNREACHABLE, Status.UNDECIDED), seed
            compared += 1
    assert enough(compared >= 5)
