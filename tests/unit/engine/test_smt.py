"""The second engine by example: what it finds, what it proves, and what it refuses."""

from __future__ import annotations

from collections.abc import Sequence
from random import Random

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UnsupportedError
from tachk.base.job import Job, under_way
from tachk.base.operators import COMPARISONS, BinaryOperator, OperandError, OperandGroup
from tachk.engine.exact.concretise import concretise
from tachk.engine.options import Limits
from tachk.engine.outcome import Outcome, Status
from tachk.engine.smt import proofs
from tachk.engine.smt.facts import known_zones
from tachk.engine.smt.search import explore
from tachk.engine.smt.terms import (
    compare,
    compute,
    constant,
    in_range,
    undefined,
    unknown,
)
from tachk.meaning.dbm import Zone
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import replay
from tachk.model.expressions import Expression
from tachk.model.fault import RuntimeErrorKind
from tachk.model.network import Network
from tachk.model.run import DiscreteState

z3 = pytest.importorskip("z3")


def outcome_of(text: str, limits: Limits = Limits()) -> Outcome:
    """What the engine says about the properties of a model; each path that it finds must have a run."""
    model = tachk.loads(text)
    targets = [query.target for query in model.properties if query.target is not None]
    outcome = explore(model.network, targets, limits)
    prepared = prepare(model.network)
    for goal, target in zip(outcome.goals, targets, strict=True):
        if goal.status is Status.REACHED:
            run = concretise(prepared, goal.path or (), target)
            assert run is not None
            replay(prepared, run, target)
    return outcome


def status_of(text: str) -> Status:
    return outcome_of(text).goals[0].status


RACE = """
process P() {{
    clock x;
    init location A {{ invariant x {upper} 3; to B {{ guard x {lower} 3; }} }}
    location B;
}}
system P;
property p : E<> P.B;
"""


@pytest.mark.parametrize(
    ("upper", "lower", "expected"),
    [
        ("<=", ">=", Status.REACHED),
        ("<", ">=", Status.UNREACHABLE),
        ("<=", ">", Status.UNREACHABLE),
        ("<", "<", Status.REACHED),
    ],
)
def test_strict_and_weak_bounds_differ(upper: str, lower: str, expected: Status) -> None:
    assert status_of(RACE.format(upper=upper, lower=lower)) is expected


def test_an_invariant_holds_at_both_ends_of_a_delay() -> None:
    entered = """
    process P() {
        clock x;
        init location A { to B; }
        location B { invariant x >= 2; to C { guard x >= 5; } }
        location C;
    }
    system P;
    property early : E<> P.B && P.x < 2;
    property at_once : E<> P.B && P.x == 2;
    """
    early, at_once = outcome_of(entered).goals
    assert (early.status, at_once.status) == (Status.UNREACHABLE, Status.REACHED)
    assert status_of(entered.replace("{ to B; }", "{ to B { guard x == 1; } }").replace("P.x < 2", "P.x > 2")) is (
        Status.UNREACHABLE
    )
    left = """
    process P() {
        clock x;
        init location A { invariant x <= 2; to B { guard x >= 1; assign x = 0; } }
        location B;
    }
    system P;
    property late : E<> P.A && P.x > 2;
    """
    assert status_of(left) is Status.UNREACHABLE


@pytest.mark.parametrize("kind", ["urgent", "committed"])
def test_no_time_passes_in_an_urgent_or_committed_location(kind: str) -> None:
    text = f"""
    process P() {{ clock x; init {kind} location A {{ to B; }} urgent location B; }}
    system P;
    property later : E<> P.x > 0;
    """
    assert status_of(text) is Status.UNREACHABLE


def test_a_committed_location_is_left_first() -> None:
    text = """
    process P() { init committed location A { to B; } location B; }
    process Q() { init location A { to B; } location B; }
    system P, Q;
    property first : E<> P.A && Q.B;
    """
    assert status_of(text) is Status.UNREACHABLE


def test_a_handshake_waits_for_a_committed_process() -> None:
    text = """
    chan c;
    process P() { init committed location A { to B; } location B; }
    process Q() { init location A { to B { sync c!; } } location B; }
    process R() { init location A { to B { sync c?; } } location B; }
    system P, Q, R;
    property first : E<> P.A && Q.B;
    property then_ : E<> P.B && Q.B && R.B;
    """
    assert [goal.status for goal in outcome_of(text).goals] == [Status.UNREACHABLE, Status.REACHED]


