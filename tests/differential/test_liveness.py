"""The search for runs that avoid a goal, against the oracle that knows nothing of zones, with every option."""

from __future__ import annotations

from random import Random

import pytest

from tachk.base.operators import UnaryOperator
from tachk.engine.compiler.lower import lower
from tachk.engine.liveness import find_avoiding_run
from tachk.engine.options import NEVER, BoundScope, Extrapolation, Limits, Options
from tachk.engine.outcome import LivenessOutcome, LivenessStatus, Obligation
from tachk.model.expressions import BOOL, Unary
from tests.support import RandomCase, Shape, random_case
from tests.support.obligations import random_obligations
from tests.support.oracles.liveness_regions import check_by_regions
from tests.support.seeds import enough, seeds

pytestmark = pytest.mark.drawn

VARIANTS = (
    Options(),
    Options(proof_after=0),
    Options(proof_after=NEVER),
    Options().off("attempts"),
    Options(proof_after=NEVER).off("attempts"),
    Options(extrapolation=Extrapolation.MAX),
    Options(extrapolation=Extrapolation.MAX, proof_after=0),
    Options(extrapolation=Extrapolation.NONE),
    Options(bounds=BoundScope.GLOBAL),
    Options(subsumption=False),
    Options(subsumption=False, proof_after=0),
    Options(width=32, scale=False),
    Options(width=64, vector=False),
    Options(chunk_words=1, reclaim=False, rows_after=0),
    Options(pack_clocks=0, rows_after=0),
    Options(pack_clocks=0, proof_after=0, reclaim=False),
)
LIMITS = Limits(states=20_000)
UNWIDENED_LIMITS = Limits(states=300, depth=20)
"""Without extrapolation a search need not end."""

SMALL = {"processes": 2, "locations": 3, "clocks": 2, "constant": 3, "deadlocks": False}
SHAPES = {
    "plain": Shape(**SMALL),
    "exact": Shape(**SMALL, exact=0.5),
    "priorities": Shape(**SMALL, priorities=True),
    "diagonals": Shape(**SMALL, diagonals=True),
    "one process": Shape(**{**SMALL, "processes": 1, "locations": 4}),
    "three processes": Shape(**{**SMALL, "processes": 3, "constant": 2}),
    "deadlocks": Shape(**{**SMALL, "deadlocks": True}),
    "stopwatches": Shape(**SMALL, stopwatches=True),
    "copies": Shape(**SMALL, copies=0.5),
    "copies and diagonals": Shape(**SMALL, copies=0.5, advances=False, diagonals=True),
    "copies that stop": Shape(**SMALL, copies=0.5, stopwatches=True),
    "faults": Shape(**SMALL, language=True, faults=0.3),
}


def answers(case: RandomCase, obligation: Obligation) -> list[LivenessOutcome]:
    """What the variants find."""
    asked = [p for p in (obligation.goal, obligation.trigger) if p is not None]
    program, goals = lower(case.network, [both for p in asked for both in (p, Unary(UnaryOperator.NOT, p, BOOL))])
    trigger = None if obligation.trigger is None else goals[2]
    return [
        find_avoiding_run(
            program,
            goals[0],
            trigger,
            options,
            UNWIDENED_LIMITS if options.extrapolation is Extrapolation.NONE else LIMITS,
        )
        for options in VARIANTS
    ]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("block", range(2))
def test_all_options_find_what_the_oracle_finds(shape: str, block: int) -> None:
    decided = set()
    for seed in seeds(range(8 * block, 8 * block + 8)):
        random = Random(seed)
        case = random_case(random, SHAPES[shape])
        for obligation in random_obligations(random, case, 3):
            outcomes = answers(case, obligation)
            found = {o.status for o in outcomes} - {LivenessStatus.UNDECIDED}
            assert len(found) <= 1, f"seed {seed}: {[o.status for o in outcomes]}"
            if SHAPES[shape].stopwatches:
                continue
            expected = check_by_regions(case.network, obligation, Limits(states=600))
            if expected.status is LivenessStatus.UNDECIDED or not found:
                continue  # one side gave up, or met a run-time error
            assert found == {expected.status}, f"seed {seed}: the oracle found {expected.run}"
            decided.add(expected.status)
    assert enough(SHAPES[shape].stopwatches or len(decided) == 2)
