"""Certificates of verdicts: which verdicts have one, how it is made, and how one is checked."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import partial

from tachk.base.diagnostics.diagnostic import InternalError
from tachk.base.job import StoppedError, is_interrupted, limited, remembering_interruption
from tachk.engine.closed_set import check_closed_natively, check_descent_natively
from tachk.engine.compiler.lower import lower, lower_obligation
from tachk.engine.compiler.program import Interchangeable as Table
from tachk.engine.compiler.program import Program
from tachk.engine.cover import Cover, Dropped, find_cover, find_descent
from tachk.engine.options import Limits, Options
from tachk.engine.symmetry.coarse_partition import coarse_partition
from tachk.engine.symmetry.detection import find_symmetry
from tachk.engine.symmetry.tables import tables_of
from tachk.engine.traps import find_traps
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.automorphism import Automorphisms
from tachk.meaning.judge.certificate import (
    CertificateHeader,
    CertificateReader,
    Columns,
    MalformedCertificateError,
    Objection,
    ProofKind,
    Shapes,
    StateBlock,
)
from tachk.meaning.judge.closed_set import ClosedSet
from tachk.meaning.judge.transpositions import MalformedGroupError, SymmetryGroup
from tachk.meaning.judge.trap_proof import TrapProof
from tachk.meaning.judge.widening import widened
from tachk.model.expressions import Expression
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.traversal import asks_deadlock, clock_in
from tachk.transform.observed import observed
from tachk.verify.verdict import Verdict, answers_of

Clauses = tuple[tuple[int, ...], ...]
"""Numbers of traps."""


class Checker(StrEnum):
    """The checkers of certificates."""

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

    header: CertificateHeader
    cover: Cover

    @property
    def states(self) -> int:
        return self.cover.groups

    @property
    def zones(self) -> int:
        return self.cover.zones

    def blocks(self) -> Iterator[StateBlock]:
        return self.cover.blocks()

    def columns(self) -> Iterator[Columns]:
        return map(Shapes().columns, self.blocks())


def is_provable(verdict: Verdict) -> bool:
    """True if a certificate shows the answer: it says that something is never reached, or always."""
    query = verdict.query
    if query.target is not None:
        return verdict.answer is answers_of(query)[1]
    return query.avoided is not None and verdict.answer is answers_of(query)[1]


def find_proof(
    network: Network,
    model: str,
    query: Query,
    options: Options = Options(),
    limits: Limits = Limits(),
) -> Proof | str:
    """A certificate of a provable answer, or the reason why there is none.

    The search is made anew, in the whole network: what a verdict leaves out, such as processes that cannot influence
    the answer, a checker would have to believe. Exchanges of interchangeable processes are used if a checker can prove
    them by itself, and if they save something. The proof has been checked by the native checker.

    Args:
        network: without observer.
        model: the digest of the network.

    Raises KeyboardInterrupt where the job around it has been interrupted before, too.
    """
    with remembering_interruption():
        if is_interrupted():
            raise KeyboardInterrupt
        try:
            with limited(limits.seconds):
                found = _proof(network, model, query, options, limits)
        except StoppedError as error:
            return error.reason
        if is_interrupted():
            raise KeyboardInterrupt
        return found


def _proof(network: Network, model: str, query: Query, options: Options, limits: Limits) -> Proof | str:
    whole = observed(network, query.observer).network
    groups = _exchanges(whole, query) if options.symmetry else ()
    dropped = _dropped(whole, query) if "pruning" not in options.without else Dropped()
    cover = _cover(whole, query, groups, dropped, options, limits)
    header = replace(_header(network, model, query, groups), traps=dropped.traps)
    if groups and not isinstance(cover, str):
        accepted = _objection(whole, query, header, dropped.clauses, cover) is None
        enough = replace(limits, states=2 * cover.zones) if accepted else limits
        plain = _cover(whole, query, (), dropped, options, enough)
        if not accepted or (not isinstance(plain, str) and plain.zones <= cover.zones):
            cover, header = plain, replace(header, groups=())
    if isinstance(cover, str):
        return cover
    objection = _objection(whole, query, header, dropped.clauses, cover)
    if objection is not None:
        raise InternalError(f"the certificate made for {query.text!r} is not accepted: {objection.reason}")
    return Proof(header, cover)


def _objection(
    network: Network, query: Query, header: CertificateHeader, clauses: Clauses, cover: Cover
) -> Objection | None:
    return _native_check(network, query, header, clauses)(map(Shapes().columns, cover.blocks()))


def _cover(
    network: Network,
    query: Query,
    groups: Sequence[SymmetryGroup],
    dropped: Dropped,
    options: Options,
    limits: Limits,
) -> Cover | str:
    """The result of the search, which explores one state of each orbit."""
    if query.target is None:
        return _descent(network, query, groups, options, limits)
    program, (goal,) = lower(network, [query.target])
    return find_cover(_with_groups(program, groups), goal, options, limits, dropped)


def _dropped(network: Network, query: Query) -> Dropped:
    """The states from which the goal is out of reach by traps that can be proved without trusting the search."""
    if query.target is None:
        return Dropped()
    program, (goal,) = lower(network, [query.target])
    found = find_traps(program, goal)
    if not found:
        return Dropped()
    proof = TrapProof(prepare(network), query.target)
    traps = tuple(trap for trap in found if proof.objection_to(trap) is None)
    clauses = proof.clauses(traps)
    return Dropped(traps, clauses) if clauses else Dropped()


def _exchanges(network: Network, query: Query) -> tuple[SymmetryGroup, ...]:
    """The groups of interchangeable processes that can be proved without trusting the search, and that the search can
    use."""
    predicates = _predicates(query)
    by_clocks = query.target is None and any(asks_deadlock(one) or clock_in(one) is not None for one in predicates)
    if by_clocks or not coarse_partition(network).repeats:
        return ()
    tables = [table for _, table in tables_of(network, find_symmetry(network, predicates)) if isinstance(table, Table)]
    groups = (
        SymmetryGroup(each.slots, each.clocks, each.channels, each.names, each.tables, each.cyclic) for each in tables
    )
    proving = Automorphisms(prepare(network), predicates)
    return tuple(group for group in groups if proving.objection(group) is None)


def _with_groups(program: Program, groups: Iterable[SymmetryGroup]) -> Program:
    tables = (Table(each.slots, each.clocks, each.channels, each.names, each.tables, each.cyclic) for each in groups)
    return replace(program, interchangeable=tuple(tables))


def _header(network: Network, model: str, query: Query, groups: tuple[SymmetryGroup, ...]) -> CertificateHeader:
    whole = observed(network, query.observer).network
    layout = prepare(whole).layout
    clocks = tuple(layout.names[slot] for slot in layout.clock_slots)
    width = len(whole.processes) + len(layout.initial)
    kind = ProofKind.INEVITABLE if query.target is None else ProofKind.UNREACHABLE
    return CertificateHeader(kind, query.name, query.text, model, dict(network.constants), width, clocks, groups)


_LEAST_ZONES, _MOST_ZONES = 20, 20_000
"""The least and the largest number of zones of a proof that is made smaller: with few zones there is nothing to gain,
and with many the checker takes long."""


def widened_proof(network: Network, query: Query, proof: Proof, stored: int) -> Proof:
    """A proof with at most a quarter as many different zones as the search has stored, if that comes off, so that its
    file is smaller. The native checker has accepted it. Without time it stays as it is."""
    width, clocks = proof.header.width, len(proof.header.clocks)
    different = sum(len(columns.constraints) for columns in proof.columns())
    if not _LEAST_ZONES <= proof.zones <= _MOST_ZONES or 4 * different <= stored:
        return proof
    whole = observed(network, query.observer).network
    clauses = _clauses(whole, query, proof.header)
    assert not isinstance(clauses, Objection)
    check = _native_check(whole, query, proof.header, clauses)
    try:
        block = widened(proof.blocks(), width, clocks + 1, stored // 4, lambda columns: check([columns]) is None)
    except StoppedError:
        return proof
    return replace(proof, cover=Cover(len(block.zones), len(block.constraints), lambda: iter([block])))


def _native_check(
    network: Network, query: Query, header: CertificateHeader, clauses: Clauses
) -> Callable[[Iterable[Columns]], Objection | None]:
    """The native check of symbolic states of a header's locations, slots and clocks. Its groups and traps are taken as
    proved.

    Raises MalformedCertificateError.
    """
    program, goals = lower(network, _predicates(query))
    if header.width != program.state_slots or len(header.clocks) != program.clocks:
        raise MalformedCertificateError("it has other processes, variables or clocks than the model")
    program = _with_groups(program, header.groups)
    if query.target is None:
        return partial(check_descent_natively, program, goals)
    return partial(check_closed_natively, program, goals[0], header.traps, clauses)


def _predicates(query: Query) -> list[Expression]:
    return [one for one in (query.target, query.avoided, query.begins) if one is not None]


def _descent(
    network: Network,
    query: Query,
    groups: Sequence[SymmetryGroup],
    options: Options,
    limits: Limits,
) -> Cover | str:
    avoided, begins = query.avoided, query.begins
    assert avoided is not None
    if query.non_zeno:
        return "there are no certificates yet where only runs count in which time diverges"
    stops = any(location.rates for process in network.processes for location in process.locations)
    if stops and any(asks_deadlock(one) for one in (avoided, begins) if one is not None):
        return "there are no certificates of what runs meet where clocks stop and the query contains `deadlock`"
    program, goal, trigger = lower_obligation(network, avoided, begins)
    program = _with_groups(program, groups)
    found = find_descent(program, [goal] if trigger is None else [goal, trigger], options, limits)
    if query.again and isinstance(found, str):
        return "there are no certificates yet of what does not happen again and again"
    return found


def check_proof(network: Network, query: Query, certificate: CertificateReader, checker: Checker) -> Objection | None:
    """The objection to a certificate about a query; None if it is a proof.

    Raises MalformedCertificateError for a file that is damaged or that is about other processes, variables or clocks.
    """
    whole = observed(network, query.observer).network
    if (query.target is None) is not (certificate.header.kind is ProofKind.INEVITABLE):
        raise MalformedCertificateError("it is a proof of another kind than the query needs")
    if query.target is None and query.avoided is None:
        raise MalformedCertificateError("the query is of a kind that has no proofs")
    header = certificate.header
    match checker:
        case Checker.PYTHON:
            begins = query.begins if query.target is None else query.target
            clauses = _clauses(whole, query, header)
            if isinstance(clauses, Objection):
                return clauses
            traps = [[header.traps[number] for number in clause] for clause in clauses]
            return (
                _objection_to_groups(whole, query, header, certificate.columns)
                or ClosedSet(prepare(whole), certificate, query.avoided, begins, traps).objection()
            )
        case Checker.NATIVE:
            return check_natively(whole, query, header, certificate.columns)


def check_natively(
    network: Network, query: Query, header: CertificateHeader, columns: Callable[[], Iterable[Columns]]
) -> Objection | None:
    """The answer of the native checker about the blocks of a certificate of a network with observer.

    Raises MalformedCertificateError.
    """
    clauses = _clauses(network, query, header)
    if isinstance(clauses, Objection):
        return clauses
    check = _native_check(network, query, header, clauses)
    return _objection_to_groups(network, query, header, columns) or check(columns())


def _clauses(network: Network, query: Query, header: CertificateHeader) -> Clauses | Objection:
    """The clauses of the traps of a certificate: a state that lies in one trap of each need not be listed. Or the
    objection that something is no trap.

    Raises MalformedCertificateError.
    """
    if not header.traps:
        return ()
    if query.target is None:
        raise MalformedCertificateError("there are traps only in proofs that something is not reached")
    proof = TrapProof(prepare(network), query.target)
    for trap in header.traps:
        reason = proof.objection_to(trap)
        if reason is not None:
            return Objection(f"what it says that no run leaves is not so: {reason}")
    return proof.clauses(header.traps)


def _objection_to_groups(
    network: Network, query: Query, header: CertificateHeader, columns: Callable[[], Iterable[Columns]]
) -> Objection | None:
    """The objection that permutations of a header are no automorphisms; None if they map model and query to themselves.

    Raises MalformedCertificateError.
    """
    if not header.groups:
        return None
    proving = Automorphisms(prepare(network), _predicates(query))
    try:
        reasons = [proving.objection(group) for group in header.groups]
    except MalformedGroupError as error:
        raise MalformedCertificateError(str(error)) from None
    reason = next(filter(None, reasons), None)
    if reason is not None:
        return Objection(f"what it exchanges is not interchangeable: {reason}")
    for block in columns():
        discretes = block.discretes(header.width)
        if any((discretes[:, slot] != value).any() for slot, value in proving.constants.items()):
            raise MalformedCertificateError("a discrete state has another value in what nothing changes")
    return None
