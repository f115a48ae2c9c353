"""The time between two events, over all runs."""

from __future__ import annotations

from fractions import Fraction
from random import Random

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.meaning.discrete import prepare
from tachk.meaning.step import StepError, delay, initial_state, satisfies, successors
from tachk.model.event import BecomesTrue
from tachk.model.expressions import BOOL, Constant, Expression, LocationTest
from tachk.model.network import Network
from tachk.verify.times import Times, times_between
from tachk.verify.verdict import Extreme
from tests.support import Shape, random_case
from tests.support.seeds import enough, seeds

DOOR = """
chan ring; broadcast chan bell[2];
int[0,1] n;
process Visitor() {
    clock x;
    init location Away { to Waiting { guard x >= 3; sync bell[n]!; assign x = 0, n = 1 - n; } }
    location Waiting { invariant x <= 6; to Inside { guard x > 2; sync ring!; assign x = 0; } }
    location Inside { invariant x < 4; to Away { assign x = 0; } }
}
process Porter() { init location Idle { to Idle { sync ring?; } } }
V = Visitor();
P = Porter();
system V, P;
signal inside = V.Inside;
"""


def said(extreme: Extreme | None) -> tuple[int | None, bool] | None:
    return None if extreme is None else (extreme.value, extreme.strict)


def measured(times: Times) -> list[tuple[int | None, bool] | None]:
    assert times.reason == ""
    return [said(times.best), said(times.worst), said(times.waiting)]


@pytest.mark.parametrize(
    ("start", "end", "expected"),
    [
        ("V.Waiting", "inside", [(2, True), (6, False), (6, False)]),
        ("bell!", "ring!", [(2, True), (6, False), (6, False)]),
        ("bell[0]!", "ring?", [(2, True), (6, False), (6, False)]),
        ("bell[0]", "bell[0]", [(10, True), (None, False), (None, False)]),
        ("inside", "V.Away", [(0, False), (4, True), (4, True)]),
        (None, "V.Waiting", [(3, False), (None, False), (None, False)]),
        (None, "V.Away", [(0, False), (0, False), None]),
        ("V.Waiting", "n == 7", [None, None, (None, False)]),
        ("n == 7", "V.Away", [None, None, None]),
    ],
)
def test_events_are_conditions_channels_and_signals(
    start: str | None, end: str, expected: list[tuple[int | None, bool] | None]
) -> None:
    assert measured(tachk.loads(DOOR).time(start, end, trace=False)) == expected


def test_a_run_takes_the_time_and_is_one_of_the_model_alone() -> None:
    model = tachk.loads(DOOR)
    times = model.time("V.Waiting", "inside")
    assert times.worst is not None and times.worst.run is not None
    run = times.worst.run
    assert len(run.initial.discrete.locations) == 2
    assert run.steps[-1].delay == 6
    assert times.best is not None and times.best.run is None  # it is approached and not taken


REPEATED = """
process P() {
    clock x; int[0,3] n;
    init location A { invariant x <= 2; to B { guard x >= 2; assign n = n + 1, x = 0; } }
    location B { invariant x <= 2; to A { guard x >= 2 && n < 3; assign x = 0; } to C { guard x >= 2 && n == 3; } }
    location C;
}
system P;
"""


def test_from_the_first_or_the_last_occurrence() -> None:
    model = tachk.loads(REPEATED)
    assert measured(model.time("P.B", "P.C"))[:2] == [(10, False), (10, False)]
    assert measured(model.time("P.B", "P.C", last=True))[:2] == [(2, False), (2, False)]


def test_only_what_is_requested_is_measured() -> None:
    model = tachk.loads(DOOR)
    assert measured(model.time("V.Waiting", "inside", best=False)) == [None, (6, False), (6, False)]
    assert measured(model.time("V.Waiting", "inside", worst=False)) == [(2, True), None, None]


