"""Certificates with traps: proofs of random networks in which much is lost are accepted, and a search that leaves out
what is in a trap that is none proves nothing."""

from __future__ import annotations

from random import Random

import pytest

import tachk
from tachk.engine.compiler.lower import lower
from tachk.engine.options import Options
from tachk.engine.traps import find_traps
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.certificate import Objection
from tachk.meaning.judge.trap_proof import TrapProof
from tachk.verify.certificates import Proof, find_proof, is_provable
from tachk.verify.verdict import Answer
from tests.support.certificates_with_traps import LIMITS, altered, blocks_without, claimed, random_trap
from tests.support.missed_moments import random_missed_moments
from tests.support.seeds import enough, seeds
from tests.unit.meaning.judge.proofs import judged, written

pytestmark = pytest.mark.drawn


def test_proofs_with_traps_are_accepted() -> None:
    with_traps = fewer = 0
    for seed in seeds(range(40)):
        case = random_missed_moments(Random(seed))
        model = tachk.loads(case.text)
        options = Options() if seed % 2 else Options().off("symmetry")
        for verdict in model.verify(*case.queries, limits=LIMITS, trace=False):
            found = find_proof(model.network, "digest", verdict.query, options, LIMITS) if is_provable(verdict) else ""
            if not isinstance(found, Proof):
                continue
            assert judged(model.network, verdict.query, written(found)) is None, (seed, verdict.query.text)
            whole = find_proof(model.network, "digest", verdict.query, options.off("pruning"), LIMITS)
            with_traps += bool(found.header.traps)
            fewer += isinstance(whole, Proof) and found.zones < whole.zones
    assert enough(with_traps and fewer)


def test_what_is_no_trap_proves_nothing_wrong() -> None:
    """A state that satisfies the query is reached: whatever is left out, no certificate says that none is."""
    offered = not_a_trap = 0
    for seed in seeds(range(40)):
        random = Random(f"wrong{seed}")
        case = random_missed_moments(random)
        model = tachk.loads(case.text)
        for verdict in model.verify(*case.queries, limits=LIMITS, trace=False):
            if is_provable(verdict) or verdict.answer is Answer.UNKNOWN or verdict.query.target is None:
                continue
            program, (goal,) = lower(model.network, [verdict.query.target])
            known = find_traps(program, goal)
            tried = [[altered(trap, model.network, random) for trap in known]] if known else []
            tried += [[random_trap(model.network, random)] for _ in range(3)]
            for traps in tried:
                certificate = claimed(model.network, verdict.query, traps)
                if isinstance(certificate, str):
                    continue
                found = judged(model.network, verdict.query, certificate)
                assert isinstance(found, Objection), (seed, verdict.query.text, traps)
                offered += 1
                not_a_trap += found.reason.startswith("what it says that no run leaves")
    assert enough(offered > not_a_trap > 0)


def test_both_checkers_judge_altered_proofs_alike() -> None:
    refused = accepted = 0
    for seed in seeds(range(25)):
        random = Random(f"altered{seed}")
        case = random_missed_moments(random)
        model = tachk.loads(case.text)
        for verdict in model.verify(*case.queries, limits=LIMITS, trace=False):
            found = find_proof(model.network, "digest", verdict.query, limits=LIMITS) if is_provable(verdict) else ""
            if not isinstance(found, Proof) or not found.header.traps or found.states < 2:
                continue
            for _ in range(3):
                without = blocks_without(found, random.randrange(found.states))
                objection = judged(model.network, verdict.query, written(found, without))
                refused, accepted = refused + (objection is not None), accepted + (objection is None)
            assert verdict.query.target is not None
            clauses = TrapProof(prepare(model.network), verdict.query.target).clauses(found.header.traps)
            for number, trap in enumerate(found.header.traps):
                traps = [*found.header.traps]
                traps[number] = altered(trap, model.network, random)
                certificate = claimed(model.network, verdict.query, traps, clauses)
                if not isinstance(certificate, str):
                    objection = judged(model.network, verdict.query, certificate)
                    refused, accepted = refused + (objection is not None), accepted + (objection is None)
    assert enough(refused and accepted)
