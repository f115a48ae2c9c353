"""A coarse partition of the processes of a network: processes of different colours are not interchangeable.

Colour refinement (`tachk.engine.symmetry.colour_refinement`) divides the processes by the variables and elements of
arrays that their edges mention, whatever their order. Then the numbers in their own texts that are more than names
divide the processes of one colour. The partition is cheap: it recognises most networks without interchangeable
processes before they are read in full. Results for a process are shared by the networks that contain it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Iterable, Iterator, Sequence

from tachk.analysis.fold import Known, fold, fold_place, known_values
from tachk.analysis.never_taken import never_taken
from tachk.base.records import dataclass, replace
from tachk.engine.symmetry.colour_refinement import Line, numbered, refined
from tachk.model.expressions import Call, Constant, Expression, Function, Index, Reference, Variable, VariableKind
from tachk.model.network import Edge, Location, Network, Process
from tachk.model.remembered import by_network, by_part
from tachk.model.traversal import statement_expressions, walk


@dataclass(frozen=True, slots=True)
class CoarsePartition:
    """Attributes:
    known: the constants of the network.
    never: the edges that are never taken, by process and number.
    colours: a number for each process; those of different numbers never become each other, nor do those without edges.
    """

    known: Known
    never: frozenset[tuple[int, int]]
    colours: Sequence[int]

    @property
    def repeats(self) -> bool:
        """True if two processes with edges have the same colour."""
        return len(set(self.colours)) < len(self.colours)

    def edges_taken(self, network: Network, process: int) -> tuple[Edge, ...]:
        """The edges of a process that are not known to be never taken."""
        edges = network.processes[process].edges
        return tuple(edge for place, edge in enumerate(edges) if (process, place) not in self.never)


_Mention = tuple[Variable, int | None]
"""A variable; of an array also the element, by its index if this is a constant."""
_Mentions = tuple[Line[_Mention], ...]
"""Locations and edges with the variables that each of them mentions."""


@by_network
def coarse_partition(network: Network) -> CoarsePartition:
    known = known_values(network, ())
    never = never_taken(network)
    lines: list[_Mentions] = []
    for number, process in enumerate(network.processes):
        edges = enumerate(_edges(process, known))
        lines.append((*_locations(process, known), *(line for place, line in edges if (number, place) not in never)))
    return _divided(network, CoarsePartition(known, never, _refined(network, lines)))


def _refined(network: Network, lines: Sequence[_Mentions]) -> list[int]:
    processes = numbered(
        (
            process.initial,
            tuple(v.type for v in process.variables),
            frozenset(Counter(shape for shape, _ in own).items()),
        )
        if process.edges
        else number
        for number, (process, own) in enumerate(zip(network.processes, lines, strict=True))
    )
    things = list(dict.fromkeys(mention for own in lines for _, mentioned in own for _, mention in mentioned))
    colours = dict(zip(things, numbered((each[0].type, each[1] is None) for each in things), strict=True))
    return refined(lines, processes, colours, lambda _: None)


def _divided(network: Network, partition: CoarsePartition) -> CoarsePartition:
    """The partition refined by the text of each process on its own, where the first two of a colour differ in it."""

    def alone(number: int) -> Hashable:
        from tachk.engine.symmetry.alone import text_alone  # of no use where all processes differ

        return text_alone(network.processes[number], partition.edges_taken(network, number), partition.known)

    members: dict[int, list[int]] = {}
    for number, colour in enumerate(partition.colours):
        members.setdefault(colour, []).append(number)
    texts: dict[int, Hashable] = {}
    for similar in members.values():
        if len(similar) > 1 and alone(similar[0]) != alone(similar[1]):
            texts |= {number: alone(number) for number in similar}
    colours = numbered((colour, texts.get(number)) for number, colour in enumerate(partition.colours))
    return replace(partition, colours=colours)


@by_part
def _locations(process: Process, known: Known) -> _Mentions:
    return tuple(
        _line(("location", number), _of_location(location, known), known)
        for number, location in enumerate(process.locations)
    )


@by_part
def _edges(process: Process, known: Known) -> _Mentions:
    return tuple(_line((edge.source, edge.target), _of_edge(edge, known), known) for edge in process.edges)


def _line(shape: Hashable, expressions: Iterable[Expression], known: Known) -> Line[_Mention]:
    return shape, tuple((None, mention) for mention in _mentioned(expressions, known))


def _of_location(location: Location, known: Known) -> Iterator[Expression]:
    if location.invariant is not None:
        yield fold(location.invariant, known)
    for pair in location.rates:
        yield from (fold_place(each, known) for each in pair)


def _of_edge(edge: Edge, known: Known) -> Iterator[Expression]:
    if edge.guard is not None:
        yield fold(edge.guard, known)
    if edge.synchronisation is not None:
        yield fold_place(edge.synchronisation.channel, known)
    yield from (fold_place(update, known) for update in edge.updates)


def _mentioned(expressions: Iterable[Expression], known: Known) -> tuple[_Mention, ...]:
    """The variables mentioned in expressions and the functions they call, but for those of a call."""
    found: dict[_Mention, None] = {}
    for node in (node for expression in expressions for node in walk(expression)):
        match node:
            case Reference(variable) if variable.kind not in (VariableKind.BOUND, VariableKind.FRAME):
                found[variable, None] = None
            case Index(Reference(variable), Constant(index)) if variable.kind is not VariableKind.FRAME:
                found[variable, index] = None
            case Call(function):
                found |= dict.fromkeys(_of_function(function, known))
            case _:
                pass
    return tuple(found)


@by_part
def _of_function(function: Function, known: Known) -> tuple[_Mention, ...]:
    return _mentioned((fold_place(each, known) for each in statement_expressions(function.body)), known)
