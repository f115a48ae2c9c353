"""Columns of a trace that are recorded for each state of a run."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import islice

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.base.records import dataclass
from tachk.model.expressions import Constant, Expression, Field, Index, LocationTest, Reference
from tachk.model.floating import DOUBLE, contains_double, value_type
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
    leaves,
    slot_count,
)

_LOCATION = re.compile(r"(?P<process>.+)\.(?P<location>[A-Za-z_]\w*)")


@dataclass(frozen=True, slots=True)
class Column:
    """Attributes:
    value: an expression, or the number of a slot of the program.
    truth: whether its values are truth values.
    labels: of a column of texts, those that its values stand for.
    floating: whether its values are floating point numbers, observed as their bits.
    """

    name: str
    value: Expression | int
    truth: bool = False
    labels: tuple[str, ...] = ()
    floating: bool = False


def all_columns(network: Network) -> tuple[Column, ...]:
    """The signals of a model, then the location of each process, then the variables that can change.

    The location of a process that has only one is there, too: a formula on the run may be about it.
    """
    return (*_signals(network), *_locations(network), *_variables(network))


def changing_columns(network: Network) -> tuple[Column, ...]:
    """All columns but the locations of processes that have only one."""
    return tuple(column for column in all_columns(network) if len(column.labels) != 1)


def chosen_columns(network: Network, names: Collection[str]) -> tuple[Column, ...]:
    """The columns of these names, among them truth values called ``P.location``. Raises UsageError."""
    known = {column.name: column for column in reversed(all_columns(network))}
    result = []
    for name in names:
        column = known.get(name) or _at_location(network, name)
        if column is None:
            raise UsageError(
                f"there is no signal, process, location or variable {name!r} to record",
                did_you_mean(name, [*known, *_places(network)])
                or f"there are: {', '.join([*list(reversed(known))[:20], *islice(_places(network), 1)])}",
            )
        result.append(column)
    return tuple(result)


def columns_for(network: Network, chosen: Collection[str], needed: Iterable[str]) -> tuple[Column, ...]:
    """The chosen columns, or all if none is, and those that are needed besides. Raises UsageError."""
    columns = chosen_columns(network, chosen) if chosen else all_columns(network)
    known = {column.name for column in columns}
    return (*columns, *chosen_columns(network, sorted(set(needed) - known)))


def observed(columns: Sequence[Column]) -> list[Expression | int]:
    return [column.value for column in columns]


def _signals(network: Network) -> Iterator[Column]:
    for signal in network.signals:
        if not isinstance(signal.expression.type, ClockType):
            type_ = signal.expression.type
            yield Column(signal.name, signal.expression, isinstance(type_, BoolType), floating=type_ == DOUBLE)


def _locations(network: Network) -> Iterator[Column]:
    for number, process in enumerate(network.processes):
        yield Column(process.name, number, labels=tuple(place.name for place in process.locations))


def _variables(network: Network) -> Iterator[Column]:
    slot = len(network.processes)
    for variable in network.all_variables():
        doubles = {} if network.resets(variable) else dict(_doubles(variable.name, Reference(variable)))
        for place, (path, type_) in enumerate(leaves(variable.type)):
            if place in doubles:
                name, value = doubles[place]
                yield Column(name, value, floating=True)
            elif _is_recorded(type_) and not _is_half(doubles, place) and not network.resets(variable):
                yield Column(variable.name + path, slot, isinstance(type_, BoolType))
            slot += 1


def _doubles(name: str, place: Expression, first: int = 0) -> Iterator[tuple[int, tuple[str, Expression]]]:
    """The floating point numbers in a place: at which of its slots each begins, its name and the expression."""
    match place.type:
        case RecordType() as record if record == DOUBLE:
            yield first, (name, place)
        case RecordType(_, fields) as record:
            for field, type_ in fields:
                yield from _doubles(
                    f"{name}.{field}", Field(place, field, value_type(type_)), first + record.offset(field)
                )
        case ArrayType(element) as array:
            for number in range(array.size if contains_double(element) else 0):
                index = number + array.low
                inner = Index(place, Constant(index), value_type(element))
                yield from _doubles(f"{name}[{index}]", inner, first + number * slot_count(element))
        case _:
            return


def _is_half(doubles: Mapping[int, object], place: int) -> bool:
    """True if a slot is the second half of a floating point number."""
    return place - 1 in doubles


def _is_recorded(type_: Type) -> bool:
    match type_:
        case IntType(low, high):
            return low < high
        case BoolType() | ScalarType():
            return True
        case _:
            assert isinstance(type_, ClockType | ChannelType)
            return False


def _places(network: Network) -> Iterator[str]:
    for process in network.processes:
        yield from (f"{process.name}.{location.name}" for location in process.locations)


def _at_location(network: Network, name: str) -> Column | None:
    match = _LOCATION.fullmatch(name)
    if match is None:
        return None
    for number, process in enumerate(network.processes):
        if process.name != match["process"]:
            continue
        for place, location in enumerate(process.locations):
            if location.name == match["location"]:
                return Column(name, LocationTest(number, place), truth=True)
    return None
