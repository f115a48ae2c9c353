"""The influence of the order of processes: the receivers of a broadcast update one after the other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tachk.analysis.fold import Known, fold, fold_place
from tachk.base.records import dataclass
from tachk.base.words import Direction
from tachk.engine.symmetry.index_types import AsymmetryReason
from tachk.model.expressions import (
    Assign,
    Constant,
    Expression,
    Field,
    Increment,
    Index,
    Reference,
    Variable,
    VariableKind,
)
from tachk.model.network import Edge, Network
from tachk.model.traversal import (
    called_functions,
    children,
    roots,
    walk,
    with_bodies,
    written_variables,
)
from tachk.model.types import ChannelType

Slot = tuple[Variable, int | None]
"""A variable, and which element of it if it is an array and that is known."""


@dataclass(frozen=True, slots=True)
class _BroadcastReceiver:
    """An edge that receives a broadcast, with the effects of its updates.

    Attributes:
        channel: what it listens to.
        sets: slots that are set to a constant, with it.
    """

    process: int
    edge: Edge
    channel: Slot
    reads: frozenset[Slot]
    writes: frozenset[Slot]
    sets: frozenset[tuple[Slot, int]]


def order_matters(network: Network, known: Known, members: Sequence[tuple[int, ...]]) -> AsymmetryReason | None:
    """The reason why the order of some members of a group, among themselves and with others, matters; or None."""
    # Any two members behave to each other, or to another process, as the first one and some member do.
    everybody = {number for block in members for number in block}
    between = [n for n in range(min(everybody), max(everybody)) if n not in everybody]
    others = [*(number for block in members[1:] for number in block), *between]
    own = [each for number in members[0] for each in _receivers(network, known, number)]
    foreign = [each for number in others for each in _receivers(network, known, number)] if own else []
    for number, one in enumerate(own):
        for other in (*own[number + 1 :], *foreign):
            if one.process != other.process and _may_be(one.channel, other.channel) and not _commute(one, other):
                reason = "the updates of two of them that receive the same broadcast depend on their order"
                return AsymmetryReason(reason, other.edge.spans[0])
    return None


def _receivers(network: Network, known: Known, process: int) -> Iterator[_BroadcastReceiver]:
    for edge in network.processes[process].edges:
        if edge.synchronisation is None or edge.synchronisation.direction is Direction.SEND:
            continue
        channel = fold_place(edge.synchronisation.channel, known)
        if not isinstance(channel.type, ChannelType) or not channel.type.broadcast:
            continue
        updates = [fold(update, known) for update in edge.updates]
        sets = [_constant_write(update) for update in updates]
        if all(each is not None for each in sets):
            plain = frozenset(each for each in sets if each is not None)
            indices = frozenset(slot for update in updates for slot in _read_in_place(update))
            writes = frozenset(slot for slot, _ in plain)
            yield _BroadcastReceiver(process, edge, _slot(channel), indices, writes, plain)
            continue
        mentioned = (slot for expression in with_bodies(updates) for slot in _mentioned(expression, known))
        reads = frozenset(slot for slot in mentioned if slot[0].kind is not VariableKind.FRAME)
        written = frozenset(slot for expression in updates for slot in _written(expression))
        # Writes of functions through references and to globals stand somewhere in it.
        called = called_functions(updates)
        hidden = (
            {(v, None) for v in written_variables(updates) if v.kind is not VariableKind.FRAME} if called else set()
        )
        yield _BroadcastReceiver(process, edge, _slot(channel), reads, written | hidden, frozenset())


def _commute(one: _BroadcastReceiver, other: _BroadcastReceiver) -> bool:
    return not (
        _meet(one.writes, other.reads)
        or _meet(one.reads, other.writes)
        or any(
            _may_be(slot, another)
            for slot in one.writes
            for another in other.writes
            if not _same_constant(one, other, slot, another)
        )
    )


def _same_constant(one: _BroadcastReceiver, other: _BroadcastReceiver, slot: Slot, another: Slot) -> bool:
    """True if both only set the same slot to the same constant."""
    values = {value for where, value in one.sets if where == slot} | {v for where, v in other.sets if where == slot}
    known = any(where == slot for where, _ in one.sets) and any(where == slot for where, _ in other.sets)
    array = one.sets and slot[1] is None and not _is_scalar(slot[0])
    return slot == another and known and not array and len(values) == 1


def _is_scalar(variable: Variable) -> bool:
    return not hasattr(variable.type, "element") and not hasattr(variable.type, "fields")


def _meet(some: frozenset[Slot], others: frozenset[Slot]) -> bool:
    return any(_may_be(one, other) for one in some for other in others)


def _may_be(one: Slot, other: Slot) -> bool:
    return one[0] is other[0] and (one[1] is None or other[1] is None or one[1] == other[1])


def _slot(place: Expression) -> Slot:
    """The variable of a place, and the outermost index if it is a constant."""
    outermost: int | None = None
    while isinstance(place, Index | Field):
        outermost = place.index.value if isinstance(place, Index) and isinstance(place.index, Constant) else None
        place = place.base
    if isinstance(place, Reference):
        return place.variable, outermost
    return next(iter(roots(place))), None


def _constant_write(update: Expression) -> tuple[Slot, int] | None:
    match update:
        case Assign(target, Constant(value), _, None) if isinstance(target, Reference | Index | Field):
            return _slot(target), value
        case _:
            return None


def _read_in_place(update: Expression) -> Iterator[Slot]:
    """The variables read to find the place of a write."""
    place = update.target if isinstance(update, Assign | Increment) else update
    while isinstance(place, Index | Field):
        if isinstance(place, Index):
            yield from ((node.variable, None) for node in walk(place.index) if isinstance(node, Reference))
        place = place.base


def _mentioned(expression: Expression, known: Known) -> Iterator[Slot]:
    pending = [fold(expression, known)]
    while pending:
        part = pending.pop()
        if isinstance(part, Reference):
            yield part.variable, None
        elif isinstance(part, Index | Field):
            yield _slot(part)
            while isinstance(part, Index | Field):
                if isinstance(part, Index):
                    pending.append(part.index)
                part = part.base
            if not isinstance(part, Reference):
                pending.append(part)
        else:
            pending.extend(children(part))


def _written(update: Expression) -> Iterator[Slot]:
    for node in walk(update):
        if isinstance(node, Assign | Increment):
            if isinstance(node.target, Reference | Index | Field):
                yield _slot(node.target)
            else:
                yield from ((variable, None) for variable in roots(node.target))
