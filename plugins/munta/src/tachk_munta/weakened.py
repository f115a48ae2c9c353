"""Networks that can do all that the model can, and perhaps more, without what Munta has no words for.

What is never reached in such a network is never reached in the model: it can wait longer, and do the same otherwise.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from tachk.api.plugin import (
    ArrayType,
    ChannelType,
    Edge,
    Expression,
    Field,
    Index,
    Location,
    Network,
    RecordType,
    Reference,
    Span,
    Type,
    UnsupportedError,
    Variable,
    both,
    conjuncts,
    prepare,
)
from tachk_munta.actions import constant_invariant
from tachk_munta.cases import CaseFinder, case_finder


@dataclass(frozen=True, slots=True)
class Weakening:
    """A restriction of the model that is given up.

    Attributes:
        text: a sentence without a full stop.
        of_time: an invariant, so that a state may be stuck in the model that can wait in the network.
    """

    text: str
    span: Span
    of_time: bool


def weakened(network: Network) -> tuple[Network, tuple[Weakening, ...]]:
    """The network without urgent channels, and without those parts of invariants that depend on variables."""
    finder = case_finder(prepare(network))
    changed = {v: replace(v, type=_patient(v.type)) for v in network.all_variables() if _patient(v.type) != v.type}
    found = [Weakening(f"`{v.name}` is taken to be an ordinary channel", v.span, False) for v in changed]
    processes = []
    for process in network.processes:
        locations = tuple(_loosened(location, finder, found.append) for location in process.locations)
        edges = tuple(_renamed(edge, changed) for edge in process.edges)
        own = tuple(changed.get(v, v) for v in process.variables)
        processes.append(replace(process, locations=locations, edges=edges, variables=own))
    variables = tuple(changed.get(v, v) for v in network.variables)
    return replace(network, processes=tuple(processes), variables=variables), tuple(found)


def _patient(type_: Type) -> Type:
    """The type with ordinary channels for urgent ones."""
    match type_:
        case ChannelType():
            return replace(type_, urgent=False)
        case ArrayType(element):
            return replace(type_, element=_patient(element))
        case RecordType(_, fields):
            return replace(type_, fields=tuple((name, _patient(field)) for name, field in fields))
        case _:
            return type_


def _renamed(edge: Edge, changed: dict[Variable, Variable]) -> Edge:
    synchronisation = edge.synchronisation
    if synchronisation is None or not changed:
        return edge
    return replace(edge, synchronisation=replace(synchronisation, channel=_place(synchronisation.channel, changed)))


def _place(place: Expression, changed: dict[Variable, Variable]) -> Expression:
    match place:
        case Reference(variable):
            return replace(place, variable=changed.get(variable, variable))
        case Index(base) | Field(base):
            return replace(place, base=_place(base, changed), type=_patient(place.type))
        case _:
            return place


def _loosened(location: Location, finder: CaseFinder, report: Callable[[Weakening], None]) -> Location:
    if location.invariant is None:
        return location
    rest: Expression | None = None
    for part in conjuncts(location.invariant):
        try:
            constant_invariant(part, part.span, finder)
        except UnsupportedError:
            report(Weakening(f"this part of the invariant of `{location.name}` is left out", part.span, True))
        else:
            rest = both(rest, part)
    return replace(location, invariant=rest)
