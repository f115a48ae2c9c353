"""Searches over local times: where they are not sound another search answers, and where they are they answer alike."""

from __future__ import annotations

import pytest

import tachk
from tachk.base.records import dataclass
from tachk.engine.compiler.lower import lower
from tachk.engine.local_times import obstacle
from tachk.engine.options import Limits, LocalTimes, Options
from tachk.engine.program_image import encode
from tachk.verify.verdict import Answer

ALWAYS = Options(local_times=LocalTimes.ALWAYS).off("unblocked", "sliced")
NEVER = Options().off("unblocked", "sliced", "local-times")

LATE = "process Q() {{ clock y; init location A {{ invariant y <= 5; to B {{ guard y >= 4; {} }} }} location B {{}} }}"
"""A process that does something at time 4 or 5."""


@dataclass(frozen=True, slots=True)
class Example:
    """Two processes, P and Q, whether a query about them holds, and why local times are not sound for it."""

    text: str
    query: str
    holds: bool
    why: str | None = None


EXAMPLES = {
    "committed": Example(
        """process P() { init committed location A { to B {} } location B {} }
        process Q() { clock y; init location A { to B { guard y == 0; } } location B {} }""",
        "E<> p.A and q.B",
        False,
        "there are committed locations",
    ),
    "urgent channel": Example(
        """urgent chan c;
        process P() { clock x; init location A { to B { sync c!; } } location B {} }
        process Q() { init location A { to B { sync c?; } } location B {} }""",
        "E<> p.A and p.x > 0",
        False,
        "there are urgent channels",
    ),
    "broadcast": Example(
        """broadcast chan c;
        process P() { init location A { to B { sync c!; } } location B {} }
        process Q() { init location A { to B { sync c?; } } location B {} }""",
        "E<> p.B and q.A",
        False,
        "there are broadcast channels",
    ),
    "deadlock": Example(
        """process P() { clock x; init location A { to B { guard x <= 1; } } location B {} }
        process Q() { init location A {} }""",
        "E<> deadlock",
        True,
    ),
    "deadlock behind a bound that only counts from above": Example(
        """process P() {
            clock x;
            init location A { to B { assign x = 0; } to B { guard x >= 3; } }
            urgent location B { to A { guard x <= 2; } }
        }
        process Q() { clock y; init location A { invariant y <= 1; to A { guard y >= 1; assign y = 0; } } }""",
        "E<> deadlock",
        True,
    ),
    "no deadlock": Example(
        """process P() { clock x; init location A { invariant x <= 3; to A { guard x >= 2; assign x = 0; } } }
        process Q() { clock y; init location A { to B { guard y <= 4; } } location B {} }""",
        "E<> deadlock",
        False,
    ),
    "what is not stuck": Example(
        """process P() { clock x; init location A { to B { guard x <= 3; } } location B {} }
        process Q() { clock y; init location A { to B { guard y <= 1; assign y = 0; } } location B {} }""",
        "E<> not deadlock and q.B and q.y > 3",
        False,
    ),
    "shared variable": Example(
        """int[0,1] n = 0;
        process P() { clock x; init location A { to B { guard n == 1 && x <= 3; } } location B {} }"""
        + LATE.format("assign n = 1;"),
        "E<> p.B",
        False,
    ),
    "shared cell": Example(
        """int[0,1] n[2]; int[0,1] i = 1;
        process P() { clock x; init location A { to B { guard n[1] == 1 && x <= 3; } } location B {} }"""
        + LATE.format("assign n[i] = 1, i = 1;"),
        "E<> p.B",
        False,
    ),
    "invariant about another's variable": Example(
        "int[0,9] n = 1; process P() { clock x; init location A { invariant x <= n; } }" + LATE.format("assign n = 9;"),
        "E<> p.x > 1 and q.B",
        False,
        "an invariant reads what other processes change",
    ),
    "invariants of two processes": Example(
        """int[0,9] n = 1;
        process P() { clock x; init location A { invariant x <= n; } }
        process Q() { clock y; init location A { invariant y <= n; to A { guard y >= 1; assign n = 9; } } }""",
        "E<> p.x > 1",
        True,
        "an invariant reads what other processes change",
    ),
    "several partners": Example(
        """chan c; int[0,1] n = 0;
        process P() { clock x; init location A { to B { guard x >= 4; sync c!; assign n = 1; } } location B {} }
        process Q() {
            clock y;
            init location A { to C { sync c?; } to B { guard n == 1 && y <= 3; } }
            location B {}
            location C {}
        }
        process R() { init location A { to A { sync c?; } } }""",
        "E<> q.B",
        False,
    ),
    "urgent location": Example(
        """process P() {
            clock x;
            init location A { to B { guard x <= 1; } }
            urgent location B { to C {} }
            location C {}
        }"""
        + LATE.format(""),
        "E<> p.B and p.x > 1 or p.B and q.B",
        False,
    ),
    "error that no run meets": Example(
        """int[0,1] n = 0;
        process P() { clock x; init location A { invariant x <= 1; } }
        process Q() { clock y; init location A { to B { guard y >= 5; assign n = 2; } } location B {} }""",
        "E<> q.B",
        False,
    ),
}


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_answer_is_that_of_the_ordinary_search(name: str) -> None:
    example = EXAMPLES[name]
    third = "r = R();" if "process R" in example.text else ""
    model = tachk.loads(f"{example.text} p = P(); q = Q(); {third} system p, q{', r' if third else ''};")
    for options in (NEVER, ALWAYS):
        (verdict,) = model.verify(example.query, options=options)
        assert verdict.answer is (Answer.HOLDS if example.holds else Answer.FAILS), options.local_times
    assert verdict.query.target is not None
    assert obstacle(encode(*lower(model.network, [verdict.query.target]))) == example.why


