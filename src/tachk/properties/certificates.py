"""Certificates of verdicts: which verdicts have one, how it is made, and how one is checked."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

from tachk.certify.certificate import Block, CertificateReader, Header, Kind, MalformedCertificateError
from tachk.certify.closed_set import Objection, check_closed
from tachk.compiler.lower import lower
from tachk.diagnostics.diagnostic import InternalError
from tachk.engines.closed_set import check_closed_natively
from tachk.engines.cover import Cover, find_cover
from tachk.engines.options import Limits, Options
from tachk.engines.outcome import Progress
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.properties.observed import observed
from tachk.properties.reachability import answers_of
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


def is_provable(verdict: Verdict) -> bool:
    """Whether a certificate shows the answer: it says that something is never reached."""
    query = verdict.query
    return query.target is not None and verdict.answer is answers_of(query)[1]


def find_proof(
    network: Network,
    model: str,
    query: Query,
    options: Options = Options(),
    limits: Limits = Limits(),
    progress: Progress | None = None,
) -> Proof | str:
    """A certificate that the target of a query is never reached, or the reason why there is none.

    The search is made anew, in the whole network: what a verdict leaves out, such as processes that cannot influence
    the answer, a checker would have to believe. The proof has been checked by the native checker.

    Args:
        network: without observer.
        model: the digest of the network.
    """
    assert query.target is not None
    whole = observed(network, query.observer)
    program, (goal,) = lower(whole, [query.target])
    cover = find_cover(program, goal, options, limits, progress)
    if isinstance(cover, str):
        return cover
    objection = check_closed_natively(program, goal, cover.blocks())
    if objection is not None:
        raise InternalError(f"the certificate made for {query.text!r} is not accepted: {objection.reason}")
    layout = prepare(whole).layout
    clocks = tuple(layout.names[cell] for cell in layout.clock_cells)
    width = len(whole.processes) + len(layout.initial)
    header = Header(Kind.UNREACHABLE, query.name, query.text, model, dict(network.constants), width, clocks)
    return Proof(header, cover)


def check_proof(network: Network, query: Query, certificate: CertificateReader, checker: Checker) -> Objection | None:
    """What is wrong with a certificate about a query; None if it is a proof.

    Raises MalformedCertificateError for a file that is damaged or that is about other processes, variables or clocks.
    """
    if query.target is None:
        raise MalformedCertificateError("it claims that something is never reached, but the query asks for more")
    whole = observed(network, query.observer)
    match checker:
        case Checker.PYTHON:
            return check_closed(prepare(whole), query.target, certificate)
        case Checker.NATIVE:
            program, (goal,) = lower(whole, [query.target])
            if certificate.header.width != program.state_slots or len(certificate.header.clocks) != program.clocks:
                raise MalformedCertificateError("it has other processes, variables or clocks than the model")
            return check_closed_natively(program, goal, certificate.blocks())
