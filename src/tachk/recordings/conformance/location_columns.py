"""Locations that recorded events contain: the model keeps them in variables, which hold them at the end of a step.

While a step updates its variables its processes are still where they were, and behind it what is `meta` is lost. So
each edge of a process whose locations a column tests also sets a variable, which says where the edge leads.
"""

from __future__ import annotations

from collections.abc import Mapping

from tachk.base.operators import BinaryOperator
from tachk.base.records import replace
from tachk.model.expressions import (
    BOOL,
    Assign,
    Binary,
    Constant,
    Expression,
    LocationTest,
    Reference,
    Variable,
    VariableKind,
)
from tachk.model.network import Network, Process
from tachk.model.recording import RecordingMap
from tachk.model.substitution import with_parts
from tachk.model.traversal import walk
from tachk.model.types import IntType


def with_location_variables(network: Network, mapping: RecordingMap) -> tuple[Network, RecordingMap]:
    """The network with a variable for each process whose locations a column tests, and the mapping that reads it."""
    columns = [expression for visible in mapping.visible for _, expression in visible.columns]
    tested = {node.process for column in columns for node in walk(column) if isinstance(node, LocationTest)}
    if not tested:
        return network, mapping
    places = {number: _place_of(network.processes[number]) for number in sorted(tested)}
    processes = tuple(
        _with_place_set(process, places[number]) if number in places else process
        for number, process in enumerate(network.processes)
    )
    visible = tuple(
        replace(each, columns=tuple((name, _with_places(expression, places)) for name, expression in each.columns))
        for each in mapping.visible
    )
    variables = (*network.variables, *places.values())
    return replace(network, processes=processes, variables=variables), replace(mapping, visible=visible)


def _place_of(process: Process) -> Variable:
    type_ = IntType(0, len(process.locations) - 1)
    return Variable(f"location of {process.name}", type_, VariableKind.GLOBAL, (process.initial,))


def _with_place_set(process: Process, place: Variable) -> Process:
    """The process whose edges say where they lead."""
    where = Reference(place)
    return replace(
        process,
        edges=tuple(
            replace(edge, updates=(*edge.updates, Assign(where, Constant(edge.target, place.type), place.type)))
            for edge in process.edges
        ),
    )


def _with_places(column: Expression, places: Mapping[int, Variable]) -> Expression:
    if isinstance(column, LocationTest):
        place = places[column.process]
        there = Constant(column.location, place.type, column.span)
        return Binary(BinaryOperator.EQUAL, Reference(place, span=column.span), there, BOOL, column.span)
    return with_parts(column, lambda part: _with_places(part, places))
