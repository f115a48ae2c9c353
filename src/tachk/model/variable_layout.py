"""The layout of the variables of a network in a state: the numbering of slots, clocks and channels.

Slots are numbered in the order of `Network.all_variables`, clocks from 1 and channels from 0 in the same order. The
slot of a clock or channel holds its number.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from tachk.base.operators import CONSTANT_HIGH, CONSTANT_LOW
from tachk.base.records import dataclass
from tachk.model.expressions import Variable
from tachk.model.network import Network
from tachk.model.types import (
    ArrayType,
    BoolType,
    ChannelType,
    ClockType,
    IntType,
    RecordType,
    ScalarType,
    Type,
    VoidType,
    bounds,
    leaves,
)


@dataclass(frozen=True, slots=True)
class VariableLayout:
    """The numbers of the slots in which a network keeps its values.

    Attributes:
        first: the number of a variable's first slot.
        names: one for each slot: ``x``, ``P.a[2].b``.
        types: the leaf type of each slot.
        ranges: smallest and largest value of each slot; a clock or channel is pinned to its number.
        initial: the content of each slot in the initial state.
        meta: whether the slot belongs to a meta variable.
        clock_slots: the slot of each clock; entry i belongs to clock number i + 1.
        channel_slots: the slot of each channel; entry i belongs to channel number i.
        starts: what each clock shows at first; entry i belongs to clock number i + 1.
    """

    first: Mapping[Variable, int]
    names: tuple[str, ...]
    types: tuple[Type, ...]
    ranges: tuple[tuple[int, int], ...]
    initial: tuple[int, ...]
    meta: tuple[bool, ...]
    clock_slots: tuple[int, ...]
    channel_slots: tuple[int, ...]
    starts: tuple[int, ...]


def variable_layout(network: Network) -> VariableLayout:
    """The layout of a network's state."""
    first: dict[Variable, int] = {}
    names: list[str] = []
    types: list[Type] = []
    ranges: list[tuple[int, int]] = []
    initial: list[int] = []
    meta: list[bool] = []
    clocks: list[int] = []
    channels: list[int] = []
    starts: list[int] = []
    for variable in network.all_variables():
        first[variable] = len(names)
        given = variable.initial
        for position, (path, leaf) in enumerate(leaves(variable.type)):
            slot = len(names)
            match leaf:
                case ClockType():
                    clocks.append(slot)
                    value = len(clocks)
                    starts.append(given[position] if given else 0)
                    ranges.append((value, value))
                case ChannelType():
                    value = len(channels)
                    channels.append(slot)
                    ranges.append((value, value))
                case IntType() | BoolType() | ScalarType():
                    value = given[position] if given else default_value(leaf)
                    ranges.append(bounds(leaf))
                case _:
                    raise TypeError(f"{leaf} is not the type of a slot")
            names.append(variable.name + path)
            types.append(leaf)
            initial.append(value)
            meta.append(network.resets(variable))
    return VariableLayout(
        first,
        tuple(names),
        tuple(types),
        tuple(ranges),
        tuple(initial),
        tuple(meta),
        tuple(clocks),
        tuple(channels),
        tuple(starts),
    )


def begun_clocks(network: Network) -> Iterator[Variable]:
    """The variables with a clock that does not begin with 0."""
    for variable in network.all_variables():
        slots = zip(leaves(variable.type), variable.initial, strict=False)
        if any(value != 0 and isinstance(leaf, ClockType) for (_, leaf), value in slots):
            yield variable


def slot_bounds(leaf: Type) -> tuple[int, int]:
    """The legal range of a slot; raises TypeError for types that have none."""
    if isinstance(leaf, IntType | BoolType | ScalarType):
        return bounds(leaf)
    raise TypeError(f"{leaf} has no range")


def default_value(leaf: Type) -> int:
    """The value of an uninitialised slot: 0, or the lower bound where 0 is outside the range."""
    if isinstance(leaf, IntType) and not leaf.low <= 0 <= leaf.high:
        return leaf.low
    return 0


def default_values(type_: Type) -> tuple[int, ...]:
    """The content of an uninitialised variable; clocks and channels get 0 as a placeholder."""
    match type_:
        case ArrayType():
            return default_values(type_.element) * type_.size
        case RecordType():
            return tuple(slot for _, field in type_.fields for slot in default_values(field))
        case VoidType():
            return ()
        case IntType() | BoolType() | ScalarType() | ClockType() | ChannelType():
            return (default_value(type_),)


def slot_range(type_: Type) -> tuple[int, int]:
    """The legal values of a slot; numbers of clocks and channels in a frame are not limited."""
    if isinstance(type_, IntType | BoolType | ScalarType):
        return bounds(type_)
    return CONSTANT_LOW, CONSTANT_HIGH
