"""Transpositions that follow from others: the same orbits as if each pair of processes were tried anew."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from random import Random

import pytest

import tachk
from tachk import Limits
from tachk.engine.symmetry.detection import Symmetry, find_symmetry
from tachk.model.connectives import any_of, both
from tachk.model.expressions import Expression, LocationTest
from tests.support.seeds import enough, seeds
from tests.support.symmetric.cases import SymmetricCase, random_symmetric_case
from tests.support.symmetric.controllers import random_controller_case
from tests.support.symmetric.cycles import random_ring_case
from tests.support.symmetric.pairs import random_pairs_case
from tests.support.symmetric.pairwise import objections, pairwise_symmetry
from tests.support.symmetric.registers import random_register_case


def _targets(model: tachk.Model, queries: Iterable[str]) -> list[Expression]:
    verdicts = model.verify(*queries, limits=Limits(states=1), trace=False)
    return [verdict.query.target for verdict in verdicts if verdict.query.target is not None]


def _orbits(symmetry: Symmetry) -> list[set[object]]:
    return [set(each.members) for each in (*symmetry.groups, *symmetry.cycles)]


@pytest.mark.parametrize(
    "random_case",
    [random_symmetric_case, random_controller_case, random_register_case, random_ring_case, random_pairs_case],
)
def test_the_orbits_are_those_of_all_pairs(random_case: Callable[[Random], SymmetricCase]) -> None:
    split = 0
    for seed in seeds(range(24)):
        case = random_case(Random(seed))
        model = tachk.loads(case.text)
        for predicates in ([], *([target] for target in _targets(model, case.queries))):
            found = find_symmetry(model.network, predicates)
            pairwise = pairwise_symmetry(model.network, predicates)
            # A product of transpositions may keep a query that the one which is guessed for a pair does not keep.
            missing = [orbit for orbit in _orbits(pairwise) if not any(orbit <= each for each in _orbits(found))]
            assert not missing, f"seed {seed}: {missing}"
            assert not objections(found, model.network, predicates), f"seed {seed}"
            split += bool(predicates and found.groups)
    assert enough(split > 5)


_PAIRS = """
const int N = {size};
typedef int[1, N] id_t;
chan ask[N + 1];
process P(const id_t me) {{ init location A {{ to B {{ sync ask[me]!; }} }} location B; }}
process Q(const id_t me) {{ init location A {{ to B {{ sync ask[me]?; }} }} location B; }}
system P, Q;
"""


@pytest.mark.parametrize("size", [6, 12])
def test_each_block_of_an_orbit_is_proved_once_whatever_is_asked(size: int, tried: list[object]) -> None:
    network = tachk.loads(_PAIRS.format(size=size)).network
    assert [len(group.members) for group in find_symmetry(network, []).groups] == [size]
    reached = [LocationTest(number, 1) for number in range(2 * size)]
    targets = [reached[0], both(reached[1], reached[size + 2]), any_of([reached[1], reached[3]])]
    orbits = [sorted(len(group.members) for group in find_symmetry(network, [target]).groups) for target in targets]
    assert orbits == [[size - 1], [size - 2], [2, size - 2]]
    assert len(tried) == size + 1  # each block with the first one, and the first two processes of both sides alone