def test_a_broadcast_waits_for_a_committed_process_unless_it_takes_part() -> None:
    text = """
    broadcast chan all;
    process P() { init committed location A { to B; } location B; }
    process Q() { init location A { to B { sync all!; } } location B; }
    system P, Q;
    property first : E<> P.A && Q.B;
    """
    assert status_of(text) is Status.UNREACHABLE
    assert status_of(text.replace("{ to B; }", "{ to A { sync all?; } }")) is Status.REACHED


def test_an_urgent_channel_stops_time_only_with_a_partner() -> None:
    text = """
    urgent chan now;
    int[0, 1] ready = READY;
    process P() { clock x; init location A { to B { sync now!; } } urgent location B; }
    process Q() { init location A { to B { guard ready == 1; sync now?; } } location B; }
    system P, Q;
    property waits : E<> P.x > 0;
    """
    assert status_of(text.replace("READY", "1")) is Status.UNREACHABLE
    assert status_of(text.replace("READY", "0")) is Status.REACHED


def test_a_process_that_can_receive_a_broadcast_takes_part() -> None:
    text = """
    broadcast chan all;
    process P() { init location A { to B { sync all!; } } location B; }
    process Q() { clock x; init location A { to B { guard x >= 2; sync all?; } } location B; }
    system P, Q;
    property deaf : E<> P.B && Q.A && Q.x < 2;
    property missed : E<> P.B && Q.A && Q.x == 2;
    """
    deaf, missed = outcome_of(text).goals
    assert deaf.status is Status.REACHED
    assert missed.status is Status.REACHED  # sent before 2, looked at then
    never = text.replace(
        "init location A { to B { sync all!; } }", "init location A { to B { guard x >= 2; sync all!; } }"
    )
    never = never.replace("process P() {", "process P() { clock x;")
    assert outcome_of(never).goals[0].status is Status.UNREACHABLE
    assert outcome_of(never).goals[1].status is Status.UNREACHABLE


def test_a_receiver_that_chooses_its_channel_is_called_behind_one_that_nobody_calls() -> None:
    text = """
    bool second = true;
    chan lonely, both[2];
    process Deaf() { init location A { to B { sync lonely?; } } location B; }
    process Sender() { init location A { to B { sync both[1]!; } } location B; }
    process Receiver() { init location A { to B { sync both[second ? 1 : 0]?; } } location B; }
    system Deaf, Sender, Receiver;
    property p : E<> Receiver.B;
    """
    assert status_of(text) is Status.REACHED


def test_stopped_clocks_are_exact() -> None:
    text = """
    process P() {
        clock x, y;
        init location A { invariant x <= 2; to B { guard x >= 2; } }
        location B { invariant y <= 5 && x' == 0; to C { guard y >= 5; } }
        location C;
    }
    system P;
    property kept : E<> P.C && P.y == 5 && P.x == 2;
    property ran : E<> P.C && P.y == 5 && P.x > 2;
    """
    assert [goal.status for goal in outcome_of(text).goals] == [Status.REACHED, Status.UNREACHABLE]


def test_a_run_time_error_ends_the_search_with_the_path_to_it() -> None:
    text = """
    int[0, 2] n;
    process P() { init location A { to A { assign n++; } } }
    system P;
    property p : A[] n <= 2;
    """
    outcome = outcome_of(text)
    assert outcome.reason == "run-time error"
    assert outcome.goals[0].status is Status.UNDECIDED
    assert outcome.fault is not None
    assert outcome.fault.kind is RuntimeErrorKind.RANGE
    assert len(outcome.fault.path) == 2


def test_a_proof_shows_that_no_guard_goes_wrong() -> None:
    text = """
    int[0, 1] a[5];
    int[0, 9] n;
    process P() { init location A { to A { guard a[n] == 0 && n < 9; assign n++; } } location B; }
    system P;
    property never : E<> P.B;
    """
    outcome = outcome_of(text)
    assert (outcome.goals[0].status, outcome.reason) == (Status.UNDECIDED, "run-time error")
    assert outcome.fault is not None
    assert (outcome.fault.kind, len(outcome.fault.path)) == (RuntimeErrorKind.INDEX, 5)


