"""Which processes of a network are interchangeable.

Processes with the same text up to numbers and variables are candidates. What must be exchanged together with two of
them is read off where their texts differ; then `tachk.reduction.symmetry.automorphism` proves that the exchange maps
the network, and what is asked of it, onto itself. Exchanges of one process with each of the others generate all
permutations.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence

from tachk.compiler.failures import location_can_fail
from tachk.compiler.fold import known_values
from tachk.diagnostics.span import Span
from tachk.model.expressions import Expression, Variable
from tachk.model.network import Network
from tachk.records import dataclass
from tachk.reduction.symmetry.automorphism import Reading, Renaming, Unit, read
from tachk.reduction.symmetry.broadcasts import order_matters
from tachk.reduction.symmetry.kinds import Refusal
from tachk.reduction.symmetry.terms import Number, Place, Shift, Token


@dataclass(frozen=True, slots=True)
class Interchangeable:
    """Processes any two of which can be exchanged.

    Attributes:
        members: their numbers.
        exchanges: of the first one with each of the others, in order.
    """

    members: tuple[int, ...]
    exchanges: tuple[Renaming, ...]


@dataclass(frozen=True, slots=True)
class Difference:
    """Why two processes with the same text up to numbers and variables cannot be exchanged."""

    template: str
    one: str
    other: str
    refusal: Refusal


@dataclass(frozen=True, slots=True)
class Symmetry:
    """What has been found out about a network.

    Attributes:
        groups: of two processes at least.
        differences: one for each template with several instances that are not all interchangeable.
        reading: what the renamings of the groups speak of.
    """

    groups: tuple[Interchangeable, ...]
    differences: tuple[Difference, ...]
    reading: Reading


def find_symmetry(network: Network, predicates: Sequence[Expression]) -> Symmetry:
    """The interchangeable processes of a network of which the predicates are asked.

    Exchanging them maps runs to runs, run-time errors included, and keeps the values of the predicates.
    """
    known = known_values(network, predicates)
    reading = read(network, predicates, known)
    candidates = list(_candidates(reading))
    for members in candidates:
        for other in members[1:]:
            _align(reading, members[0], other)
    reading.settle()
    groups: list[Interchangeable] = []
    differences: list[Difference] = []
    for members in candidates:
        refusal = _order_of_errors(reading, members)
        if refusal is None:
            classes, refusal = _classes(reading, members)
            for each in classes:
                if len(each.members) > 1:
                    refused = order_matters(network, known, each.members)
                    refusal = refused or refusal
                    if refused is None:
                        groups.append(each)
        if refusal is not None:
            first, second = (network.processes[member] for member in members[:2])
            differences.append(Difference(first.template, first.name, second.name, refusal))
    return Symmetry(tuple(groups), tuple(differences), reading)


def _candidates(reading: Reading) -> Iterable[list[int]]:
    """Sets of processes with the same text up to numbers and variables."""
    network = reading.network
    shapes: dict[Hashable, list[int]] = {}
    for number, process in enumerate(network.processes):
        shape = (
            process.initial,
            len(process.variables),
            tuple(map(_shape, reading.locations[number])),
            tuple(map(_shape, reading.edges[number])),
        )
        shapes.setdefault(shape, []).append(number)
    return (members for members in shapes.values() if len(members) > 1)


def _shape(unit: Unit) -> Hashable:
    return tuple(_outline(token) for token in unit.tokens)


def _outline(token: Token) -> Hashable:
    if isinstance(token, Variable):
        return token.type
    if isinstance(token, Number | Place | Shift):
        return type(token).__name__
    return token


def _pairs(reading: Reading, one: int, other: int) -> Iterable[tuple[Token, Token, Span]]:
    """What stands at the same places of two processes, and what they declare."""
    first, second = (reading.network.processes[number] for number in (one, other))
    for variable, another in zip(first.variables, second.variables, strict=True):
        yield variable, another, another.span
    for here, there in ((reading.locations[one], reading.locations[other]), (reading.edges[one], reading.edges[other])):
        for unit, image in zip(here, there, strict=True):
            for token, another_token in zip(unit.tokens, image.tokens, strict=True):
                yield token, another_token, image.span


def _align(reading: Reading, one: int, other: int) -> None:
    """Whatever stands at the same place of two processes is of one kind."""
    reader = reading.reader
    for token, another, span in _pairs(reading, one, other):
        if isinstance(token, Number) and isinstance(another, Number):
            reader.kinds.unite(token.node, another.node, 0, span)
        elif isinstance(token, Variable) and isinstance(another, Variable) and token is not another:
            reader.kinds.unite_trees(reader.tree_of(token), reader.tree_of(another), span)


def _order_of_errors(reading: Reading, members: Sequence[int]) -> Refusal | None:
    """Invariants are looked at process by process: where one may be a run-time error their order can be noticed."""
    for location in reading.network.processes[members[0]].locations:
        if location_can_fail(location, reading.reader.known):
            return Refusal("an invariant or a rate may be a run-time error", location.span)
    return None


def _classes(reading: Reading, members: Sequence[int]) -> tuple[list[Interchangeable], Refusal | None]:
    """The members in classes of those that can be exchanged, and the first reason why there is more than one."""
    found: list[tuple[list[int], list[Renaming]]] = []
    reason: Refusal | None = None
    for member in members:
        for numbers, exchanges in found:
            exchange = exchange_of(reading, numbers[0], member)
            refusal = exchange if isinstance(exchange, Refusal) else reading.objection(exchange)
            if refusal is None and isinstance(exchange, Renaming):
                numbers.append(member)
                exchanges.append(exchange)
                break
            reason = reason or refusal
        else:
            found.append(([member], []))
    return [Interchangeable(tuple(numbers), tuple(exchanges)) for numbers, exchanges in found], reason


def exchange_of(reading: Reading, one: int, other: int) -> Renaming | Refusal:
    """What has to be exchanged together with two processes, where their texts differ."""
    variables: dict[Variable, Variable] = {}
    values: dict[int, dict[int, int]] = {}
    for token, another, span in _pairs(reading, one, other):
        if isinstance(token, Number) and isinstance(another, Number):
            if token.value == another.value:
                continue
            root, shift = reading.kinds.find(token.node)
            moved = values.setdefault(root, {})
            here, there = token.value - shift, another.value - shift
            if moved.setdefault(here, there) != there or moved.setdefault(there, here) != here:
                return Refusal("their numbers do not correspond one to one", span)
        elif isinstance(token, Variable) and isinstance(another, Variable) and token is not another:
            if variables.setdefault(token, another) is not another or variables.setdefault(another, token) is not token:
                return Refusal(f"`{token.name}` and `{another.name}` do not correspond one to one", span)
        elif isinstance(token, Shift) and token != another:
            return Refusal("they compute with their numbers", span)
    return Renaming({one: other, other: one}, variables, values)
