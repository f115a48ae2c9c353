"""``A<>[<= t] p`` and ``p -->[<= t] q``."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from fractions import Fraction
from random import Random

import pytest

from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.words import QueryKind
from tachk.engine.options import Limits, Options, SearchOrder
from tachk.engine.outcome import LivenessStatus, Obligation
from tachk.meaning.discrete import prepare
from tachk.meaning.step import StepError, delay, initial_state, satisfies, successors
from tachk.model.expressions import Expression, LocationTest
from tachk.model.query import Query, QueryDeadline
from tachk.verify.deadlines import with_deadline
from tachk.verify.verdict import Answer, Verdict
from tachk.verify.verify import verify
from tests.support import RandomCase, Shape, random_case
from tests.support.oracles.liveness_regions import check_by_regions
from tests.support.seeds import enough, seeds

SMALL = Shape(processes=2, locations=3, clocks=1, constant=3, deadlocks=False)

Verdicts = Callable[..., dict[str, Verdict]]
Answers = Callable[..., dict[str, str]]

LAMP = """
process P() {
    clock x;
    init location Off { invariant x <= 5; to On { guard x >= 2; assign x = 0; } }
    location On { invariant x < 4; to Off { assign x = 0; } }
}
system P;
"""


@pytest.mark.parametrize(
    ("query", "expected"),
    [
        ("A<>[<= 5] P.On", "holds"),
        ("A<>[< 5] P.On", "fails"),
        ("A<>[<= 4] P.On", "fails"),
        ("A<>[<= 0] P.Off", "holds"),
        ("A<>[<= 0] P.On", "fails"),
        ("A<>[<= 2 + 3] P.On && P.x == 0", "holds"),
        ("P.Off -->[<= 5] P.On", "holds"),
        ("P.Off -->[< 5] P.On", "fails"),
        ("P.On -->[< 4] P.Off", "holds"),
        ("P.On -->[<= 3] P.Off", "fails"),
        ("P.On -->[<= 0] P.On", "holds"),
    ],
)
def test_deadlines_are_exact(answers: Answers, query: str, expected: str) -> None:
    assert answers(LAMP + f"property q : {query};") == {"q": expected}


def test_what_is_there_for_no_time_counts(answers: Answers) -> None:
    text = """
    process P() {
        clock x;
        init location A { invariant x <= 1; to B { guard x >= 1; } }
        urgent location B { to C; }
        location C;
    }
    system P;
    property soon : A<>[<= 1] P.B;
    property at_once : P.A -->[<= 1] P.B;
    property sooner : P.A -->[< 1] P.B;
    """
    assert answers(text) == {"soon": "holds", "at_once": "holds", "sooner": "fails"}


@pytest.mark.parametrize(
    "stop",
    [
        "location Stuck { invariant x <= 1; }",  # stops time
        "location Stuck { invariant x <= 1; to Stuck; }",  # does infinitely much in finite time
        "urgent location Stuck;",
    ],
)
def test_a_run_that_never_gets_to_the_deadline_violates_it(answers: Answers, stop: str) -> None:
    text = f"""
    process P() {{
        clock x;
        init location A {{ invariant x <= 1; to B {{ guard x >= 1; }} to Stuck; }}
        location B; {stop}
    }}
    system P;
    property initially : A<>[<= 10] P.B;
    property later : P.A -->[<= 10] P.B;
    """
    assert answers(text) == {"initially": "fails", "later": "fails"}


def test_the_run_is_one_of_the_model_alone(verdicts: Verdicts) -> None:
    verdict = verdicts(LAMP + "property q : P.Off -->[<= 3] P.On;")["q"]
    assert verdict.answer is Answer.FAILS and verdict.trace is not None
    assert len(verdict.trace.initial.discrete.locations) == 1
    assert verdict.query.text == "P.Off -->[<= 3] P.On"


def test_clocks_are_rejected(verdicts: Verdicts) -> None:
    clock = verdicts(LAMP + "property q : P.x > 3 -->[<= 3] P.On;")["q"].unsupported
    assert clock is not None and clock.code == "E0720" and clock.span.text == "P.x"


def test_what_is_committed_is_met_and_awaited_at_once(answers: Answers) -> None:
    text = """
    process P() {
        clock x;
        init committed location A { to B; }
        location B { invariant x <= 3; to C { guard x >= 2; assign x = 0; } }
        committed location C { to D; to Lost; }
        location D { invariant x <= 1; to B { guard x >= 1; assign x = 0; } }
        location Lost;
    }
    process Q() { clock y; init location L { invariant y <= 1; to L { guard y >= 1; assign y = 0; } } }
    system P, Q;
    property from_start : P.A -->[<= 3] P.C;
    property sooner : P.A -->[< 3] P.C;
    property at_once : P.B -->[<= 3] P.C;
    property within : P.C -->[<= 0] P.D;
    property round : P.D -->[<= 4] P.C;
    """
    expected = {"from_start": "holds", "sooner": "fails", "at_once": "holds", "within": "fails", "round": "holds"}
    assert answers(text) == expected


def test_priorities_decide_how_soon(answers: Answers) -> None:
    text = """
    chan low, high; chan priority low < high;
    process P() { clock x; init location A { invariant x <= 4; to B { guard x >= 1; sync low!; } } location B; }
    process R() { clock x; init location M { invariant x <= 4; to N { guard x >= 2; sync high!; } } location N; }
    process Q() { init location L { to L { sync low?; } to L { sync high?; } } }
    system P, Q, R;
    property first : P.A -->[<= 4] P.B || R.N;
    property sooner : P.A -->[< 4] P.B || R.N;
    property too : R.M -->[<= 4] R.N;
    property low_later : P.A -->[< 4] P.B;
    """
    assert answers(text) == {"first": "holds", "sooner": "fails", "too": "holds", "low_later": "fails"}


@pytest.mark.parametrize("query", ["E[][<= 3] P.On", "E<>[<= 3] P.On", "A<>[<= P.x] P.On", "A<>[<= 0 - 1] P.On"])
def test_other_deadlines_are_mistakes(verdicts: Verdicts, query: str) -> None:
    with pytest.raises(InputError):
        verdicts(LAMP + f"property q : {query};")


def test_the_region_oracle_contradicts_no_answer() -> None:
    """The oracle looks for runs that avoid a goal in the network with the observer."""
    compared = violated = 0
    for seed in seeds(range(20)):
        random = Random(seed)
        case = random_case(random, SMALL)
        goal, trigger = LocationTest(0, random.randrange(2)), LocationTest(1, random.randrange(2))
        deadline = QueryDeadline(random.randrange(5), random.random() < 0.5)
        queries = [
            Query("a", QueryKind.EVENTUALLY, goal, deadline=deadline),
            Query("b", QueryKind.LEADS_TO, trigger, (goal,), deadline=deadline),
        ]
        found = verify(case.network, queries, limits=Limits(states=3000), trace=True)
        other = verify(case.network, queries, Options(order=SearchOrder.DFS), Limits(states=3000), trace=False)
        assert [v.answer for v in found] == [v.answer for v in other], f"seed {seed}"
        for query, verdict in zip(queries, found, strict=True):
            if verdict.answer is Answer.UNKNOWN:
                continue
            timed, plain = with_deadline(case.network, query)
            avoided = plain.avoided
            assert avoided is not None
            obligation = Obligation(avoided, plain.begins)
            outcome = check_by_regions(timed.network, obligation, Limits(states=800))
            if outcome.status is LivenessStatus.UNDECIDED:
                continue
            assert (outcome.status is LivenessStatus.FOUND) == (verdict.answer is Answer.FAILS), f"seed {seed}"
            compared += 1
            violated += verdict.answer is Answer.FAILS
    assert enough(compared > 10 and 0 < violated < compared)


def lateness(case: RandomCase, trigger: Expression, goal: Expression, random: Random) -> Fraction:
    """For how long at most the goal was seen to be missing on one random run, since the trigger."""
    model = prepare(case.network)
    state = initial_state(model)
    since: Fraction | None = None
    worst = Fraction(0)
    for _ in range(40):
        if satisfies(model, state, goal):
            since = None
        elif since is None and satisfies(model, state, trigger):
            since = state.time
        if since is not None:
            worst = max(worst, state.time - since)
        following = successors(model, state)
        if random.random() < 0.5 or not following:
            with suppress(StepError):
                state = delay(model, state, Fraction(random.choice([1, 2, 5]), random.choice([1, 2])))
        else:
            _, state = random.choice(following)
    return worst


def test_no_random_run_is_later_than_what_holds() -> None:
    held = 0
    for seed in seeds(range(30)):
        random = Random(seed)
        case = random_case(random, SMALL)
        goal, trigger = LocationTest(0, random.randrange(2)), LocationTest(1, random.randrange(2))
        bound = random.randrange(2, 6)
        query = Query("q", QueryKind.LEADS_TO, trigger, (goal,), deadline=QueryDeadline(bound))
        (verdict,) = verify(case.network, [query], limits=Limits(states=3000), trace=False)
        if verdict.answer is Answer.HOLDS:
            held += 1
            assert all(lateness(case, trigger, goal, random) <= bound for _ in range(8)), f"seed {seed}"
    assert enough(held > 3)
