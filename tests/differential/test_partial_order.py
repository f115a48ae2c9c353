"""Where time cannot pass, one order of independent actions gives the verdicts of all orders."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest

import tachk
from tachk.compiler.lower import lower
from tachk.engines import reference
from tachk.engines.options import Limits, LocalTimes, Options, SearchOrder
from tachk.engines.outcome import Outcome, Status
from tachk.engines.zone import explore
from tachk.testing.networks import Case, Shape, random_case

ON = Options(partial_order=True, local_times=LocalTimes.NEVER)
SHAPES = (
    Shape(groups=2, hurried=0.6, clocks=2, processes=2, locations=3, deadlocks=False),
    Shape(groups=3, hurried=0.7, clocks=1, processes=1, deadlocks=False),
    Shape(groups=3, hurried=0.5, clocks=1, processes=2, locations=3, deadlocks=False, clocks_on_broadcast=False),
    Shape(hurried=0.6, clocks=2, deadlocks=False),
    Shape(hurried=0.6, language=True, faults=0.3, clocks=2),
    Shape(groups=2, hurried=0.4, clocks=2, processes=2, locations=3, diagonals=True),
)
VARIANTS = (ON, replace(ON, order=SearchOrder.DFS), replace(ON, order=SearchOrder.BFS, subsumption=False))


def one_goal(seed: int) -> Case:
    """Of several goals none could be left out of sight."""
    random = Random(seed)
    case = random_case(random, SHAPES[seed % len(SHAPES)])
    return replace(case, predicates=(random.choice(case.predicates),))


def searched(case: Case, options: Options) -> Outcome:
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


@pytest.mark.parametrize("seed", range(60))
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