def test_zones_that_a_step_leads_out_of_prove_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    text = """
    int[0, 9] n;
    process P() { init location A { to A { guard n < 9; assign n++; } } }
    system P;
    property far : E<> n == 8;
    """

    def only_the_first(network: Network, goals: Sequence[Expression]) -> dict[DiscreteState, list[Zone]]:
        return dict(list(known_zones(network, goals).items())[:3])

    monkeypatch.setattr(proofs, "known_zones", only_the_first)
    assert status_of(text) is Status.REACHED


def test_loops_and_early_returns_are_executed_for_all_states_at_once() -> None:
    text = """
    int[0, 7] bits[4];
    int[0, 4] found;
    int[0, 4] first() {
        for (i : int[0, 3]) if (bits[i] == 5) return i;
        return 4;
    }
    void fill(int[0, 3] upto) { int i = 0; while (i < upto) { bits[i] = i + 4; i++; } }
    process P() {
        init location A { to B { select k : int[0, 3]; assign fill(k), found = first(); } }
        location B;
    }
    system P;
    property some : E<> P.B && found == 1;
    property none : E<> P.B && found == 4;
    property never : E<> P.B && (found == 0 || found == 2 || found == 3);
    """
    statuses = [goal.status for goal in outcome_of(text).goals]
    assert statuses == [Status.REACHED, Status.REACHED, Status.UNREACHABLE]


@pytest.mark.parametrize(
    "text",
    [
        """
        bool low(int k) { double d = k; return d / 2 < 1.5; }
        int n; process P() { init location A { to A { guard low(n); assign n++; } } } system P; property p : E<> n == 1;
        """,
        """
        int n;
        process P() { init location A { to A { assign n = 0; } to B { guard 2 ** n == 4; } } location B; }
        system P;
        property p : E<> P.B;
        """,
    ],
)
def test_what_is_not_encoded_is_rejected_by_name(text: str) -> None:
    with pytest.raises(UnsupportedError) as caught:
        outcome_of(text)
    assert caught.value.diagnostic.code == "E0745"


def test_a_bound_on_depth_never_proves_anything() -> None:
    text = """
    int[0, 30000] n;
    process P() { init location A { to A { guard n < 30000; assign n++; } } }
    system P;
    property far : E<> n == 20000;
    """
    outcome = outcome_of(text, Limits(depth=2))
    assert (outcome.goals[0].status, outcome.reason) == (Status.UNDECIDED, "depth limit")


def test_no_time_is_no_answer() -> None:
    model = tachk.loads(RACE.format(upper="<=", lower=">="))
    with under_way(Job(ends=0.0)):
        outcome = explore(model.network, [model.properties[0].target])  # type: ignore[list-item]
    assert (outcome.goals[0].status, outcome.reason) == (Status.UNDECIDED, "time limit")


def test_operators_mean_what_the_table_says() -> None:
    random = Random(1)
    operators = [o for o in BinaryOperator if o.group is OperandGroup.ARITHMETIC and o is not BinaryOperator.POWER]
    solver = z3.Solver()
    for turn in range(120):
        low = random.choice((-9, 0, -40000))
        high = low + random.choice((3, 17, 70000))
        left, right = (unknown(f"{side}{turn}", low, high) for side in "ab")
        a, b = random.randint(low, high), random.randint(low, high)
        given = [left.is_value(a), right.is_value(b), in_range(left), in_range(right)]
        for operator in operators:
            fails = undefined(operator, right)
            try:
                expected = operator.compute(a, b)
            except OperandError:
                assert fails is True or solver.check(*given, fails) == z3.sat
                continue
            assert fails is False or solver.check(*given, fails) == z3.unsat
            result = compute(operator, left, right)
            assert result.low <= expected <= result.high, (operator, a, b)
            wrong = result.is_value(expected)
            assert wrong is True or solver.check(*given, z3.Not(wrong)) == z3.unsat, (operator, a, b)
        for operator in COMPARISONS:
            truth = compare(operator, left, right)
            if not isinstance(truth, bool):
                assert solver.check(*given, truth if operator.holds(a, b) else z3.Not(truth)) == z3.sat
                assert solver.check(*given, z3.Not(truth) if operator.holds(a, b) else truth) == z3.unsat
    assert compute(BinaryOperator.POWER, constant(3), constant(4)).low == 81
