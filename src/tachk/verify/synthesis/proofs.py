"""Certificates of cells: made after a search, or taken from another cell and checked again."""

from __future__ import annotations

from dataclasses import replace

from tachk.engine.options import Limits, Options
from tachk.engine.outcome import Statistics
from tachk.formats.network_json.digest import digest
from tachk.meaning.discrete import prepare
from tachk.meaning.initial_state import check_initial_state
from tachk.meaning.judge.certificate import MalformedCertificateError
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.transform.observed import observed
from tachk.verify.certificates import Proof, check_natively, find_proof, is_provable
from tachk.verify.verdict import Verdict, answers_of


def proof_of(network: Network, verdict: Verdict, options: Options, limits: Limits) -> Proof | None:
    """A certificate of a verdict, checked; None for a verdict of another kind, or if a limit ends it."""
    if not is_provable(verdict):
        return None
    found = find_proof(network, digest(network), verdict.query, options, limits)
    return None if isinstance(found, str) else found


def proof_again(network: Network, query: Query, proof: Proof) -> tuple[Verdict, Proof] | None:
    """The verdict that the states the query looks for are not reached, if a certificate about other values shows it.

    Raises InputError where the initial state violates an invariant.
    """
    if query.target is None:
        return None
    check_initial_state(prepare(network))
    try:
        if check_natively(observed(network, query.observer).network, query, proof.header, proof.columns) is not None:
            return None
    except MalformedCertificateError:
        return None
    header = replace(proof.header, query=query.text, model=digest(network), constants=dict(network.constants))
    return Verdict(query, answers_of(query)[1], True, "", Statistics()), replace(proof, header=header)
