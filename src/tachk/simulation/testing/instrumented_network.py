"""A network that notes what events contain, for the set of states that goes along with a system.

What a `recording { ... }` replaces is the environment here: it stays in the network, and what it sends are the inputs
of the system (Larsen, Mikucionis, Nielsen, "Online testing of real-time systems using Uppaal", 2004: a closed network
of the implementation and its environment). Each visible step copies the columns of its event into variables, at its
end: a process that receives broadcasts last does so, or the receiver of a step of two.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass, replace
from tachk.base.words import Direction
from tachk.engine.compiler.lower import lower
from tachk.engine.compiler.program import Program
from tachk.engine.state_estimate import VisibleChannel
from tachk.model.builder import NetworkBuilder, ProcessBuilder, Term
from tachk.model.expressions import (
    BOOL,
    Assign,
    Binary,
    Conditional,
    Constant,
    Expression,
    Index,
    Reference,
    Variable,
    VariableKind,
)
from tachk.model.network import Edge, Network, Process
from tachk.model.query import Query
from tachk.model.recording import RecordingMap, VisibleEvents
from tachk.model.traversal import walk, written_variables
from tachk.recordings.conformance.event_streams import (
    channel_variable,
    element,
    is_output,
)
from tachk.simulation.testing.event_checks import check_visible
from tachk.simulation.testing.event_columns import (
    channel_indices,
    index_cases,
    is_broadcast,
    noted_variables,
    noting_updates,
)
from tachk.transform.observed import observed

LONGEST = 1 << 24
"""Units of the model: no moment is so far from the present one."""


@dataclass(frozen=True, slots=True)
class ObservedStream:
    """Events that are seen in the order in which they happen.

    Attributes:
        common: the values of the indices that they have in common.
        is_input: the environment sends them.
    """

    visible: VisibleEvents
    common: Mapping[Variable, int]
    is_input: bool


@dataclass(frozen=True, slots=True)
class InstrumentedNetwork:
    """Attributes:
    network: with the clock of the present moment first, and with the variables for columns.
    streams: by number.
    channels: the visible channels of the program.
    largest_constant: with which a clock is compared, at least 1; in units of the model.
    edges: of the system: the numbers of the process and of its edge.
    marks: for each edge of the program its place among them; None for edges of the environment.
    reaching: the edges of the program that are possible where a query is decided; none without a query.
    """

    network: Network
    program: Program
    streams: tuple[ObservedStream, ...]
    channels: tuple[VisibleChannel, ...]
    largest_constant: int
    edges: tuple[tuple[int, int], ...]
    marks: tuple[int | None, ...]
    reaching: tuple[int, ...]


def instrumented_network(network: Network, mapping: RecordingMap, query: Query | None = None) -> InstrumentedNetwork:
    """The network with what events contain; locations in columns are variables already.

    Args:
        query: a process watches whether a state is reached that decides it, which has to have a `target`.

    Raises UsageError for a model that cannot be followed while it runs, UnsupportedError.
    """
    if network.has_priorities:
        raise UsageError("a model with priorities cannot test a system", "leave out the priorities")
    for visible in mapping.visible:
        check_visible(network, mapping, visible)
    builder = NetworkBuilder("observed.", VariableKind.GLOBAL)
    clock = builder.clock("now")
    present = _present(clock)
    noted = [noted_variables(builder, number, visible) for number, visible in enumerate(mapping.visible)]
    watched = observed(network, None if query is None else query.observer)
    processes = list(watched.network.processes)
    added = [present]
    for number, (visible, variables) in enumerate(zip(mapping.visible, noted, strict=True)):
        if is_broadcast(visible):
            added.append(_noting_process(number, visible, variables))
        else:
            processes = [_noting_receiver(process, visible, variables) for process in processes]
    if query is not None:
        assert query.target is not None
        added.append(_watching_process(query.target))
    whole = replace(
        watched.network,
        processes=(*processes, *added),
        variables=(*builder.variables, *watched.network.variables),
        signals=(),
        hidden=(*watched.network.hidden, *(process.name for process in added)),
    )
    program, _ = lower(whole)
    streams, channels = _streams(network, mapping, program, noted)
    system = mapping.modelled(network)
    edges = tuple((n, number) for n in system for number in range(len(network.processes[n].edges)))
    places = {edge: place for place, edge in enumerate(edges)}
    places |= {copy: places[copy[0], first] for copy, first in watched.copies.items() if (copy[0], first) in places}
    marks = tuple(places.get((edge.process, edge.edge)) for edge in program.edges)
    watching = None if query is None else len(whole.processes) - 1
    reaching = tuple(number for number, edge in enumerate(program.edges) if edge.process == watching)
    return InstrumentedNetwork(whole, program, streams, channels, _largest_constant(program), edges, marks, reaching)


def _largest_constant(program: Program) -> int:
    """With which a clock is compared, but for that of the present moment."""
    bounds = (
        bound
        for locations in program.locations
        for location in locations
        for bound in (*location.lower, *location.upper)
    )
    return max((constant for clock, constant in bounds if clock != 1), default=1) or 1


def _present(clock: Term) -> Process:
    """Keeps the clock of the present moment among those that count."""
    process = ProcessBuilder("present.", VariableKind.LOCAL, name="present")
    here = process.location("present", clock <= LONGEST)
    process.edge(here, here, guard=clock >= LONGEST)
    return process.build()


def _watching_process(target: Expression) -> Process:
    """An edge that is possible where the target holds, and changes nothing."""
    process = ProcessBuilder("watching.", VariableKind.LOCAL, name="watching")
    here = process.location("watching")
    process.edge(here, here, guard=Term(target))
    built = process.build()
    return replace(built, locations=tuple(replace(location, observes=True) for location in built.locations))


def _noting_process(number: int, visible: VisibleEvents, noted: Mapping[str, Term]) -> Process:
    process = ProcessBuilder("noting.", VariableKind.LOCAL, name=f"noting[{number}]")
    here = process.location("noting")
    for case in index_cases(visible):
        indices = {variable: Constant(value) for variable, value in case.items()}
        channel = Term(element(visible.channel, channel_indices(visible, indices)))
        process.edge(here, here, receive=channel, updates=list(noting_updates(visible, noted, indices)))
    return process.build()


def _noting_receiver(process: Process, visible: VisibleEvents, noted: Mapping[str, Term]) -> Process:
    """The process that notes the columns at the end of the edges that receive."""
    if not noted:
        return process
    return replace(process, edges=tuple(_noting_edge(edge, visible, noted) for edge in process.edges))


def _noting_edge(edge: Edge, visible: VisibleEvents, noted: Mapping[str, Term]) -> Edge:
    sync = edge.synchronisation
    if sync is None or sync.direction is Direction.SEND:
        return edge
    if channel_variable(sync.channel) is not channel_variable(visible.channel):
        return edge
    given = _given_indices(sync.channel)
    changed = written_variables(edge.updates)
    if any(isinstance(node, Reference) and node.variable in changed for node in _parts(given)):
        raise UsageError(
            f"an edge that receives a `{visible.event}` changes the index of its channel",
            "keep the index in another variable while the edge is taken",
        )
    indices: dict[Variable, Expression] = {}
    same: list[Expression] = []
    for index, expression in zip(visible.indices, given, strict=True):
        if isinstance(index, Variable):
            indices[index] = expression
        else:
            same.append(Binary(BinaryOperator.EQUAL, expression, index, BOOL))
    updates = [update.expression for update in noting_updates(visible, noted, indices)]
    return replace(edge, updates=(*edge.updates, *(_where(same, update) for update in updates)))


def _where(conditions: Sequence[Expression], update: Expression) -> Expression:
    """The assignment if all conditions hold, else that of the same value again."""
    assert isinstance(update, Assign)
    value = update.value
    for condition in conditions:
        value = Conditional(condition, value, update.target, update.type)
    return replace(update, value=value)


def _given_indices(channel: Expression) -> list[Expression]:
    found: list[Expression] = []
    while isinstance(channel, Index):
        found.insert(0, channel.index)
        channel = channel.base
    return found


def _parts(expressions: Sequence[Expression]) -> Iterator[Expression]:
    for expression in expressions:
        yield from walk(expression)


def _streams(
    network: Network, mapping: RecordingMap, program: Program, noted: Sequence[Mapping[str, Term]]
) -> tuple[tuple[ObservedStream, ...], tuple[VisibleChannel, ...]]:
    numbers = {channel.name: number for number, channel in enumerate(program.channels)}
    slots = {slot.name: number for number, slot in enumerate(program.slots)}
    streams: list[ObservedStream] = []
    channels: list[VisibleChannel] = []
    taken: dict[str, str] = {}
    for visible, variables in zip(mapping.visible, noted, strict=True):
        is_input = not is_output(visible, network, mapping)
        places: dict[tuple[int, ...], int] = {}
        for case in index_cases(visible):
            common = {variable: case[variable] for variable in visible.per}
            key = tuple(common.values())
            if key not in places:
                places[key] = len(streams)
                streams.append(ObservedStream(visible, common, is_input))
            name = _name_of(visible, case)
            if name in taken:
                raise UsageError(
                    f"a step over {name} is both `{taken[name]}` and `{visible.event}`",
                    "let each channel be in one `visible` of the recording",
                )
            taken[name] = visible.event
            columns = tuple(
                (slots[_slot_name(variables[column])], 0)
                if column in variables
                else (None, _known(visible, expression, case))
                for column, expression in visible.columns
            )
            channels.append(VisibleChannel(numbers[name], places[key], is_input, columns))
    return tuple(streams), tuple(channels)


def _name_of(visible: VisibleEvents, case: Mapping[Variable, int]) -> str:
    """The name of the channel for these values of the indices."""
    values = [case[index] if isinstance(index, Variable) else index.value for index in visible.indices]
    return channel_variable(visible.channel).name + "".join(f"[{value}]" for value in values)


def _slot_name(variable: Term) -> str:
    assert isinstance(variable.expression, Reference)
    return variable.expression.variable.name


def _known(visible: VisibleEvents, column: Expression, case: Mapping[Variable, int]) -> int:
    if isinstance(column, Constant):
        return column.value
    assert isinstance(column, Reference)
    return case[column.variable]