def test_no_deadline_and_growth_are_distinguished() -> None:
    text = """
    process P() {
        clock x;
        init location A { invariant x <= 5; to B { guard x >= 1; } to Stuck { guard x <= 3; } }
        location B; location Stuck;
    }
    system P;
    """
    delayed = tachk.loads(text).time(None, "P.B")
    assert measured(delayed) == [(1, False), (5, False), (None, False)]
    assert delayed.may_wait_for_ever
    growing = tachk.loads(text.replace("invariant x <= 5;", "")).time(None, "P.B")
    assert measured(growing) == [(1, False), (None, False), (None, False)]


def test_a_condition_counts_in_a_chain_of_committed_locations_unless_only_settled_states_count() -> None:
    text = """
    process P() {
        clock x;
        init location A { invariant x <= 1; to B { guard x >= 1; } }
        committed location B { to C; }
        committed location C { to D { assign x = 0; } }
        location D { invariant x <= 3; to E { guard x >= 3; } }
        location E;
    }
    system P;
    """
    model = tachk.loads(text)
    assert measured(model.time("P.D", "P.E")) == [(3, False), (3, False), (3, False)]
    assert measured(model.time("P.B", "P.E")) == [(3, False), (3, False), (3, False)]
    assert measured(model.time("P.A", "P.C")) == [(1, False), (1, False), (1, False)]
    assert measured(model.time("P.B", "P.C")) == [(0, False), (0, False), None]
    assert measured(model.time("P.D", "P.E", settled=True)) == [(3, False), (3, False), (3, False)]
    assert measured(model.time("P.B", "P.E", settled=True)) == [None, None, None]


def test_an_event_in_a_committed_location_without_an_exit_has_come() -> None:
    text = """
    process P() {
        clock x;
        init location A { invariant x <= 3; to B { guard x >= 1; } }
        committed location B;
    }
    system P;
    """
    model = tachk.loads(text)
    assert measured(model.time("P.A", "P.B")) == [(1, False), (3, False), (3, False)]
    assert measured(model.time("P.A", "P.B", settled=True)) == [None, None, (3, False)]


LEFT_IN_A_CHAIN = """
chan appr, stop;
process Train() {
    clock x;
    init location Safe { to Appr { sync appr!; assign x = 0; } }
    location Appr { invariant x <= 20; to Cross { guard x >= 10; } to Stop { sync stop?; } }
    location Stop { invariant x <= 120; to Cross { guard x >= 120; } }
    location Cross;
}
process Gate() {
    init location Free { to Tell { sync appr?; } }
    committed location Tell { to Occ; to Occ { sync stop!; } }
    location Occ;
}
system Train, Gate;
"""


def test_a_location_that_is_left_in_a_chain_has_been_entered() -> None:
    model = tachk.loads(LEFT_IN_A_CHAIN)
    of_location = measured(model.time("Train.Appr", "Train.Cross"))
    assert of_location == measured(model.time("appr!", "Train.Cross")) == [(10, False), (120, False), (120, False)]
    assert measured(model.time("Train.Appr", "Train.Cross", settled=True)) == [(10, False), (20, False), (20, False)]


def test_a_committed_receiver_may_still_be_served() -> None:
    text = """
    chan c;
    process R() { init location A { to B; } committed location B { to Done { sync c?; } } location Done; }
    process S() { clock x; init location L { to L { sync c!; } } }
    system R, S;
    """
    assert measured(tachk.loads(text).time(None, "R.Done"))[0] == (0, False)
    assert measured(tachk.loads(text).time(None, "R.Done || R.B"))[0] == (0, False)


def test_times_in_a_model_with_priorities() -> None:
    text = """
    chan low, high; chan priority low < high;
    process P() { clock x; init location A { invariant x <= 4; to B { guard x >= 2; sync low!; } } location B; }
    process Q() { init location L { to L { sync low?; } to L { sync high?; } } }
    process R() { clock y; init location M { invariant y <= 3; to N { guard y >= 3; sync high!; } } location N; }
    system P, Q, R;
    """
    assert measured(tachk.loads(text).time(None, "P.B")) == [(2, False), (4, False), (4, False)]


