"""The network that follows a recording from a state on in which it may be already.

Every process sleeps until one that is added wakes them all. What is added sets the clocks before: it sets them back
to 0 one by one, that first which has run longest, when they differ by what they differ in the state. When all of them
are as late as there, it gives the variables their values, and all processes are where they are. So the runs behind that
are the runs from the state on, and nothing but a network is needed to have them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tachk.base.records import replace
from tachk.base.words import Direction
from tachk.meaning.dbm import INFINITY, LESS_EQUAL_ZERO, Zone, bound_value, is_strict
from tachk.model.builder import NetworkBuilder, ProcessBuilder, Term
from tachk.model.expressions import Reference, Variable, VariableKind
from tachk.model.network import Edge, Location, Network, Process, Synchronisation
from tachk.model.types import ArrayType, ChannelType, ClockType, RecordType, Type, clock_count
from tachk.model.variable_layout import default_values
from tachk.recordings.conformance.rejection import FinalState
from tachk.recordings.conformance.trace_product import TraceProduct

_PRODUCT, _SETTER = "recording.", "resumed."
"""So the names of variables begin that belong to the processes which follow a recording, and to what is added here."""


def resumed(product: TraceProduct, before: TraceProduct, end: FinalState) -> TraceProduct | None:
    """The network that follows what is left of a recording, from the state on in which a run along its beginning ends.

    Args:
        following: follows what is left, with processes that are those of `before` one by one.
        before: follows what the run goes along with.
        end: of that run.

    None where that state has no clock valuation, or clocks of which it is not known which has run longer.
    """
    if len(product.network.processes) != len(before.network.processes) or not end.zones:
        return None
    clocks = [_renamed(clock, before, product) for clock in _clocks(before.network)]
    zone = end.zones[0]
    order = _oldest_first(zone)
    if order is None:
        return None
    builder = NetworkBuilder(_SETTER, VariableKind.GLOBAL)
    wake = builder.channel("wake", broadcast=True)
    awake = builder.boolean("awake", False)
    processes = [
        _sleeping(process, location, wake)
        for process, location in zip(product.network.processes, end.locations, strict=True)
    ]
    values = [*_values(product, before, end), awake.assign(True)]
    processes.append(_setter(clocks, zone, order, wake, values))
    network = replace(
        product.network,
        processes=tuple(processes),
        variables=(*product.network.variables, *builder.variables),
        hidden=(*product.network.hidden, processes[-1].name),
    )
    return replace(product, network=network, done=(Term(product.done) & awake).expression)


def _sleeping(process: Process, location: int, wake: Term) -> Process:
    """The process with one more location, where it waits for the beginning."""
    asleep = len(process.locations)
    waking = Edge(asleep, location, synchronisation=Synchronisation(wake.expression, Direction.RECEIVE))
    locations = (*process.locations, Location("asleep"))
    return replace(process, locations=locations, edges=(*process.edges, waking), initial=asleep)


def _setter(clocks: Sequence[Term], zone: Zone, order: Sequence[int], wake: Term, values: Sequence[Term]) -> Process:
    """The process that sets clocks and variables, and wakes the others."""
    process = ProcessBuilder("setter.", VariableKind.LOCAL, name="setter")
    here = process.location("setting")
    for place, clock in enumerate(order):
        there = process.location("setting")
        guard = _joined(
            bound
            for older in order[:place]
            for bound in _within(clocks[older - 1], zone[clock, older], zone[older, clock])
        )
        process.edge(here, there, guard=guard, updates=[clocks[clock - 1].assign(0)])
        here = there
    guard = _joined(bound for clock in order for bound in _within(clocks[clock - 1], zone[0, clock], zone[clock, 0]))
    process.edge(here, process.location("awake"), guard=guard, send=wake, updates=values)
    return process.build()


def _within(clock: Term, lower: int, upper: int) -> Iterator[Term]:
    """The bounds of a clock, of which the raw bounds of its negative value and of its value are given."""
    if lower != LESS_EQUAL_ZERO:
        least = -bound_value(lower)
        yield clock > least if is_strict(lower) else clock >= least
    if upper < INFINITY:
        yield clock < bound_value(upper) if is_strict(upper) else clock <= bound_value(upper)


def _joined(bounds: Iterator[Term]) -> Term | None:
    whole = next(bounds, None)
    for bound in bounds:
        assert whole is not None
        whole = whole & bound
    return whole


def _oldest_first(zone: Zone) -> list[int] | None:
    """The clocks, so that none has run longer than one before it; None if the zone does not say."""
    clocks = range(1, zone.dimension)
    order = sorted(clocks, key=lambda x: sum(zone[y, x] <= LESS_EQUAL_ZERO for y in clocks), reverse=True)
    known = all(zone[y, x] <= LESS_EQUAL_ZERO for place, x in enumerate(order) for y in order[place + 1 :])
    return order if known else None


def _renamed(clock: Term, before: TraceProduct, product: TraceProduct) -> Term:
    """A clock of the one network in the other: they share all but the one that nothing resets."""
    own = isinstance(clock.expression, Reference) and clock.expression.variable is before.now
    return Term(Reference(product.now)) if own else clock


def _clocks(network: Network) -> Iterator[Term]:
    """By their numbers."""
    for variable in network.all_variables():
        if clock_count(variable.type):
            yield from (slot for slot, leaf in _slots(Term(Reference(variable))) if isinstance(leaf, ClockType))


def _slots(whole: Term) -> Iterator[tuple[Term, Type]]:
    """The slots of a variable in their order, with their types."""
    match whole.expression.type:
        case ArrayType() as type_:
            for index in range(type_.low, type_.low + type_.size):
                yield from _slots(whole[index])
        case RecordType() as type_:
            for name, _ in type_.fields:
                yield from _slots(whole.field(name))
        case type_:
            yield whole, type_


def _values(product: TraceProduct, before: TraceProduct, end: FinalState) -> list[Term]:
    """The assignments of the values of the variables. The positions begin anew."""
    own = {variable.name: variable for variable in product.network.variables if variable.name.startswith(_PRODUCT)}
    positions = {id(position) for position in before.positions}
    found: list[Term] = []
    for variable, values in end.values.items():
        if id(variable) in positions or variable in before.tables or before.network.resets(variable):
            continue
        if variable.name.startswith(_SETTER):
            continue
        target = own.get(variable.name) if variable.name.startswith(_PRODUCT) else variable
        if target is not None:
            found += _assignments(target, values)
    return found


def _assignments(variable: Variable, values: Sequence[int]) -> Iterator[Term]:
    """The assignments that let a variable begin with other values."""
    initial = variable.initial or default_values(variable.type)
    if tuple(initial) == tuple(values):
        return
    for (slot, leaf), value, first in zip(_slots(Term(Reference(variable))), values, initial, strict=True):
        if value != first and not isinstance(leaf, ClockType | ChannelType):
            yield slot.assign(value)
