"""The export to Munta keeps what can be reached, and its certificates are proofs, by a second interpreter of files.

Munta itself is not here: `munta_interpretation` says what its files mean. That Munta agrees was tried by hand; see
docs/certificates.md.
"""

from __future__ import annotations

from pathlib import Path
from random import Random

import pytest
from tachk_munta.proofs import munta_proof
from tachk_munta.writer import to_munta

from plugins.munta.tests.munta_interpretation import MuntaInterpretation
from tachk.api import model as api
from tachk.base.diagnostics.diagnostic import UnsupportedError
from tachk.base.records import replace
from tachk.base.words import QueryKind
from tachk.engine import zone
from tachk.engine.compiler.lower import lower
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import Status
from tachk.model.expressions import Assign, Constant, Expression
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.types import ClockType
from tests.support import Shape, random_case
from tests.support.seeds import enough, seeds

CLASSICS = Path(__file__).parents[3] / "models" / "classics"
SAYABLE = Shape(clocks=2, locations=3, processes=3, urgent_channels=False, clocks_on_broadcast=False, deadlocks=False)
SHAPES = (SAYABLE, replace(SAYABLE, language=True, processes=2), replace(SAYABLE, broadcast=False))


def with_resets_to_zero(network: Network) -> Network:
    """Munta sets clocks to 0 only."""

    def to_zero(update: Expression) -> Expression:
        if isinstance(update, Assign) and isinstance(update.target.type, ClockType):
            return replace(update, value=Constant(0))
        return update

    processes = (
        replace(p, edges=tuple(replace(e, updates=tuple(map(to_zero, e.updates))) for e in p.edges))
        for p in network.processes
    )
    return replace(network, processes=tuple(processes))


def test_random_networks() -> None:
    compared = proved = 0
    for seed in seeds(range(36)):
        case = random_case(Random(seed), SHAPES[seed % len(SHAPES)])
        network = with_resets_to_zero(case.network)
        program, goals = lower(network, case.predicates)
        outcome = zone.explore(program, goals, Options(), Limits(states=2000))
        if outcome.fault is not None:
            continue
        for predicate, goal in zip(case.predicates, outcome.goals, strict=True):
            query = Query("q", QueryKind.POSSIBLY, predicate, text="q")
            try:
                munta = to_munta(network, query).network
            except UnsupportedError:
                continue
            reached = MuntaInterpretation(munta.text(), munta.renaming()).is_reached()
            assert reached is (goal.status is Status.REACHED), f"seed {seed}"
            compared += 1
            if not reached:
                proof = munta_proof(network, query)
                assert not isinstance(proof, str)
                assert MuntaInterpretation(proof.model, proof.renaming).is_proof(proof.certificate), f"seed {seed}"
                proved += 1
    assert enough((compared > 25, proved > 6) == (True, True)), (compared, proved)


@pytest.mark.parametrize(
    ("model", "name", "constants"),
    [
        ("bridge.ta", "two_at_most", {}),
        ("brp.ta", "no_premature_timeout", {}),
        ("critical_region.ta", "exclusive", {"N": 2, "CAREFUL": 1}),
        ("csma_cd.ta", "collision_noticed", {"N": 2}),
        ("dining_philosophers.ta", "neighbours", {"N": 3}),
        ("fddi.ta", "rotation_bound", {"N": 2}),
        ("fischer.ta", "mutual_exclusion", {"N": 2}),
        ("train_gate.ta", "one_at_a_time", {"N": 2}),
    ],
)
def test_classics(model: str, name: str, constants: dict[str, int]) -> None:
    loaded = api.load(str(CLASSICS / model), **constants)
    query = next(query for query in loaded.loaded.queries if query.name == name)
    proof = munta_proof(loaded.network, query)
    assert not isinstance(proof, str)
    interpretation = MuntaInterpretation(proof.model, proof.renaming)
    assert interpretation.is_proof(proof.certificate)
    assert not interpretation.is_reached()


def test_what_is_no_proof_is_noticed() -> None:
    """Of the interpretation, not of the export: it is worth nothing if it accepts everything."""
    loaded = api.load(str(CLASSICS / "fischer.ta"), N=2)
    query = next(query for query in loaded.loaded.queries if query.name == "mutual_exclusion")
    proof = munta_proof(loaded.network, query)
    assert not isinstance(proof, str)
    interpretation = MuntaInterpretation(proof.model, proof.renaming)
    random = Random(1)
    rejected = 0
    for _ in range(40):
        position = 8 * random.randrange(5, len(proof.certificate) // 8)
        word = int.from_bytes(proof.certificate[position : position + 8])
        if word in (0, (1 << 63) - 1):
            continue
        changed = proof.certificate[:position] + (word - 1).to_bytes(8) + proof.certificate[position + 8 :]
        try:
            rejected += not interpretation.is_proof(changed)
        except (AssertionError, StopIteration, RuntimeError):
            rejected += 1
    assert rejected > 10