def test_a_limit_leaves_times_unknown() -> None:
    times = tachk.loads(DOOR).time("V.Waiting", "inside", limits=tachk.Limits(states=1))
    assert times.reason == "state limit"


@pytest.mark.parametrize(
    ("event", "code"), [("V.x > 3", "E0731"), ("deadlock", "E0501"), ("nothing", "E0201"), ("n!", "E0301"), ("n +", "")]
)
def test_what_is_no_event_is_rejected(event: str, code: str) -> None:
    with pytest.raises(InputError) as caught:
        tachk.loads(DOOR).time(None, event)
    assert caught.value.diagnostics[0].code.startswith(code or "E01")


def test_a_channel_that_an_edge_computes_is_rejected() -> None:
    text = """
    broadcast chan a, b; int[0,1] n;
    process P() { init location A { to A { sync (n == 0 ? a : b)!; } } }
    system P;
    """
    with pytest.raises(UsageError, match="computes"):
        tachk.loads(text).time(None, "a!")


def times_on_random_runs(
    network: Network, start: Expression, end: Expression, settled: bool, random: Random
) -> list[Fraction]:
    """What one random run says, read off by hand: from a state in which the first condition has become true to the next
    in which the second one has; with ``settled`` states with a committed location are left out."""
    model = prepare(network)
    state = initial_state(model)
    was = [False, False]
    since: Fraction | None = None
    found: list[Fraction] = []
    for _ in range(40):
        if not (settled and any(location.committed for location in model.current(state.discrete))):
            now = [satisfies(model, state, start), satisfies(model, state, end)]
            begins, ends = (new and not old for new, old in zip(now, was, strict=True))
            if since is None and begins:
                since = state.time
                if ends:
                    found.append(Fraction(0))
                    since = None
            elif since is not None and ends:
                found.append(state.time - since)
                since = state.time if begins else None
            was = now
        try:
            state = delay(model, state, Fraction(random.choice([0, 0, 1, 2, 5]), random.choice([1, 2])))
        except StepError:
            continue
        following = successors(model, state)
        if not following:
            break
        _, state = random.choice(following)
    return found


@pytest.mark.parametrize("settled", [False, True])
def test_no_random_run_takes_less_than_the_least_or_more_than_the_largest_time(settled: bool) -> None:
    shape = Shape(deadlocks=False, clocks=1, processes=2, locations=3, constant=3)
    seen = 0
    for seed in seeds(range(12)):
        random = Random(seed)
        case = random_case(random, shape)
        conditions = [LocationTest(process, random.randrange(2)) for process in (0, 1)]
        events = [BecomesTrue(condition, settled) for condition in conditions]
        times = times_between(case.network, *events, limits=tachk.Limits(states=300), trace=False)
        if times.reason:
            continue
        for _ in range(10):
            for time in times_on_random_runs(case.network, *conditions, settled, random):
                seen += 1
                assert times.best is not None and times.worst is not None, f"seed {seed}"
                best, worst = times.best, times.worst
                assert best.value is not None and (best.value < time if best.strict else best.value <= time)
                assert worst.value is None or (time < worst.value if worst.strict else time <= worst.value)
    assert enough(seen > 5)


def test_what_happens_behind_the_second_event_is_not_explored_where_the_first_one_is_the_start() -> None:
    """An event that is true at once and ever after begins at the same moment, but tachk cannot know that."""
    always = BecomesTrue(Constant(1, BOOL))
    fewer = compared = 0
    for seed in seeds(range(25)):
        random = Random(seed)
        case = random_case(random, Shape(deadlocks=False, clocks=2, processes=2, locations=3, constant=3))
        end = BecomesTrue(LocationTest(0, random.randrange(1, 3)))
        once = times_between(case.network, None, end, limits=tachk.Limits(states=2000))
        again = times_between(case.network, always, end, limits=tachk.Limits(states=2000))
        if again.reason:
            continue
        compared += 1
        assert measured(once) == measured(again), f"seed {seed}"
        fewer += once.states < again.states
    assert enough(compared > 15 and fewer > 5)
