"""Meta variables that carry a value from one transition to the next, although they are not part of the state."""

from __future__ import annotations

from collections.abc import Iterable

from tachk.base.job import check_job
from tachk.base.records import replace
from tachk.base.words import Direction
from tachk.model.expressions import (
    Assert,
    Assign,
    Binary,
    Block,
    Call,
    Conditional,
    Constant,
    Declare,
    Evaluate,
    Expression,
    Field,
    Function,
    If,
    Increment,
    Index,
    Iterate,
    Quantifier,
    Reference,
    Return,
    Statement,
    Variable,
    While,
)
from tachk.model.network import Edge, Network
from tachk.model.traversal import children, roots
from tachk.model.types import RecordType, Type

Part = tuple[Variable, tuple[int | str, ...]]
"""A variable or a part of it: constant indices and names of fields, or first of all `_OF_THE_CHANNEL`."""
_OF_THE_CHANNEL = "[channel]"
"""The indices of the channel of the edge: ``c_value[i]`` beside ``c[i]!`` and ``c[j]?``."""
_SOMEWHERE = "[?]"


def keep_lasting(network: Network) -> Network:
    """The network whose states hold the meta variables that must last.

    One of a template that must last in one process does so in all.
    """
    places = {variable.span for variable in lasting_metas(network)}
    if not places:
        return network
    candidates = (v for v in network.all_variables() if v.declared_meta and v.carries is None)
    return replace(network, lasting=frozenset(v for v in candidates if v.span in places))


def lasting_metas(network: Network) -> frozenset[Variable]:
    """The meta variables that a transition may read before it has written them, part by part.

    Hidden variables for the values that channels pass are none: a receiver always reads what its sender wrote.
    """
    metas = frozenset(v for v in network.all_variables() if v.declared_meta and v.carries is None)
    if not metas:
        return metas
    found: set[Variable] = set()
    sent: dict[Variable, frozenset[Part]] = {}  # what every sender on a channel writes
    for process in network.processes:
        check_job()
        for location in process.locations:
            rates = [part for pair in location.rates for part in pair]
            _LastingMetas(metas, found).values([e for e in (location.invariant, *rates) if e], _NONE)
        for edge in process.edges:
            search = _LastingMetas(metas, found, edge)
            search.values([e for e in (edge.guard, edge.synchronisation and edge.synchronisation.channel) if e], _NONE)
            if edge.begins:
                written = search.values(edge.updates, _NONE)
                for channel in _channels(edge):
                    sent[channel] = sent.get(channel, written) & written
    for process in network.processes:
        for edge in process.edges:
            if edge.synchronisation is not None and edge.synchronisation.direction is Direction.RECEIVE:
                before = [sent[channel] for channel in _channels(edge) if channel in sent]
                if before:
                    _LastingMetas(metas, found, edge).values(edge.updates, frozenset.intersection(*before))
    return frozenset(found)


_NONE: frozenset[Part] = frozenset()


def _channels(edge: Edge) -> list[Variable]:
    """The channel variables over which an edge may synchronise."""
    return [] if edge.synchronisation is None else list(roots(edge.synchronisation.channel))


def _indices(place: Expression) -> tuple[Expression, ...]:
    return (*_indices(place.base), place.index) if isinstance(place, Index) else ()


