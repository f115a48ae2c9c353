"""Proofs for Munta's checker: a model, a set of states, and what the numbers in it mean."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from tachk.base.records import dataclass
from tachk.engine.options import Limits, Options
from tachk.formats.munta.actions import refused
from tachk.formats.munta.certificate import certificate_of
from tachk.formats.munta.weakened import Weakening, weakened
from tachk.formats.munta.writer import is_deadlock, to_munta
from tachk.formats.network_json.digest import digest
from tachk.meaning.judge.certificate import StateBlock
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.transform.observed import observed
from tachk.verify.certificates import find_proof


@dataclass(frozen=True, slots=True)
class MuntaProof:
    """Attributes:
    model, renaming, certificate: the contents of three files.
    asks_deadlock: the checker has to be asked for deadlock, not for the formula of the model.
    states, zones: how many the certificate has.
    weakenings: what the model of the proof can do, perhaps, that the user's model cannot.
    """

    model: str
    renaming: str
    certificate: bytes
    asks_deadlock: bool
    states: int
    zones: int
    weakenings: tuple[Weakening, ...]


def munta_proof(
    network: Network, query: Query, options: Options = Options(), limits: Limits = Limits()
) -> MuntaProof | str:
    """A proof that no state decides the query, or the reason why there is none.

    Args:
        network: without observer.

    Raises:
        UnsupportedError: E0803, with the place of what Munta cannot say.
    """
    whole, weakenings = weakened(observed(network, query.observer))
    if query.target is not None and is_deadlock(query.target):
        for weakening in weakenings:
            if weakening.of_time:
                raise refused("invariants that depend on variables", weakening.span, "make several locations of it")
    proof = find_proof(whole, digest(whole), replace(query, observer=None), replace(options, symmetry=False), limits)
    if isinstance(proof, str):
        given_up = "".join(f"\n{weakening.span}: for Munta, {weakening.text}" for weakening in weakenings)
        return proof + given_up
    if query.target is not None and is_deadlock(query.target):
        munta = to_munta(whole, query)
    else:
        munta = to_munta(whole, query, _ranges(proof.blocks(), len(whole.processes)))
    certificate = certificate_of(munta.network, proof.blocks(), len(proof.header.clocks))
    text, renaming = munta.network.text(), munta.network.renaming()
    return MuntaProof(text, renaming, certificate, munta.asks_deadlock, proof.states, proof.zones, weakenings)


def _ranges(blocks: Iterable[StateBlock], processes: int) -> dict[int, tuple[int, int]]:
    """What the cells hold in a set of states."""
    found = [(block.discretes.min(axis=0), block.discretes.max(axis=0)) for block in blocks]
    low, high = (np.array(ends)[:, processes:] for ends in zip(*found, strict=True))
    return {cell: (int(low[:, cell].min()), int(high[:, cell].max())) for cell in range(low.shape[1])}