def test_a_run_is_reported_in_the_order_of_time() -> None:
    model = tachk.loads(
        """process P() { clock x; init location A { to B { guard x >= 7; assign x = 0; } } location B {} }
        process Q() { clock y; init location A { to B { guard y <= 2; assign y = 0; } } location B {} }
        p = P(); q = Q(); system p, q;"""
    )
    (verdict,) = model.verify("E<> p.B and q.B and q.y > 5", options=ALWAYS)
    assert verdict.trace is not None
    moved = [step.transition.participants[0].process for step in verdict.trace.steps if step.transition is not None]
    assert moved == [1, 0]


MEETING = """
chan meet;
process P() {
    clock x;
    init location A { invariant x <= 5; to B { assign x = 0; } }
    location B { invariant x <= 3; to C { guard x >= 2; sync meet!; } }
    location C {}
}
process Q() {
    clock y;
    init location A { invariant y <= 5; to B { assign y = 0; } }
    location B { to C { guard y <= 2; sync meet?; } }
    location C {}
}
p = P(); q = Q(); system
"""
"""P waits for Q from 2 to 3 after its own move, Q for P up to 2 after its own: they are bound to miss if Q is first."""


@pytest.mark.parametrize("processes", [["p", "q"], ["q", "p"]])
@pytest.mark.parametrize(
    ("query", "moved"),
    [
        ("E<> deadlock and p.B and q.B and p.x >= 1 and q.y <= 2", ["q", "p"]),
        ("E<> not deadlock and p.B and q.B and p.x >= 2 and q.y <= 1", ["p", "q"]),
        ("E<> deadlock and p.B and q.B and p.x < 1 and q.y >= 4", ["q", "p"]),
    ],
)
def test_a_run_into_a_deadlock_comes_in_the_order_that_leads_there(
    query: str, moved: list[str], processes: list[str]
) -> None:
    (verdict,) = tachk.loads(f"{MEETING} {', '.join(processes)};").verify(query, options=ALWAYS)
    assert verdict.statistics.local_times and verdict.trace is not None
    taken = [step.transition for step in verdict.trace.steps if step.transition is not None]
    assert [processes[transition.participants[0].process] for transition in taken] == moved


def test_a_deadlock_of_processes_in_a_ring() -> None:
    model = tachk.loads(
        """const int N = 4; typedef int[0, N - 1] seat_t; chan take[N], put[N];
        process Philosopher(const seat_t seat) {
            clock x;
            init location thinking { to hungry { guard x >= 1; sync take[seat]!; assign x = 0; } }
            location hungry { to eating { guard x >= 1; sync take[(seat + 1) % N]!; assign x = 0; } }
            location eating { invariant x <= 2; to done { sync put[seat]!; } }
            location done { invariant x <= 2; to thinking { sync put[(seat + 1) % N]!; assign x = 0; } }
        }
        process Fork(const seat_t place) {
            init location free { to taken { sync take[place]?; } }
            location taken { to free { sync put[place]?; } }
        }
        system Philosopher, Fork;"""
    )
    (verdict,) = model.verify("A[] not deadlock", options=ALWAYS)
    assert verdict.answer is Answer.FAILS and verdict.trace is not None
    assert verdict.statistics.local_times and verdict.statistics.exchanged
    assert {*verdict.trace.steps[-1].state.discrete.locations[:4]} == {1}


LAMPS = """
    process Lamp(int[1,6] number) {
        clock x;
        init location Off { invariant x <= 4 + number; to On { guard x >= 1; assign x = 0; } }
        location On { invariant x <= 3; to Off { guard x >= 1; assign x = 0; } }
    }
    system Lamp;
"""


def test_the_choice_is_not_made_where_it_takes_much_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tachk.engine.local_times._MUCH_MEMORY", 100_000)
    (found,) = tachk.loads(LAMPS).verify("A[] true", options=Options().off("merging"))
    assert found.answer is Answer.HOLDS
    assert not found.statistics.local_times


def test_the_choice_is_not_made_where_it_takes_much_work(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tachk.engine.local_times._SAMPLE_WORK", 10)
    (found,) = tachk.loads(LAMPS).verify("A[] true")
    assert found.answer is Answer.HOLDS
    assert not found.statistics.local_times


def test_the_choice_is_made_where_a_state_takes_more_work_than_an_ordinary_one() -> None:
    """Ten philosophers and their forks; the ordinary search does not end in a minute."""
    (chosen,) = tachk.load("models/classics/dining_philosophers.ta", N=10).verify(
        property="neighbours", limits=Limits(states=20_000)
    )
    assert chosen.answer is Answer.HOLDS
    assert chosen.statistics.local_times


def test_the_choice_is_made_where_it_pays() -> None:
    model = tachk.loads(LAMPS)
    (chosen,) = model.verify("A[] true")
    (ordinary,) = model.verify("A[] true", options=NEVER)
    assert chosen.answer is ordinary.answer is Answer.HOLDS
    assert chosen.statistics.states_stored == 2**6 < ordinary.statistics.states_stored
