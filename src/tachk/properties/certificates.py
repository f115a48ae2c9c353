"""Certificates of verdicts: which verdicts have one, how it is made, and how one is checked."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import partial

from tachk.certify.certificate import (
    Block,
    CertificateReader,
    Columns,
    Header,
    Kind,
    MalformedCertificateError,
    Objection,
    Shapes,
)
from tachk.certify.closed_set import ClosedSet
from tachk.certify.widening import widened
from tachk.compiler.lower import lower, lower_obligation
from tachk.diagnostics.diagnostic import InternalError
from tachk.engines.closed_set import check_closed_natively, check_descent_natively
from tachk.engines.cover import Cover, find_cover, find_descent
from tachk.engines.options import Limits, Options
from tachk.engines.outcome import Progress
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.traversal import asks_deadlock
from tachk.properties import liveness, reachability
from tachk.properties.observed import observed
from tachk.properties.verdict import Verdict
from tachk.semantics.discrete import prepare


class Checker(StrEnum):
    """Who checks a certificate."""

    PYTHON = "python"
    """Plain Python over the semantics of the model, which shares no code with the engine."""
    NATIVE = "native"
    """C++, much faster; it shares the compiled expressions with the engine."""


@dataclass(frozen=True, slots=True)
class Proof:
    """A certificate that can be written.

    Attributes:
        states: how many discrete states it has.
        zones: how many zones.
    """

    header: Header
    cover: Cover

    @property
    def states(self) -> int:
        return self.cover.groups

    @property
    def zones(self) -> int:
        return self.cover.zones

    def blocks(self) -> Iterator[Block]:
        return self.cover.blocks()

    def columns(self) -> Iterator[Columns]:
        return map(Shapes().columns, self.blocks())


def is_provable(verdict: Verdict) -> bool:
    """Whether a certificate shows the answer: it says that something is never reached, or always."""
    query = verdict.query
    if query.target is not None:
        return verdict.answer is reachability.answers_of(query)[1]
    return query.avoided is not None and verdict.answer is liveness.answers_of(query)[1]


def find_proof(
    network: Network,
    model: str,
    query: Query,
    options: Options = Options(),
    limits: Limits = Limits(),
    progress: Progress | None = None,
) -> Proof | str:
    """A certificate of a provable answer, or the reason why there is none.

    The search is made anew, in the whole network: what a verdict leaves out, such as processes that cannot influence
    the answer, a checker would have to believe. The proof has been checked by the native checker.

    Args:
        network: without observer.
        model: the digest of the network.
    """
    whole = observed(network, query.observer)
    if query.target is None:
        cover = _descent(whole, query, options, limits, progress)
    else:
        program, (goal,) = lower(whole, [query.target])
        cover = find_cover(program, goal, options, limits, progress)
    if isinstance(cover, str):
        return cover
    layout = prepare(whole).layout
    clocks = tuple(layout.names[cell] for cell in layout.clock_cells)
    width = len(whole.processes) + len(layout.initial)
    kind = Kind.INEVITABLE if query.target is None else Kind.UNREACHABLE
    header = Header(kind, query.name, query.text, model, dict(network.constants), width, clocks)
    objection = _check_natively(whole, query, width, len(clocks), map(Shapes().columns, cover.blocks()))
    if objection is not None:
        raise InternalError(f"the certificate made for {query.text!r} is not accepted: {objection.reason}")
    return Proof(header, cover)


_LEAST_ZONES, _MOST_ZONES = 20, 20_000
"""Of how many zones a proof is made smaller: not of very few, and not of so many that the checker takes long."""


def widened_proof(network: Network, query: Query, proof: Proof, stored: int) -> Proof:
    """A proof with at most a quarter as many different zones as the search has stored, if that comes off, so that its
    file is smaller. The native checker has accepted it. Raises OutOfTimeError."""
    width, clocks = proof.header.width, len(proof.header.clocks)
    different = sum(len(columns.constraints) for columns in proof.columns())
    if not _LEAST_ZONES <= proof.zones <= _MOST_ZONES or 4 * different <= stored:
        return proof
    check = _native_check(observed(network, query.observer), query, width, clocks)
    block = widened(proof.blocks(), width, clocks + 1, stored // 4, lambda columns: check([columns]) is None)
    return replace(proof, cover=Cover(len(block.zones), len(block.constraints), lambda: iter([block])))


def _check_natively(
    network: Network, query: Query, width: int, clocks: int, blocks: Iterable[Columns]
) -> Objection | None:
    """What the native checker says of symbolic states of so many locations and cells, and clocks.

    Raises MalformedCertificateError.
    """
    return _native_check(network, query, width, clocks)(blocks)


def _native_check(
    network: Network, query: Query, width: int, clocks: int
) -> Callable[[Iterable[Columns]], Objection | None]:
    predicates = [one for one in (query.target, query.avoided, query.begins) if one is not None]
    program, goals = lower(network, predicates)
    if width != program.state_slots or clocks != program.clocks:
        raise MalformedCertificateError("it has other processes, variables or clocks than the model")
    if query.target is None:
        return partial(check_descent_natively, program, goals)
    return partial(check_closed_natively, program, goals[0])


def _descent(
    network: Network, query: Query, options: Options, limits: Limits, progress: Progress | None
) -> Cover | str:
    avoided, begins = query.avoided, query.begins
    assert avoided is not None
    if query.again:
        return "there are no certificates yet of what does not happen again and again"
    if query.non_zeno:
        return "there are no certificates yet where only runs count in which time diverges"
    stops = any(location.rates for process in network.processes for location in process.locations)
    if stops and any(asks_deadlock(one) for one in (avoided, begins) if one is not None):
        return "there are no certificates of what runs meet where clocks stop and `deadlock` is asked for"
    program, goal, trigger = lower_obligation(network, avoided, begins)
    return find_descent(program, [goal] if trigger is None else [goal, trigger], options, limits, progress)


def check_proof(network: Network, query: Query, certificate: CertificateReader, checker: Checker) -> Objection | None:
    """What is wrong with a certificate about a query; None if it is a proof.

    Raises MalformedCertificateError for a file that is damaged or that is about other processes, variables or clocks.
    """
    whole = observed(network, query.observer)
    if (query.target is None) is not (certificate.header.kind is Kind.INEVITABLE):
        raise MalformedCertificateError("it is a proof of another kind than the query needs")
    if query.target is None and query.avoided is None:
        raise MalformedCertificateError("the query is of a kind that has no proofs")
    match checker:
        case Checker.PYTHON:
            begins = query.begins if query.target is None else query.target
            return ClosedSet(prepare(whole), certificate, query.avoided, begins).objection()
        case Checker.NATIVE:
            header = certificate.header
            return _check_natively(whole, query, header.width, len(header.clocks), certificate.columns())
