"""Processes that observe (`Location.observes`): no engine and no reduction lets committed locations keep them still."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest

import tachk
from tachk.engine.compiler.lower import lower
from tachk.engine.options import Options, SearchOrder
from tachk.engine.outcome import Status
from tachk.engine.zone import explore
from tachk.model.random_networks import RandomCase, Shape, random_case
from tests.support.agreement import Effort, compare
from tests.support.endless.awaited_agreement import SHAPES as ENDLESS
from tests.support.endless.awaited_agreement import elaborated
from tests.support.endless.awaited_oracle import FORMS
from tests.support.formulas import FLAGS
from tests.support.observer_agreement import random_atom
from tests.support.reductions.verdict_agreement import ALONE, BY_DEFAULT, TOGETHER, Questions, compare_verdicts
from tests.support.seeds import enough, seeds

pytestmark = pytest.mark.drawn

EFFORT = Effort(reference=300, sampled=0, unrolled=8)
VARIANTS = (
    Options(partial_order=True).off("local-times"),
    Options(partial_order=True, order=SearchOrder.DFS, subsumption=False).off("local-times"),
)
SHAPES = (
    Shape(hurried=0.8, clocks=1, deadlocks=False),
    Shape(groups=3, hurried=0.8, clocks=1, processes=1, deadlocks=False),
    Shape(groups=2, hurried=0.7, clocks=1, processes=2, locations=3, deadlocks=False),
    Shape(hurried=0.7, clocks=1, broadcast=True),
)


def observing_case(seed: int) -> RandomCase:
    """A network one process of which observes, wherever it is, with a single goal, so that some stay out of sight."""
    random = Random(seed)
    case = random_case(random, SHAPES[seed % len(SHAPES)])
    processes = list(case.network.processes)
    chosen = random.randrange(len(processes))
    locations = tuple(replace(each, observes=True) for each in processes[chosen].locations)
    processes[chosen] = replace(processes[chosen], locations=locations)
    network = replace(case.network, processes=tuple(processes))
    return replace(case, network=network, predicates=(random.choice(case.predicates),))


@pytest.mark.parametrize("block", range(4))
def test_engines_agree_where_a_process_observes(block: int) -> None:
    decided = 0
    for seed in seeds(range(8 * block, 8 * block + 8)):
        found = compare(observing_case(seed), VARIANTS, EFFORT)
        assert found.problems == (), f"seed {seed}"
        if "smt" in found.outcomes:
            decided += sum(goal.status is not Status.UNDECIDED for goal in found.outcomes["smt"].goals)
    assert enough(decided >= 6)


def test_an_observer_may_become_more_committed_than_those_that_stop_time() -> None:
    """Once X has moved, C moves no more; so X must not be the first one."""
    loaded = tachk.loads(
        "int[0, 1] n;"
        "process B() { init committed location u { to v { guard n == 1; } } location v {} }"
        "process X() { init location a { to b; } committed location b { to a { guard n == 1; assign n = 1; } } }"
        "process C() { init committed location u { to v; } location v {} }"
        "b = B(); x = X(); c = C(); system b, x, c; property found : E<> c.v;"
    )
    x = loaded.network.processes[1]
    observing = replace(x, locations=tuple(replace(each, observes=True) for each in x.locations))
    first, _, last = loaded.network.processes
    network = replace(loaded.network, processes=(first, observing, last))
    (query,) = loaded.properties
    assert query.target is not None
    program, goals = lower(network, [query.target])
    for options in (*VARIANTS, Options()):
        assert explore(program, goals, options).goals[0].status is Status.REACHED, options


def without(name: str) -> Options:
    """The defaults without what a single way of `ALONE` is about."""
    return {
        "subsumption": replace(BY_DEFAULT, subsumption=False),
        "alu": BY_DEFAULT.off("alu"),
        "merging": BY_DEFAULT.off("merging"),
        "local times": BY_DEFAULT.off("local-times"),
        "cone of influence": BY_DEFAULT.off("cone"),
        "without what only blocks": BY_DEFAULT.off("unblocked", "sliced"),
        "symmetry": BY_DEFAULT.off("symmetry"),
    }.get(name, BY_DEFAULT)


def endless_questions(seed: int, forms: tuple[str, ...]) -> Questions:
    """Formulas without deadline about a network with committed locations; their observers act there, too."""
    random = Random(seed)
    network = random_case(random, ENDLESS[seed % len(ENDLESS)]).network
    queries = [elaborated(network, form, {name: random_atom(random, network) for name in FLAGS})[0] for form in forms]
    named = tuple(replace(query, name=f"q{number}") for number, query in enumerate(queries))
    return Questions("endless", network, named)


@pytest.mark.parametrize("seed", seeds(range(12)))
def test_reductions_leave_formulas_without_deadline_as_they_are(seed: int) -> None:
    alone, together = list(ALONE)[seed % len(ALONE)], list(TOGETHER)[seed % len(TOGETHER)]
    ways = {
        "default": BY_DEFAULT,
        alone: ALONE[alone],
        f"without {alone}": without(alone),
        together: TOGETHER[together],
    }
    found = compare_verdicts(endless_questions(seed, FORMS[seed % len(FORMS) :][:3]), ways)
    assert found.problems == ()
    assert found.verdicts
