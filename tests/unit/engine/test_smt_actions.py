"""Priorities and deadlock in the second engine, and the formulas without moments that they need."""

from __future__ import annotations

from random import Random

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UnsupportedError
from tachk.engine.options import Engine, Options
from tachk.engine.outcome import Status
from tachk.engine.smt import actions
from tachk.model.fault import RuntimeErrorKind
from tachk.verify.verdict import Answer

z3 = pytest.importorskip("z3")
from tachk.engine.smt.actions import sometimes  # noqa: E402
from tachk.engine.smt.relation import relation  # noqa: E402
from tachk.engine.smt.search import explore  # noqa: E402
from tests.support.seeds import seeds  # noqa: E402

pytestmark = pytest.mark.drawn

BOTH = Options(engine=Engine.BOTH)


def answers(text: str) -> list[str]:
    """What both engines say; a contradiction is an exception, and one that has no answer leaves a note."""
    found = tachk.loads(text).verify(options=BOTH)
    assert [verdict.notes for verdict in found] == [()] * len(found)
    return [verdict.answer.value for verdict in found]


def random_formula(random: Random, moment: z3.ArithRef, terms: list[z3.ArithRef], depth: int) -> z3.BoolRef:
    if depth > 0:
        one, other = (random_formula(random, moment, terms, depth - 1) for _ in range(2))
        return random.choice([z3.And(one, other), z3.Or(one, other), z3.Not(one), z3.If(one, other, z3.Not(other))])
    now = random.choice([moment, moment, z3.If(z3.Bool(f"stopped{random.randint(0, 1)}"), z3.RealVal(1), moment)])
    left, right = now - random.choice(terms), z3.RealVal(random.randint(-2, 2))
    match random.choice(["<", "<=", ">", ">=", "==", "!="]):
        case "<":
            return left < right
        case "<=":
            return left <= right
        case ">":
            return left > right
        case ">=":
            return left >= right
        case "==":
            return left == right
        case _:
            return left != right


@pytest.mark.parametrize("seed", seeds(range(30)))
def test_a_formula_without_the_moment_says_that_there_is_one(seed: int) -> None:
    random = Random(seed)
    moment, first = z3.Real("moment"), z3.Real("first")
    terms = [z3.Real("a"), z3.Real("b"), z3.RealVal(1), first]
    formula = random_formula(random, moment, terms, 3)
    without = sometimes(formula, moment, first)
    solver = z3.Solver()
    solver.add(z3.Exists([moment], z3.And(formula, moment >= first)) != without)
    assert solver.check() == z3.unsat
    assert isinstance(without, bool) or "moment" not in without.sexpr()


def test_deadlock_is_now_and_ever_after() -> None:
    text = """
    process P() {{ clock x;
        init location A {{ invariant x {invariant}; to B {{ guard x {guard}; }} }}
        location B {{ to B; }} }}
    system P;
    property never : A[] not deadlock;
    property late : E<> deadlock && P.A && P.x > 2;
    property early : E<> deadlock && P.A && P.x == 0;
    """
    assert answers(text.format(invariant="<= 4", guard=">= 2")) == ["holds", "fails", "fails"]
    assert answers(text.format(invariant="<= 4", guard="<= 2")) == ["fails", "holds", "fails"]
    assert answers(text.format(invariant="< 4", guard=">= 4")) == ["fails", "holds", "holds"]
    assert answers(text.format(invariant="<= 4", guard="> 3 && x < 4")) == ["fails", "holds", "fails"]


def test_invariants_behind_a_step_and_urgency_count_for_deadlocks() -> None:
    text = """
    int n; urgent chan u; broadcast chan b;
    process P() {{ clock x;
        init {flag}location A {{ to B {{ {label} }} to B {{ guard n == 5; }} }}
        location B {{ invariant x <= 1; to A {{ assign x = 0; }} }} }}
    process Q() {{ clock y;
        init location C {{ to D {{ sync b?; assign y = 3; }} }} location D {{ invariant y <= 2; }} }}
    system P, Q;
    property dead : E<> deadlock && P.A;
    """
    assert answers(text.format(flag="", label="guard x >= 2;")) == ["holds"]
    assert answers(text.format(flag="", label="guard x >= 2; assign x = 0;")) == ["fails"]
    assert answers(text.format(flag="urgent ", label="guard x >= 2; assign x = 0;")) == ["holds"]
    assert answers(text.format(flag="", label="sync b!; assign x = 0;")) == ["holds"]
    assert answers(text.format(flag="committed ", label="assign n = 1, x = 0;")) == ["fails"]


