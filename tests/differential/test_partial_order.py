"""Where time cannot pass, one order of independent actions gives the verdicts of all orders."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest

import tachk
from tachk.engine.compiler.lower import lower
from tachk.engine.options import Limits, Options, SearchOrder
from tachk.engine.outcome import Outcome, Status
from tachk.engine.zone import explore
from tachk.model.random_networks import RandomCase, Shape, random_case
from tests.support.oracles import reference
from tests.support.seeds import seeds

pytestmark = pytest.mark.drawn

ON = Options(partial_order=True).off("local-times")
SHAPES = (
    Shape(groups=2, hurried=0.6, clocks=2, processes=2, locations=3, deadlocks=False),
    Shape(groups=3, hurried=0.7, clocks=1, processes=1, deadlocks=False),
    Shape(groups=3, hurried=0.5, clocks=1, processes=2, locations=3, deadlocks=False, clocks_on_broadcast=False),
    Shape(hurried=0.6, clocks=2, deadlocks=False),
    Shape(hurried=0.6, language=True, faults=0.3, clocks=2),
    Shape(hurried=0.6, language=True, faults=0.3, clocks=2, copies=0.5),
    Shape(groups=2, hurried=0.6, clocks=2, processes=2, locations=3, deadlocks=False, copies=0.5),
    Shape(groups=2, hurried=0.4, clocks=2, processes=2, locations=3, diagonals=True),
)
VARIANTS = (ON, replace(ON, order=SearchOrder.DFS), replace(ON, order=SearchOrder.BFS, subsumption=False))


def one_goal(seed: int) -> RandomCase:
    """Of several goals none could be left out of sight."""
    random = Random(seed)
    case = random_case(random, SHAPES[seed % len(SHAPES)])
    return replace(case, predicates=(random.choice(case.predicates),))


def searched(case: RandomCase, options: Options) -> Outcome:
    program, goals = lower(case.network, case.predicates)
    return explore(program, goals, options, Limits(states=3_000))


def disagreements(one: Outcome, other: Outcome) -> list[int]:
    """Goals of which one search says the opposite of the other one, or that they are out of reach where the other one
    has met a run-time error."""
    found = []
    for number, statuses in enumerate(zip(one.goals, other.goals, strict=True)):
        said = {goal.status for goal in statuses}
        if said == {Status.REACHED, Status.UNREACHABLE}:
            found.append(number)
        if Status.UNREACHABLE in said and (one.fault or other.fault):
            found.append(number)
    return found


@pytest.mark.parametrize("seed", seeds(range(60)))
def test_random_networks(seed: int) -> None:
    case = one_goal(seed)
    every = searched(case, replace(ON, partial_order=False))
    some = searched(case, VARIANTS[seed % len(VARIANTS)])
    assert not disagreements(every, some)
    if seed % 10 == 0:
        assert not disagreements(some, reference.explore(case.network, case.predicates, Limits(states=200)))


SENSORS = """
const int N = 4;
typedef int[0, N - 1] id_t;
int seen[N];
clock now;
process Sensor(const id_t i) {
    init location asleep { invariant now <= 10; to awake { guard now == 10; } }
    urgent location awake { to measuring { } to failed { } }
    urgent location measuring { to done { assign seen[i] = 1; } }
    urgent location failed { to done { assign seen[i] = 2; } }
    location done { }
}
process Judge() {
    init location waiting { invariant now <= 11; to late { guard now == 11; } }
    location late { to wrong { guard seen[0] == 1 && seen[1] == 2 && seen[2] + seen[3] == CODE; } }
    location wrong { }
}
system Sensor, Judge;
property wrong : E<> Judge.wrong;
"""


@pytest.mark.parametrize(("code", "status"), [(3, Status.REACHED), (5, Status.UNREACHABLE)])
def test_sensors_that_report_at_once(code: int, status: Status) -> None:
    loaded = tachk.loads(SENSORS.replace("CODE", str(code)))
    (query,) = loaded.properties
    assert query.target is not None
    program, goals = lower(loaded.network, [query.target])
    every, some = (explore(program, goals, replace(ON, partial_order=on)) for on in (False, True))
    assert every.goals[0].status is some.goals[0].status is status
    if status is Status.UNREACHABLE:
        assert 2 * some.statistics.states_stored < every.statistics.states_stored


ROUNDS = """
const int N = 10;
typedef int[0, N - 1] id_t;
int[0, 2] seen[N];
process Sensor(const id_t i) {
    clock x;
    init location asleep { invariant x <= 20 * i + 10; to sending { guard x >= 20 * i + 10; } }
    location sending {
        invariant x <= 20 * i + 15;
        to sent { assign seen[i] = 1; }
        to sent { guard x >= 20 * i + 12; assign seen[i] = 2; }
    }
    location sent { invariant x <= 800; to asleep { guard x >= 800; assign x = 0, seen[i] = 0; } }
}
system Sensor;
property none : E<> false;
property some : E<> seen[0] == 1 && seen[9] == 2 && Sensor(5).sent;
property two : E<> seen[0] == 1 && seen[9] == 1 && Sensor(9).asleep;
property again : E<> Sensor(3).asleep && Sensor(6).sent;
"""
"""All sensors begin the next round at the same time, in any of N! orders."""


@pytest.mark.parametrize(
    ("name", "status"),
    [("none", Status.UNREACHABLE), ("some", Status.REACHED), ("two", Status.UNREACHABLE), ("again", Status.REACHED)],
)
def test_sensors_whose_round_ends_at_once(name: str, status: Status) -> None:
    loaded = tachk.loads(ROUNDS)
    (query,) = (each for each in loaded.properties if each.name == name)
    assert query.target is not None
    program, goals = lower(loaded.network, [query.target])
    every, some = (explore(program, goals, replace(ON.off("alu"), partial_order=on)) for on in (False, True))
    assert every.goals[0].status is some.goals[0].status is status
    if name == "none":
        assert 4 * some.statistics.states_stored < every.statistics.states_stored


OTHERS_COME_FIRST = {
    "what the goal asks for holds for a moment": (
        (
            "process P() { init urgent location u { to v {} } location v {} }"
            "process Q() { init urgent location a { to b {} } location b {} }"
        ),
        "p.u && q.b",
    ),
    "what a member reads is written by another": (
        (
            "int[0, 1] n;"
            "process P() { init urgent location u { to v { guard n == 0; } to w { guard n == 1; } }"
            " location v {} location w { to x {} } location x {} }"
            "process Q() { init location a { to b { assign n = 1; } } location b {} }"
        ),
        "p.x",
    ),
    "a partner gets ready": (
        (
            "chan c;"
            "process P() { init urgent location u { to v {} to w { sync c?; } } location v {} location w { to x {} }"
            " location x {} }"
            "process Q() { init location a { to b {} } location b { to d { sync c!; } } location d {} }"
        ),
        "p.x",
    ),
    "a committed location must not be entered too early": (
        (
            "int[0, 1] n;"
            "process P() { init urgent location u { to c {} } committed location c { to v { guard n == 1; } }"
            " location v {} }"
            "process Q() { init location a { to b { assign n = 1; } } location b {} }"
        ),
        "p.v",
    ),
    "a member cannot always move": (
        (
            "int[0, 1] n; clock x, y;"
            "process P() { init location s { invariant x <= 5; to u { assign n = 1; } }"
            " urgent location u { to v { guard x >= 3; } } location v {} }"
            "process Q() { init location a { to b { guard n == 1 && y <= 1; } } location b {} }"
        ),
        "q.b",
    ),
    "a broadcast comes before a member listens": (
        (
            "int[0, 1] n; broadcast chan all;"
            "process P() { init urgent location u { to v {} }"
            " location v { to w { sync all?; } to x { guard n == 1; } } location w {} location x {} }"
            "process Q() { init location a { to b { sync all!; assign n = 1; } } location b {} }"
        ),
        "p.x",
    ),
    "what the goal asks for holds for a moment, when time has run out": (
        (
            "clock x;"
            "process P() { init location u { invariant x <= 3; to v { guard x >= 3; } } location v {} }"
            "process Q() { init location a { to b { guard x >= 3; } } location b {} }"
        ),
        "p.u && q.b",
    ),
    "another process lets time go on": (
        (
            "clock x, y; int[0, 1] n;"
            "process P() { init location s { invariant x <= 3; to u { guard x >= 3; assign n = 1; } }"
            " location u { invariant x <= 3; to v {} to w { guard y >= 5; } } location v {}"
            " location w { to z {} } location z {} }"
            "process Q() { init location a { to b { guard n == 1; assign x = 0; } } location b {} }"
        ),
        "p.z",
    ),
    "time has nearly run out": (
        (
            "clock x, z; int[0, 1] n;"
            "process P() { init location s { invariant x <= 2; to u { guard x >= 2; assign n = 1; } }"
            " location u { invariant x <= 3; to v { assign z = 0; } } location v { invariant z <= 0; } }"
            "process Q() { init location a { to b { guard n == 1 && x <= 2; } } location b { to c { guard x >= 3; } }"
            " location c {} }"
        ),
        "q.c",
    ),
    "a clock is set before another process reads it": (
        (
            "clock x, y;"
            "process P() { init urgent location u { to v { assign x = 5; } } urgent location v {} }"
            "process Q() { init urgent location a { to b { assign y = x; } } urgent location b {} }"
        ),
        "q.b && y >= 5",
    ),
    "a clock is set after another process has read it": (
        (
            "clock x, y;"
            "process P() { init urgent location a { to b { assign y = x; } } urgent location b {} }"
            "process Q() { init urgent location u { to v { assign x = 5; } } urgent location v {} }"
        ),
        "p.b && y <= 0",
    ),
    "a clock is set before code reads it": (
        (
            "clock x, y; int[0, 1] n;"
            "process P() { init urgent location u { to v { assign x = 5; } } urgent location v {} }"
            "process Q() { init urgent location a { to b { assign y = x + n; } }"
            " urgent location b { to b { assign n = 1; } } }"
        ),
        "q.b && y >= 5",
    ),
    "a clock is set after code has read it": (
        (
            "clock x, y; int[0, 1] n;"
            "process P() { init urgent location a { to b { assign y = x + n; } }"
            " urgent location b { to b { assign n = 1; } } }"
            "process Q() { init urgent location u { to v { assign x = 5; } } urgent location v {} }"
        ),
        "p.b && y <= 0",
    ),
    "time has not run out in all of the zone": (
        (
            "clock x, y; int[0, 1] n;"
            "process P() { init location u { invariant x <= 3; to v { guard x >= 1; assign n = 1; } } location v {} }"
            "process Q() { init location a { to b { guard n == 0 && y <= 2; } } location b {} }"
        ),
        "q.b",
    ),
}


@pytest.mark.parametrize("name", OTHERS_COME_FIRST)
def test_others_may_come_first(name: str) -> None:
    text, goal = OTHERS_COME_FIRST[name]
    loaded = tachk.loads(f"{text} p = P(); q = Q(); system p, q; property found : E<> {goal};")
    (query,) = loaded.properties
    assert query.target is not None
    program, goals = lower(loaded.network, [query.target])
    for on in (False, True):
        outcome = explore(program, goals, replace(ON, partial_order=on, order=SearchOrder.BFS))
        assert outcome.goals[0].status is Status.REACHED, on


def test_a_run_is_reported_past_an_error_that_was_put_off() -> None:
    """The error of p is met in the second state only, and is on the way again when the run to that state is told."""
    loaded = tachk.loads(
        "int[0, 3] n;"
        "process P() { init location a { to b { assign n = n + 5; } } location b {} }"
        "process Q() { init urgent location u { to v {} } urgent location v { to w {} } location w {} }"
        "p = P(); q = Q(); system p, q; property found : E<> q.w;"
    )
    (query,) = loaded.properties
    assert query.target is not None
    program, goals = lower(loaded.network, [query.target])
    fault = explore(program, goals, replace(ON, order=SearchOrder.BFS)).fault
    assert fault is not None
    assert len(fault.path) == 1