class _LastingMetas:
    """Runs over the code of an edge in the order of its evaluation, with what is certainly written by then."""

    def __init__(self, metas: frozenset[Variable], found: set[Variable], edge: Edge | None = None) -> None:
        self.metas = metas
        self.found = found
        synchronisation = None if edge is None else edge.synchronisation
        self.channel_indices = () if synchronisation is None else _indices(synchronisation.channel)
        self.exits: list[frozenset[Part]] = []  # what is written at the return statements of the current function
        self.known: dict[tuple[Function, frozenset[Part]], frozenset[Part]] = {}

    def place_of(self, expression: Expression) -> Part | None:
        """The place of a meta variable that an expression denotes; None for any other expression."""
        match expression:
            case Reference(variable):
                return (variable, ()) if variable in self.metas else None
            case Field(base, name):
                place = self.place_of(base)
                return None if place is None else (place[0], (*place[1], name))
            case Index(base, index):
                place = self.place_of(base)
                if place is None:
                    return None
                indices = _indices(expression)
                if len(indices) == len(place[1]) + 1 and indices == self.channel_indices:
                    return place[0], (_OF_THE_CHANNEL,)
                return place[0], (*place[1], index.value if isinstance(index, Constant) else _SOMEWHERE)
            case _:
                return None

    def is_written(self, place: Part, type_: Type, written: frozenset[Part]) -> bool:
        variable, path = place
        if any((variable, path[:length]) in written for length in range(len(path) + 1)):
            return True
        fields = type_.fields if isinstance(type_, RecordType) else ()
        return bool(fields) and all(self.is_written((variable, (*path, n)), t, written) for n, t in fields)

    def values(self, expressions: Iterable[Expression], written: frozenset[Part]) -> frozenset[Part]:
        for expression in expressions:
            written = self.value(expression, written)
        return written

    def value(self, expression: Expression, written: frozenset[Part]) -> frozenset[Part]:
        """The metas written after the expression; reads of others are noted."""
        match expression:
            case Reference() | Index() | Field() if (place := self.place_of(expression)) is not None:
                if not self.is_written(place, expression.type, written):
                    self.found.add(place[0])
                return self.values(_indices(expression), written)
            case Assign(target, value, operator=operator):
                written = self.place(target, written) if operator is None else self.value(target, written)
                written = self.value(value, written)
                place = self.place_of(target)
                return written if place is None or _SOMEWHERE in place[1] else written | {place}
            case Increment(target):
                return self.value(target, written)
            case Binary(operator, left, right) if operator.decided_by is not None:
                written = self.value(left, written)
                self.value(right, written)
                return written
            case Conditional(condition, then, otherwise):
                written = self.value(condition, written)
                return self.value(then, written) & self.value(otherwise, written)
            case Quantifier(body=body):
                self.value(body, written)
                return written
            case Call(function, arguments) if function.operation is None:
                return self.call(function, self.values(arguments, written))
            case _:
                return self.values(children(expression), written)

    def place(self, target: Expression, written: frozenset[Part]) -> frozenset[Part]:
        """A place that is about to be overwritten: only what computes it is read."""
        match target:
            case Reference():
                return written
            case Index(base, index):
                return self.value(index, self.place(base, written))
            case Field(base):
                return self.place(base, written)
            case _:
                return self.value(target, written)

    def call(self, function: Function, written: frozenset[Part]) -> frozenset[Part]:
        if (function, written) not in self.known:
            outer, self.exits = self.exits, []
            end = self.statement(function.body, written)
            self.known[function, written] = end.intersection(*self.exits)
            self.exits = outer
        return self.known[function, written]

    def statement(self, statement: Statement, written: frozenset[Part]) -> frozenset[Part]:
        """The metas written after the statement where control goes on there."""
        match statement:
            case Block(statements):
                for inner in statements:
                    written = self.statement(inner, written)
            case Evaluate(expression) | Assert(expression):
                written = self.value(expression, written)
            case Declare(_, initial):
                written = written if initial is None else self.value(initial, written)
            case Return(value):
                self.exits.append(written if value is None else self.value(value, written))
            case If(condition, then, otherwise):
                written = self.value(condition, written)
                after = self.statement(then, written)
                written = after & (written if otherwise is None else self.statement(otherwise, written))
            case While(condition, body, test_first):
                if not test_first:
                    written = self.statement(body, written)
                written = self.value(condition, written)
                self.statement(body, written)
            case Iterate(_, body):
                self.statement(body, written)
        return written
