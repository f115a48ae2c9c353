"""Proofs for Munta's checker: a model, a set of states, and what the numbers in it mean."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from tachk import Limits, Options, Verdict
from tachk.api.plugin import Network, Query, bytes_, current_job, unhurried, write_whole
from tachk.api.proofs import StateBlock, find_proof, is_provable, observed
from tachk_munta.actions import unsupported
from tachk_munta.certificate import certificate_of
from tachk_munta.weakened import Weakening, weakened
from tachk_munta.writer import is_deadlock, to_munta


@dataclass(frozen=True, slots=True)
class MuntaProof:
    """Attributes:
    model, renaming, certificate: the contents of three files.
    asks_deadlock: the checker must check for deadlock, not the formula of the model.
    states, zones: how many the certificate has.
    weakenings: the behaviour that the model of the proof may have and the user's model does not.
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
        UnsupportedError: E0803, with the place of the construct that Munta lacks.
    """
    whole, weakenings = weakened(observed(network, query.observer).network)
    if query.target is not None and is_deadlock(query.target):
        for weakening in weakenings:
            if weakening.of_time:
                raise unsupported("invariants that depend on variables", weakening.span, "make several locations of it")
    proof = find_proof(whole, "", replace(query, observer=None), options.off("symmetry", "pruning"), limits)
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


def write_proofs(folder: Path, network: Network, verdicts: Sequence[Verdict], options: Options, limits: Limits) -> bool:
    """Writes NAME.muntax, NAME.renaming and NAME.muntac for each verdict that says that something is never reached, and
    lists on standard error the files and the weakenings of each proof.

    Returns:
        Whether Munta can confirm each answer that is not shown by a run.

    Raises:
        UnsupportedError: E0803, with the place of the construct that Munta lacks.
    """
    folder.mkdir(parents=True, exist_ok=True)
    missing = False
    provable = [verdict.query for verdict in verdicts if is_provable(verdict)]
    for query in provable:
        proof: MuntaProof | str = "for Munta, runs never end and never wait for ever"
        if query.target is not None:
            seconds = current_job().seconds_left
            left = limits if seconds is None else replace(limits, seconds=seconds)
            with unhurried():  # the time is that of the search for a proof
                proof = munta_proof(network, query, options, left)
        if isinstance(proof, str):
            print(f"error: no proof for Munta of {query.name}: {proof}", file=sys.stderr)
            missing = True
        else:
            _write(folder, query.name, proof)
    if not provable:
        print(f"{folder}: no proof, for no answer is of a kind that Munta can confirm", file=sys.stderr)
    return not missing


def _write(folder: Path, name: str, proof: MuntaProof) -> None:
    for weakening in proof.weakenings:
        print(f"{weakening.span}: for Munta, {weakening.text}: the proof covers more runs", file=sys.stderr)
    model, renaming, certificate = (folder / f"{name}.{ending}" for ending in ("muntax", "renaming", "muntac"))
    write_whole(model, proof.model)
    write_whole(renaming, proof.renaming)
    write_whole(certificate, proof.certificate)
    deadlock = " -dc" if proof.asks_deadlock else ""
    size = f"{proof.zones} zones of {proof.states} discrete states, {bytes_(len(proof.certificate))}"
    print(f"{name}: {size}", file=sys.stderr)
    print(f"  muntac{deadlock} -m {model} -r {renaming} -c {certificate}", file=sys.stderr)


def _ranges(blocks: Iterable[StateBlock], processes: int) -> dict[int, tuple[int, int]]:
    """The least and the largest value of each slot in a set of states."""
    found = [(block.discretes.min(axis=0), block.discretes.max(axis=0)) for block in blocks]
    low, high = (np.array(ends)[:, processes:] for ends in zip(*found, strict=True))
    return {slot: (int(low[:, slot].min()), int(high[:, slot].max())) for slot in range(low.shape[1])}
