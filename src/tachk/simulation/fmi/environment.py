"""A part of a network, and its environment: a process that stands for the rest of it.

The rest acts by the edges of that process: it sends over a channel, or changes variables without sending. The
values that variables then have are inputs, which the update of such an edge copies, so that receivers read what the
sender has written. The process receives what the part sends, and keeps the payload.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tachk.analysis.fold import Known, fold_place, known_values
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass, replace
from tachk.base.words import Direction
from tachk.model.expressions import (
    BOOL,
    Assign,
    Binary,
    Constant,
    Expression,
    Field,
    Index,
    LocationTest,
    Reference,
    Variable,
    VariableKind,
)
from tachk.model.network import Edge, Location, Network, Process, Signal, Synchronisation
from tachk.model.traversal import (
    process_expressions,
    roots,
    walk,
    with_bodies,
    written_variables,
)
from tachk.model.types import ArrayType, ChannelType, ClockType, IntType, RecordType, kinds_of_slots
from tachk.transform.transformation import Exactness, Transformation

OUTSIDE, SENT = "outside.", "sent."
"""Before the names of variables: what the rest writes, and the payload of the last message of the part."""
_NEVER = Variable("outside.acts", IntType(0, 1), VariableKind.GLOBAL, (0,))


@dataclass(frozen=True, slots=True)
class OpenNetwork(Transformation):
    """The part, with empty processes in place of the others, and its environment as the last process.

    Attributes:
        inputs: the variables that the environment writes, each with the one that it is for.
        receives, sends: the channels over which the environment sends and receives, each with its edge that does it.
        nudge: the edge by which it changes inputs without sending.
    """

    inputs: tuple[tuple[Variable, Variable], ...]
    receives: tuple[tuple[str, int], ...]
    sends: tuple[tuple[str, int], ...]
    nudge: int


def open_network(network: Network, names: Sequence[str]) -> OpenNetwork:
    """The part of a network that consists of the processes of these names, or of templates of these names.

    Raises UsageError for what is none, and for a part that cannot run on its own.
    """
    inside = _chosen(network, names)
    known = known_values(network, ())
    ours, theirs = (
        _PartInterface(network, inside, known),
        _PartInterface(network, set(range(len(network.processes))) - inside, known),
    )
    _check_separable(network, ours, theirs)
    shared = [v for v in network.variables if v in ours.used and v in theirs.used and _is_data(v)]
    inputs = [v for v in shared if v in theirs.written]
    sent = [v for v in shared if network.resets(v) and v in ours.written]
    copies = {v: replace(v, name=OUTSIDE + v.name, declared_meta=False) for v in inputs}
    sent_copies = {v: replace(v, name=SENT + v.name, declared_meta=False) for v in sent}
    copy = tuple(_assign(v, copies[v]) for v in inputs)
    copy_sent = tuple(_assign(sent_copies[v], v) for v in sent)
    receives = sorted(ours.channels[Direction.RECEIVE].keys() & theirs.channels[Direction.SEND].keys())
    sends = sorted(ours.channels[Direction.SEND].keys() & theirs.channels[Direction.RECEIVE].keys())
    edges = [
        Edge(0, 0, guard=_never(), updates=(*copy, _reset())),
        Edge(0, 0, guard=_never(), updates=tuple(_assign(copies[v], v) for v in inputs)),
    ]
    edges += [_edge(ours.channels[Direction.RECEIVE][name], Direction.SEND, _never(), copy) for name in receives]
    edges += [_edge(ours.channels[Direction.SEND][name], Direction.RECEIVE, None, copy_sent) for name in sends]
    return OpenNetwork(
        network,
        replace(
            network,
            processes=(*_with_stubs(network, inside), Process("outside", "outside", (Location("all"),), tuple(edges))),
            variables=(*_used(network, ours), *copies.values(), *sent_copies.values(), _NEVER),
            signals=tuple(signal for signal in network.signals if _is_seen(network, signal, ours)),
        ),
        Exactness.NOTHING,
        tuple((copies[v], v) for v in inputs),
        tuple((name, 2 + number) for number, name in enumerate(receives)),
        tuple((name, 2 + len(receives) + number) for number, name in enumerate(sends)),
        0,
    )


class _PartInterface:
    """The interface of some processes of a network.

    Attributes:
        used, written: global and other variables.
        places: of processes whose locations are used.
        channels: those over which they may send, and receive, by their names.
    """

    def __init__(self, network: Network, members: set[int], known: Known) -> None:
        self.members = members
        outermost = [e for number in members for e in process_expressions(network.processes[number])]
        nodes = [node for expression in with_bodies(outermost) for node in walk(expression)]
        self.used = {node.variable for node in nodes if isinstance(node, Reference)}
        self.written = written_variables(outermost)
        self.places = {node.process for node in nodes if isinstance(node, LocationTest)}
        self.channels: dict[Direction, dict[str, Expression]] = {Direction.SEND: {}, Direction.RECEIVE: {}}
        for number in members:
            for edge in network.processes[number].edges:
                if edge.synchronisation is not None:
                    place = fold_place(edge.synchronisation.channel, known)
                    self.channels[edge.synchronisation.direction] |= _possible(place)


def _chosen(network: Network, names: Sequence[str]) -> set[int]:
    known = {name for process in network.processes for name in (process.name, process.template)}
    for name in names:
        if name not in known:
            processes = ", ".join(process.name for process in network.processes[:20])
            raise UsageError(f"there is no process {name!r}", did_you_mean(name, known) or f"there are: {processes}")
    wanted = set(names)
    chosen = {n for n, process in enumerate(network.processes) if wanted & {process.name, process.template}}
    if len(chosen) == len(network.processes):
        raise UsageError("these are all processes of the model", "leave out --processes")
    return chosen


def _check_separable(network: Network, ours: _PartInterface, theirs: _PartInterface) -> None:
    """Raises UsageError for constructs that cannot be divided between two networks."""
    foreign = sorted(network.processes[n].name for n in ours.places & theirs.members)
    if foreign:
        raise UsageError(
            f"a process of the part asks for the location of {foreign[0]}, which is not in it",
            "take it into the part, or let it show its location by a variable",
        )
    for clock in network.variables:
        if ClockType() in kinds_of_slots(clock.type) and clock in ours.used and clock in theirs.used:
            raise UsageError(f"the clock {clock.name} is used inside and outside the part", "give each a clock")
    ends = [*ours.channels[Direction.SEND].items(), *ours.channels[Direction.RECEIVE].items()]
    others = theirs.channels[Direction.SEND].keys() | theirs.channels[Direction.RECEIVE].keys()
    for name, place in ends:
        if name in others and not (isinstance(place.type, ChannelType) and place.type.broadcast):
            raise UsageError(
                f"the channel {name} leads out of the part and is not a broadcast channel",
                "a sender does not know whether a process outside receives: take both ends into the part",
            )


def _possible(place: Expression) -> dict[str, Expression]:
    """The channels that a place may denote, by their names."""
    slots = (pair for root in roots(place) for pair in _slots(Reference(root), root.name))
    return {name: slot for name, slot in slots if _may_be(place, slot)}


def _may_be(place: Expression, slot: Expression) -> bool:
    match place, slot:
        case Index(base, Constant(wanted)), Index(inner, Constant(number)):
            return wanted == number and _may_be(base, inner)
        case (Index(base), Index(inner)) | (Field(base), Field(inner)):
            return _may_be(base, inner)
        case _:
            return True


def _slots(place: Expression, name: str) -> Iterator[tuple[str, Expression]]:
    match place.type:
        case ArrayType() as array:
            for index in range(array.low, array.low + array.size):
                yield from _slots(Index(place, Constant(index), array.element), f"{name}[{index}]")
        case RecordType() as record:
            for field, type_ in record.fields:
                yield from _slots(Field(place, field, type_), f"{name}.{field}")
        case _:
            yield name, place


def _is_data(variable: Variable) -> bool:
    return not any(isinstance(kind, ChannelType | ClockType) for kind in kinds_of_slots(variable.type))


def _used(network: Network, ours: _PartInterface) -> Iterator[Variable]:
    """The variables of the part. Others are left out, but for channels: parameters may stand for them."""
    for variable in network.variables:
        if variable in ours.used or not _is_data(variable):
            yield variable


def _is_seen(network: Network, signal: Signal, ours: _PartInterface) -> bool:
    nodes = [node for expression in with_bodies([signal.expression]) for node in walk(expression)]
    observed_processes = {node.process for node in nodes if isinstance(node, LocationTest)}
    read = {node.variable for node in nodes if isinstance(node, Reference)} & {*network.all_variables()}
    return observed_processes <= ours.members and read <= ours.used


def _with_stubs(network: Network, inside: set[int]) -> Iterator[Process]:
    for number, process in enumerate(network.processes):
        yield process if number in inside else Process(process.name, process.template, (Location("elsewhere"),), ())


def _edge(channel: Expression, direction: Direction, guard: Expression | None, updates: Sequence[Expression]) -> Edge:
    more = (_reset(),) if direction is Direction.SEND else ()
    return Edge(0, 0, guard=guard, synchronisation=Synchronisation(channel, direction), updates=(*updates, *more))


def _assign(target: Variable, value: Variable) -> Expression:
    return Assign(Reference(target), Reference(value), target.type)


def _never() -> Expression:
    """A guard that no compiler takes for false."""
    return Binary(BinaryOperator.EQUAL, Reference(_NEVER), Constant(1), BOOL)


def _reset() -> Expression:
    return Assign(Reference(_NEVER), Constant(0), _NEVER.type)
