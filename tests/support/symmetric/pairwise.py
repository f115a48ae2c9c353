"""Symmetry by the plain way, pair by pair: each transposition is proved from nothing, for the network and its query."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from tachk.engine.symmetry import cyclic_symmetry, detection
from tachk.engine.symmetry.automorphism import NetworkTerms
from tachk.engine.symmetry.detection import Symmetry, search_symmetry
from tachk.engine.symmetry.index_types import AsymmetryReason
from tachk.engine.symmetry.renaming import Block, KnownRenamings, Renaming
from tachk.engine.symmetry.transpositions import transposition_of
from tachk.model.expressions import Expression
from tachk.model.network import Network


def pairwise_symmetry(network: Network, predicates: Sequence[Expression]) -> Symmetry:
    """The symmetry that is found where nothing is known but the network and its predicates."""
    proved_rotation = cyclic_symmetry._proved_rotation

    def rotation(terms: NetworkTerms, families: Sequence[Block], step: int) -> Renaming | AsymmetryReason:
        terms.shared = KnownRenamings()
        return proved_rotation(terms, families, step)

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(detection, "proved_transposition", _transposition)
        patched.setattr(cyclic_symmetry, "_proved_rotation", rotation)
        return search_symmetry(network, predicates)


def _transposition(terms: NetworkTerms, one: Block, other: Block) -> Renaming | AsymmetryReason:
    found = transposition_of(terms, one, other)
    if isinstance(found, AsymmetryReason):
        return found
    return terms.objection(found) or terms.objection_of_predicates(found) or found


def objections(symmetry: Symmetry, network: Network, predicates: Sequence[Expression]) -> list[AsymmetryReason]:
    """What is wrong with the generators of a symmetry, if the network is read anew."""
    terms = pairwise_symmetry(network, predicates).terms
    found = (terms.objection(each) or terms.objection_of_predicates(each) for each in symmetry.renamings)
    return [each for each in found if each is not None]
