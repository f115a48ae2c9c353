"""Regions against enumeration: each cell as `verify` answers it with these values and nothing else."""

from __future__ import annotations

from functools import cache
from itertools import product
from random import Random

import pytest

from tachk import Answer, InputError, Model, loads
from tachk.base.diagnostics.diagnostic import UnsupportedError
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import replay
from tachk.transform.observed import observed
from tachk.verify.synthesis.bounds_of_parameters import ParameterBound
from tachk.verify.synthesis.region import CellEvidence, Region
from tests.support.seeds import enough, seeds
from tests.unit.verify.synthesis.random_models import HIGH, LOW, random_model

pytestmark = pytest.mark.drawn

SEEDS = 30
VALUES = range(LOW, HIGH + 1)
OVER = f"P={LOW}..{HIGH},Q={LOW}..{HIGH}"


def answer_of(text: str, p: int, q: int) -> Answer | None:
    """What `verify` says; None where the model is wrong with these values, UNKNOWN where an error ended it."""
    try:
        (verdict,) = loads(text, P=p, Q=q).verify(trace=False)
    except InputError:
        return None
    if verdict.unsupported is not None:
        raise UnsupportedError(verdict.unsupported)
    return verdict.answer


def check(model: Model, text: str, region: Region) -> None:
    for p, q in product(VALUES, VALUES):
        cell = region.at(P=p, Q=q)
        expected = answer_of(text, p, q)
        if expected is None:
            assert cell.answer is Answer.UNKNOWN
        elif expected is not Answer.UNKNOWN:
            assert cell.answer is expected, (p, q, cell)
    on_reached = Answer.HOLDS if region.query.holds_when_reached else Answer.FAILS
    for corner in region.corners:
        assert corner.evidence in (CellEvidence.SEARCH, CellEvidence.RUN, CellEvidence.CERTIFICATE)
        assert corner.verdict is not None
        if corner.answer is on_reached:
            assert corner.verdict.trace is not None
            values = dict(zip(("P", "Q"), corner.values, strict=True))
            replay(prepare(observed(loads(text, **values).network, None).network), corner.verdict.trace)


@cache
def synthesized(text: str) -> tuple[Model, Region] | None:
    model = loads(text)
    try:
        return model, model.synthesize(over=OVER, property="p", certify=len(text) % 3 == 0).region
    except (InputError, UnsupportedError):
        return None


@pytest.mark.parametrize("seed", seeds(range(SEEDS)))
def test_a_region_is_what_enumeration_finds(seed: int) -> None:
    text = random_model(Random(seed))
    found = synthesized(text)
    if found is None:
        for p, q in product(VALUES, VALUES):
            try:
                assert answer_of(text, p, q) is None
            except UnsupportedError:
                return
        return
    model, region = found
    check(model, text, region)


def test_the_random_models_have_what_can_go_wrong() -> None:
    bounds: list[object] = []
    evidence: set[CellEvidence] = set()
    for seed in seeds(range(SEEDS)):
        found = synthesized(random_model(Random(seed)))
        if found is not None:
            bounds += found[1].bounds
            evidence |= {cell.evidence for cell in found[1].cells}
    assert enough(sum(bound in (ParameterBound.UPPER, ParameterBound.LOWER) for bound in bounds) >= 15)
    assert enough(sum(bound not in tuple(ParameterBound) for bound in bounds) >= 15)
    assert enough(evidence == set(CellEvidence))


TWO_STEPS = """
const int P = 1; const int Q = 1;
process M() {{
    clock x;
    init location A {{ invariant x <= 3; to B {{ guard x >= 1; assign x = 0; }} }}
    location B {{ invariant x <= 2; to A {{ guard x > 1; assign x = 0; }} to C {{ guard x == 2; assign x = 0; }} }}
    location C {{ invariant x <= 1; to A {{ assign x = 0; }} }}
}}
system M;
property p : {formula};
"""


@pytest.mark.parametrize(
    "formula",
    [
        "G (M.A -> F[0, P] M.B)",
        "G (M.A -> F[P, 4 + Q] M.B)",
        "G (rise(M.B) -> G[0, P] (M.B || F[0, Q] M.C))",
        "G (M.A && !F[0, P] M.C -> F[0, Q] M.B)",
        "G (M.C -> (M.C U[0, P] M.A))",
        "G (M.C -> O[0, P] M.B)",
        "A<>[<= P] M.B",
        "M.A -->[< P] M.B",
    ],
)
def test_bounds_of_properties_against_enumeration(formula: str) -> None:
    """The direction in which an answer stands for others is the one in which it does not change."""
    model = loads(TWO_STEPS.format(formula=formula))
    inferred = model.synthesize(over="P=0..4,Q=0..2", property="p").region
    tried = model.synthesize(over="P=0..4,Q=0..2", property="p", infer=False, reuse=False).region
    assert [cell.answer for cell in inferred.cells] == [cell.answer for cell in tried.cells]
    assert any(cell.evidence is CellEvidence.IMPLIED for cell in inferred.cells)
