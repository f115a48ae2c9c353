"""Locations and edges as sequences of tokens (`tachk.engine.symmetry.terms`)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Iterator

from tachk.analysis.failures import can_fail
from tachk.analysis.fold import fold_place
from tachk.base.records import dataclass
from tachk.base.span import Span
from tachk.engine.symmetry.index_types import IndexTypes
from tachk.engine.symmetry.terms import IndexValue, ProcessNumber, Shift, TermReader, Token
from tachk.model.expressions import Assign, Constant, Expression, Reference, Variable
from tachk.model.network import Edge, Location


@dataclass(frozen=True, slots=True)
class TermUnit:
    """A location, an edge or an update.

    Attributes:
        tokens: what has its place.
        loose: sets of updates that may come in any order.
    """

    process: int
    tokens: tuple[Token, ...]
    span: Span
    loose: tuple[tuple[TermUnit, ...], ...] = ()

    @property
    def every_token(self) -> Iterator[Token]:
        yield from self.tokens
        for updates in self.loose:
            for update in updates:
                yield from update.tokens

    @property
    def outline(self) -> Hashable:
        """The tokens up to numbers and variables."""
        return tuple(map(_outline, self.every_token))

    def text(self, outline: Callable[[Token], Hashable]) -> Hashable:
        """The token texts; those of updates in any order together."""
        loose = (Counter(tuple(map(outline, update.tokens)) for update in updates) for updates in self.loose)
        return (tuple(map(outline, self.tokens)), *(frozenset(counted.items()) for counted in loose))


def _outline(token: Token) -> Hashable:
    if isinstance(token, Variable):
        return token.type
    if isinstance(token, IndexValue | ProcessNumber | Shift):
        return type(token).__name__
    return token


def without_names(index_types: IndexTypes, token: Token) -> Hashable:
    """The common part of a token and of all that it may be mapped to."""
    match token:
        case IndexValue(node, value):
            return value if index_types.plain(index_types.find(node)[0]) is not None else "a name"
        case Variable():
            return token.type
        case ProcessNumber():
            return "a process"
        case _:
            return token


def read_location(reader: TermReader, process: int, location: Location) -> TermUnit:
    reader.begin()
    kind = location.urgent, location.committed, location.observes
    tokens: list[Token] = [("location", *kind, location.invariant is None)]
    if location.invariant is not None:
        reader.condition(location.invariant, tokens)
    for clock, rate in location.rates:
        tokens.append("rate")
        reader.whole(clock, tokens)
        reader.index_types.make_plain(reader.whole(rate, tokens), "a clock runs with it", rate.span)
    return TermUnit(process, tuple(tokens), location.span)


def read_edge(reader: TermReader, process: int, edge: Edge, rank: Callable[[TermUnit], int]) -> TermUnit:
    """Updates that may come in any order come in that of their ranks."""
    reader.begin()
    tokens: list[Token] = [("edge", edge.source, edge.target, edge.guard is None, len(edge.updates))]
    for variable in edge.selects:
        reader.bind(variable, tokens)
    if edge.guard is not None:
        reader.condition(edge.guard, tokens)
    if edge.synchronisation is not None:
        tokens.append(("synchronisation", edge.synchronisation.direction))
        reader.whole(edge.synchronisation.channel, tokens)
    span = edge.spans[0]
    loose = []
    for updates in _blocks(reader, edge.updates):
        if len(updates) == 1:
            reader.whole(updates[0], tokens)
            continue
        tokens.append(("in any order", len(updates)))
        read = []
        for update in updates:
            its_own: list[Token] = []
            reader.whole(update, its_own)
            read.append(TermUnit(process, tuple(its_own), span))
        loose.append(tuple(sorted(read, key=rank)))
    return TermUnit(process, tuple(tokens), span, tuple(loose))


def _blocks(reader: TermReader, updates: Iterable[Expression]) -> Iterator[list[Expression]]:
    """Updates one after the other, those together of which it makes no difference which one comes first: each sets a
    variable of its own to a constant that it can hold."""
    block: list[Expression] = []
    written: set[Variable] = set()
    for update in updates:
        variable = _set_to_constant(reader, update)
        if block and (variable is None or not written or variable in written):
            yield block
            block, written = [], set()
        block.append(update)
        if variable is not None:
            written.add(variable)
    if block:
        yield block


def _set_to_constant(reader: TermReader, update: Expression) -> Variable | None:
    match fold_place(update, reader.known):
        case Assign(Reference(variable), Constant(), _, None) if not can_fail(update, reader.known):
            return variable
        case _:
            return None