@pytest.mark.parametrize(
    "wrong",
    [
        "to A { guard 1 / n == 1; }",
        "to A { assign n = 1 / n; }",
        "to B { guard x >= 3; assign n = 1 / n; }",
        "to C { guard x >= 3; }",
    ],
)
def test_whether_there_is_a_deadlock_cannot_be_said_where_an_action_goes_wrong_now_or_later(wrong: str) -> None:
    model = tachk.loads(
        f"""int n = 0; process P() {{ clock x;
            init location A {{ invariant x <= 5; to B {{ guard x <= 4; }} {wrong} }}
            location B {{ }} location C {{ invariant 1 / n == 1; }} }}
        p = P(); system p;
        property alive : E<> !deadlock && p.A; property dead : E<> deadlock && p.A && p.x == 0;"""
    )
    outcome = explore(model.network, [query.target for query in model.properties if query.target is not None])
    assert [goal.status for goal in outcome.goals] == [Status.UNDECIDED] * 2
    assert outcome.fault is not None and outcome.fault.kind is RuntimeErrorKind.DIVISION
    for engine in Engine:
        verdicts = model.verify(options=Options(engine=engine))
        assert {verdict.answer for verdict in verdicts} == {Answer.UNKNOWN}, engine


def test_an_error_that_urgency_keeps_from_happening_leaves_no_doubt_about_deadlocks() -> None:
    model = tachk.loads(
        """int n = 0; urgent broadcast chan now;
        process P() { clock x;
            init location A { to B { sync now!; } to B { guard x >= 3; assign n = 1 / n; } }
            location B { to B { } } }
        p = P(); system p;
        property alive : E<> !deadlock && p.A;"""
    )
    for engine in Engine:
        (verdict,) = model.verify(options=Options(engine=engine))
        assert verdict.answer is Answer.HOLDS, engine


PRIORITIES = """
chan a, b; chan priority {order};
int[0,2] n;
process P() {{ clock x;
    init location s {{ invariant x <= 5; to t {{ guard x >= 2; sync a!; assign n = 1; }}
        to t {{ guard x >= {late}; sync b!; assign n = 2; }} }}
    location t {{ invariant x <= {after}; }} }}
process Q() {{ init location s {{ to s {{ sync a?; }} to s {{ sync b?; }} }} }}
system P, Q;
property low : E<> n == 1;
property high : E<> n == 2;
property late : E<> n == 1 && P.x >= 4;
"""


@pytest.mark.parametrize(
    ("order", "late", "after", "expected"),
    [
        ("a < default < b", 2, 9, ["fails", "holds", "fails"]),
        ("b < default < a", 2, 9, ["holds", "fails", "holds"]),
        ("a < default < b", 4, 9, ["holds", "holds", "holds"]),  # before 4, and then time passes
        ("a, b < default", 2, 9, ["holds", "holds", "holds"]),
        ("a < default < b", 2, 1, ["fails", "fails", "fails"]),  # neither is possible
    ],
)
def test_a_possible_action_blocks_those_of_lower_priority(
    order: str, late: int, after: int, expected: list[str]
) -> None:
    assert answers(PRIORITIES.format(order=order, late=late, after=after)) == expected


def test_an_impossible_action_blocks_nothing_and_processes_have_priorities() -> None:
    text = """
    broadcast chan c; int[0,2] n;
    process P() {{ clock x;
        init location s {{ to t {{ sync c!; assign n = 1, x = 2; }} }} location t {{ invariant {i}; }} }}
    process Q() {{ init location s {{ to s {{ assign n = 2; }} }} }}
    process R() {{ init location s {{ to s {{ sync c?; }} }} }}
    system {order};
    property one : E<> n == 1;
    property two : E<> n == 2 && P.s;
    """
    assert answers(text.format(i="true", order="Q < P, R")) == ["holds", "fails"]
    assert answers(text.format(i="x <= 1", order="Q < P, R")) == ["fails", "holds"]
    assert answers(text.format(i="true", order="P < Q, R")) == ["holds", "holds"]  # R lends its priority
    assert answers(text.format(i="true", order="P, R < Q")) == ["fails", "holds"]


def test_errors_in_blocked_updates_and_later_moments_are_met() -> None:
    text = """
    chan a; int n;
    process P() { clock x; init location s { invariant x <= 3; to s { guard x >= 3; assign n = 1 / n; } } }
    system P;
    property p : A[] not deadlock;
    """
    found = tachk.loads(text).verify(options=Options(engine=Engine.SMT))[0]
    assert found.answer is Answer.UNKNOWN and found.fault is not None


def test_too_many_ways_are_rejected(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(actions, "_ACTIONS", 2)
    text = PRIORITIES.format(order="a < default < b", late=2, after=9)
    network = tachk.loads(text.replace("to s { sync a?; }", "to s { sync a?; } " * 2)).network
    with pytest.raises(UnsupportedError) as caught:
        relation(network)
    assert caught.value.diagnostic.code == "E0745"
