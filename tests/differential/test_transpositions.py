"""Transpositions that the checker of certificates takes for automorphisms, by what is possible in single states; and
certificates with permutations, by both checkers and by the search without."""

from __future__ import annotations

from random import Random

import pytest

import tachk
from tachk.engine.compiler.lower import lower
from tachk.engine.options import NEVER, Limits, Options
from tachk.engine.symmetry.tables import with_symmetry
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.automorphism import Automorphisms
from tachk.meaning.judge.transpositions import MalformedGroupError, SymmetryGroup, group_element
from tachk.verify.certificates import Proof, find_proof, is_provable
from tests.support.seeds import enough, seeds
from tests.support.symmetric.cases import random_symmetric_case
from tests.support.symmetric.controllers import random_controller_case
from tests.support.symmetric.cycles import random_ring_case
from tests.support.symmetric.permuted_states import is_kept, mutated, random_state
from tests.support.symmetric.registers import random_register_case
from tests.unit.meaning.judge.proofs import PLAIN, judged, proved, written

pytestmark = pytest.mark.drawn

CASES = {
    "groups": random_symmetric_case,
    "rings": random_ring_case,
    "controllers": random_controller_case,
    "registers": random_register_case,
}
STATES = 15
SHORT = Limits(states=1_500)


@pytest.mark.parametrize("kind", CASES)
def test_what_is_accepted_keeps_what_is_possible(kind: str) -> None:
    accepted = refused = 0
    for seed in seeds(range(8)):
        random = Random(f"{kind}{seed}")
        model = tachk.loads(CASES[kind](random).text)
        prepared = prepare(model.network)
        proving = Automorphisms(prepared, [])
        processes, layout = len(model.network.processes), prepared.layout
        pinned = {processes + slot for slot in (*layout.clock_slots, *layout.channel_slots)}
        slots = [slot for slot in range(processes + len(layout.initial)) if slot not in pinned]
        program = with_symmetry(lower(model.network, [])[0], model.network, [])
        for table in program.interchangeable:
            group = SymmetryGroup(table.slots, table.clocks, table.channels, table.names, table.tables, table.cyclic)
            for _ in range(4):
                try:
                    reason = proving.objection(group)
                    accepted, refused = accepted + (reason is None), refused + (reason is not None)
                    for places in group.generators() if reason is None else ():
                        given = proving.with_own_slots(group_element(group, places))
                        for _ in range(STATES):
                            state = random_state(prepared, proving.constants, random)
                            assert is_kept(prepared, [], state, given), (seed, group, state)
                except MalformedGroupError:
                    pass
                group = mutated(group, random, slots, prepared.dimension - 1, len(prepared.channels))
    assert enough(accepted and refused)


@pytest.mark.parametrize("kind", CASES)
def test_certificates_with_orbits_prove_what_those_without_do(kind: str) -> None:
    """Each proof is accepted by both checkers; and what is not so is not proved, with or without."""
    with_orbits = 0
    for seed in seeds(range(12)):
        case = CASES[kind](Random(f"{kind}{seed}"))
        model = tachk.loads(case.text)
        for verdict in model.verify(*case.queries, options=Options().off("symmetry"), limits=SHORT):
            found = find_proof(model.network, "digest", verdict.query, limits=SHORT)
            if not isinstance(found, Proof):
                continue
            assert is_provable(verdict) or verdict.reason, (seed, verdict.query.text)
            with_orbits += bool(found.header.groups)
            assert judged(model.network, verdict.query, written(found)) is None
            assert judged(model.network, verdict.query, written(proved(model.network, verdict.query, PLAIN))) is None
    assert enough(with_orbits)


EVENTUALLY = (
    "A<> exists (i : id_t) P(i).L1",
    "E[] forall (i : id_t) P(i).L0",
    "(exists (i : id_t) P(i).L1) --> (exists (i : id_t) P(i).L0)",
    "count == 1 --> count == 0",
    "A<> count == 2",
    "P(1).L1 --> P(1).L0",
    "E[] count < 2",
    "A<> exists (i : id_t) P(i).L1 && P(i).x > 1",
)
"""Asked of groups and rings, whose processes have the same names."""


@pytest.mark.parametrize("kind", ["groups", "rings"])
def test_what_each_run_meets(kind: str) -> None:
    """Sorted or not, depth first or by a short proof: the same answers, runs that replay, and proofs."""
    with_orbits = proofs = 0
    for seed in seeds(range(20)):
        model = tachk.loads(CASES[kind](Random(f"met{seed}")).text)
        queries = Random(seed).sample(EVENTUALLY, 3)
        ways = (
            Options(),
            Options(proof_after=NEVER),
            Options(proof_after=0).off("attempts"),
            Options().off("symmetry"),
        )
        found = [list(model.verify(*queries, options=way, limits=SHORT)) for way in ways]
        for *sorted_, plain in zip(*found, strict=True):
            for verdict in sorted_:
                with_orbits += verdict.statistics.interchangeable > 0
                if not plain.reason.endswith("limit") and not verdict.reason.endswith("limit"):
                    told = verdict.answer, verdict.fault is None
                    assert told == (plain.answer, plain.fault is None), (seed, verdict.query.text)
            proof = find_proof(model.network, "digest", plain.query, limits=SHORT) if is_provable(plain) else ""
            if isinstance(proof, Proof) and proof.header.groups:
                proofs += 1
                assert judged(model.network, plain.query, written(proof)) is None
    assert enough(with_orbits and proofs)
