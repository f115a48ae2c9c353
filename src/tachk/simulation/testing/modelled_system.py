"""The model in place of the system, or a changed copy of it: its processes, run by the simulator."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from fractions import Fraction

from tachk import _core
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass, replace
from tachk.base.words import Direction
from tachk.engine.compiler.features import check_units
from tachk.engine.compiler.lower import lower_simulation
from tachk.engine.simulation.policy import Policy
from tachk.engine.simulation.simulator import TICKS_PER_UNIT
from tachk.model.builder import NetworkBuilder, Term
from tachk.model.expressions import (
    BOOL,
    Assign,
    Binary,
    Constant,
    Expression,
    Index,
    Reference,
    Variable,
    VariableKind,
)
from tachk.model.network import Edge, Location, Network, Process, Synchronisation
from tachk.model.recording import RecordingMap, VisibleEvents
from tachk.model.types import ArrayType, ChannelType, Type
from tachk.recordings.conformance.event_streams import (
    Constants,
    EventStreamReader,
    channel_variable,
    element,
    is_output,
    with_words,
)
from tachk.recordings.conformance.events import Cell, EventLog, RecordedEvent
from tachk.recordings.conformance.trace_product import with_channels
from tachk.simulation.columns import Column, observed
from tachk.simulation.fmi.unit import CoSimulationUnit, FmiType, Role, UnitVariable, common, observations
from tachk.simulation.fmi.unit_run import begin_run
from tachk.simulation.testing.event_columns import (
    ANYTHING,
    channel_indices,
    index_cases,
    is_broadcast,
    is_of_channel,
    noted_variables,
    noting_updates,
)
from tachk.simulation.testing.system_adapter import SeenOutput, SystemEndedError

_SOURCE = "the test"
_AT_ONCE = 1_000
"""The largest number of transitions at the same time."""
_ACTS = Variable("outside.acts", ANYTHING, VariableKind.GLOBAL, (0,))


@dataclass(frozen=True, slots=True)
class _OutputEdge:
    """Attributes:
    place: of the variable that tells whether the last transition took the edge.
    fixed: the columns that the channel says.
    noted: by column the place of the variable that holds it.
    """

    visible: VisibleEvents
    place: int
    fixed: Mapping[str, int]
    noted: Mapping[str, int]


@dataclass(frozen=True, slots=True)
class _InputEdge:
    """Attributes:
    place: of the variable that lets the environment take the edge.
    given: by column the place of the variable that it is copied from.
    """

    place: int
    given: Mapping[str, int]


class ModelledSystem:
    """Processes of a model as a system under test. Its times are those of the simulator, and it always sees an input
    that it is ready for; another one it ignores.
    """

    def __init__(
        self, network: Network, mapping: RecordingMap, constants: Constants, seed: int, policy: Policy
    ) -> None:
        """Locations in columns are variables already. Raises UsageError for what is not run on its own,
        UnsupportedError for what is not simulated."""
        check_units(network)
        if mapping.hidden:
            raise UsageError(
                "the recording has hidden channels, on which the environment acts unseen",
                "a model with them cannot stand for the system: test a program",
            )
        self._network = network
        self._mapping = mapping
        self._reader = EventStreamReader(mapping, EventLog(_SOURCE, (), None, None, Fraction(0)), constants)
        self._seed = seed
        self._policy = policy
        self._unit, self._outputs, self._inputs = _unit_of(network, mapping)
        self._seen: deque[SeenOutput] = deque()
        self._run: _core.UnitRun | None = None

    def start(self) -> None:
        with _ended_by_faults():
            self._run = begin_run(self._unit, self._seed, self._policy)
            self._react()

    def time(self) -> Fraction:
        return Fraction(self._under_way.now, TICKS_PER_UNIT)

    @property
    def _under_way(self) -> _core.UnitRun:
        assert self._run is not None
        return self._run

    def send(self, name: str, cells: Mapping[str, Cell]) -> Fraction:
        time = self.time()
        placed = self._reader.place(RecordedEvent(time, name, cells, "an input"))
        if placed is None:
            raise SystemEndedError(f"the model that stands for the system has no input `{name}`")
        clause, _, values = placed
        visible = self._mapping.visible[clause]
        contents = {column: value for (column, _), value in zip(visible.columns, values, strict=True)}
        edge = self._inputs[clause, _case_of(visible, contents)]
        for column, place in edge.given.items():
            self._under_way.set_number(place, FmiType.INTEGER, contents[column] or 0)
        self._under_way.set_ticks(edge.place)
        try:
            with _ended_by_faults():
                self._react()
        except ValueError:
            raise SystemEndedError(f"the model that stands for the system cannot receive `{name}` now") from None
        return time

    def next_output(self, until: Fraction) -> SeenOutput | None:
        with _ended_by_faults():
            return self._next_output(until)

    def _next_output(self, until: Fraction) -> SeenOutput | None:
        run, last = self._under_way, int(until * TICKS_PER_UNIT)
        while not self._seen:
            if run.over:
                raise SystemEndedError("time stands still in the model")
            moment = run.next_event()
            if moment > last:
                break
            run.wait_until(moment)
            if not self._react() and run.next_event() <= moment:
                raise SystemEndedError("time stands still in the model unless an input comes")
        if self._seen:
            return self._seen.popleft()
        if last > run.now:
            run.wait_until(last)
        return None

    def _react(self) -> bool:
        """Lets happen what happens at this moment, and notes outputs. True if something did."""
        run, transitions = self._under_way, 0
        while run.react():
            transitions += 1
            if transitions > _AT_ONCE:
                raise SystemEndedError(f"the model takes {_AT_ONCE} transitions at the same time")
            for output in self._outputs:
                if run.ticks(output.place):
                    noted = {column: run.number(place, FmiType.INTEGER) for column, place in output.noted.items()}
                    self._seen.append(SeenOutput(self.time(), output.visible.event, self._cells(output, noted)))
        return transitions > 0

    @staticmethod
    def _cells(output: _OutputEdge, noted: Mapping[str, int]) -> dict[str, Cell]:
        values = {**output.fixed, **noted}
        return dict(with_words(output.visible, ((column, values[column]) for column, _ in output.visible.columns)))

    def waited(self) -> Fraction:
        return Fraction(0)

    def close(self) -> None:
        self._run = None

    def abandon(self) -> None:
        self.close()


@contextmanager
def _ended_by_faults() -> Iterator[None]:
    """A run-time error in the model, of which the core says no more, ends the system."""
    try:
        yield
    except RuntimeError as error:
        raise SystemEndedError(f"the model that stands for the system ends: {error}") from None


def _case_of(visible: VisibleEvents, contents: Mapping[str, int | None]) -> tuple[int, ...]:
    """The values of the indices of the channel."""
    known = {
        expression.variable: contents[column]
        for column, expression in visible.columns
        if isinstance(expression, Reference) and expression.variable in visible.indices
    }
    values = [known.get(index) for index in visible.indices if isinstance(index, Variable)]
    if None in values:
        raise UsageError(
            f"an event `{visible.event}` does not contain each index of its channel",
            "let each index be a column of the event",
        )
    return tuple(value for value in values if value is not None)


Inputs = Mapping[tuple[int, tuple[int, ...]], _InputEdge]
"""By the number of the clause and the values of its indices."""


class _Outside:
    """The process in place of the environment: it receives the outputs of the system, and sends its inputs.

    Attributes:
        edges: of the process, which has one location.
        sends: what the system sends: the clause, the number of the edge, the columns that the channel says, and the
            variables that hold the others.
        receives: what it receives: the clause and the values of its indices, the number of the edge, and the variables
            that its columns are copied from.
        calm: channels that the environment sends on, as broadcast channels.
    """

    def __init__(self, network: Network, mapping: RecordingMap) -> None:
        self.builder = NetworkBuilder("outside.", VariableKind.GLOBAL)
        self.edges: list[Edge] = []
        self.sends: list[tuple[VisibleEvents, int, dict[str, int], dict[str, Term]]] = []
        self.receives: list[tuple[tuple[int, tuple[int, ...]], int, dict[str, Term]]] = []
        self.calm: dict[Variable, Variable] = {}
        modelled = [network.processes[number] for number in mapping.modelled(network)]
        for number, visible in enumerate(mapping.visible):
            outgoing = is_output(visible, network, mapping)
            if not outgoing and not is_broadcast(visible):
                self.calm |= _as_broadcast(visible, modelled)
            variables = noted_variables(self.builder, number, visible)
            for case in index_cases(visible):
                if outgoing:
                    self._add_output(visible, case, variables)
                else:
                    self._add_input(number, visible, case, variables)
        self.edges.append(Edge(0, 0, guard=_never(), updates=(_again(),)))

    def _add_output(self, visible: VisibleEvents, case: Mapping[Variable, int], variables: dict[str, Term]) -> None:
        indices = {variable: Constant(value) for variable, value in case.items()}
        fixed = {
            column: expression.value if isinstance(expression, Constant) else case[expression.variable]
            for column, expression in visible.columns
            if isinstance(expression, Constant | Reference) and is_of_channel(visible, expression)
        }
        self.sends.append((visible, len(self.edges), fixed, variables))
        updates = [term.expression for term in noting_updates(visible, variables, indices)]
        self._add_edge(visible, case, Direction.RECEIVE, None, updates)

    def _add_input(
        self, number: int, visible: VisibleEvents, case: Mapping[Variable, int], variables: dict[str, Term]
    ) -> None:
        self.receives.append(((number, tuple(case.values())), len(self.edges), variables))
        updates = [
            _given(visible, column, expression, variables)
            for column, expression in visible.columns
            if column in variables
        ]
        # A variable that no edge writes counts as a constant.
        cleared = [variable.assign(0).expression for variable in variables.values()]
        self._add_edge(visible, case, Direction.SEND, _never(), [*updates, *cleared, _again()])

    def _add_edge(
        self,
        visible: VisibleEvents,
        case: Mapping[Variable, int],
        direction: Direction,
        guard: Expression | None,
        updates: list[Expression],
    ) -> None:
        indices = {variable: Constant(value) for variable, value in case.items()}
        channel = element(visible.channel, channel_indices(visible, indices))
        synchronisation = Synchronisation(channel, direction)
        self.edges.append(Edge(0, 0, guard=guard, synchronisation=synchronisation, updates=tuple(updates)))

    def opened(self, network: Network, replaced: frozenset[int]) -> Network:
        """The network with this process in place of others."""
        system = (_stub(process) if n in replaced else process for n, process in enumerate(network.processes))
        outside = Process("outside", "outside", (Location("all"),), tuple(self.edges))
        variables = (self.calm.get(variable, variable) for variable in network.variables)
        return replace(
            network,
            processes=tuple(with_channels(process, self.calm) for process in (*system, outside)),
            variables=(*variables, *self.builder.variables, _ACTS),
            signals=(),
        )


def _unit_of(network: Network, mapping: RecordingMap) -> tuple[CoSimulationUnit, tuple[_OutputEdge, ...], Inputs]:
    """The unit of the processes that are the system, with the edges of its environment."""
    environment = _Outside(network, mapping)
    opened = environment.opened(network, mapping.replaced)
    columns = [Column(variable.name, Reference(variable)) for variable in environment.builder.variables]
    program, chances = lower_simulation(opened, observed(columns))
    last = len(opened.processes) - 1
    numbers = {edge.edge: n for n, edge in enumerate(program.edges) if edge.process == last}
    slots = {slot.name: n for n, slot in enumerate(program.slots)}
    made: list[UnitVariable] = [*common(), *observations(columns, program)]
    places = {variable.name: place for place, variable in enumerate(made)}
    outputs = []
    for visible, edge, fixed, variables in environment.sends:
        noted = {column: places[_name(variable)] for column, variable in variables.items()}
        outputs.append(_OutputEdge(visible, len(made), fixed, noted))
        made.append(UnitVariable(f"send[{edge}]", Role.SENDS, FmiType.CLOCK, numbers[edge]))
    given: dict[str, int] = {}
    for _, _, variables in environment.receives:
        for name in map(_name, variables.values()):
            if name not in given:
                given[name] = len(made)
                made.append(UnitVariable(f"given {name}", Role.INPUT, FmiType.INTEGER, slots[name], start=0))
    inputs = {}
    for key, edge, variables in environment.receives:
        inputs[key] = _InputEdge(len(made), {column: given[_name(v)] for column, v in variables.items()})
        made.append(UnitVariable(f"receive[{edge}]", Role.RECEIVES, FmiType.CLOCK, numbers[edge]))
    nudge = numbers[len(environment.edges) - 1]
    unit = CoSimulationUnit("system", program, chances, tuple(made), Fraction(TICKS_PER_UNIT), nudge)
    return unit, tuple(outputs), inputs


def _name(variable: Term) -> str:
    assert isinstance(variable.expression, Reference)
    return variable.expression.variable.name


def _stub(process: Process) -> Process:
    return Process(process.name, process.template, (Location("elsewhere"),), ())


def _never() -> Expression:
    """A guard that is false, which the compiler cannot know: only the adapter takes these edges."""
    return Binary(BinaryOperator.EQUAL, Reference(_ACTS), Constant(1), BOOL)


def _again() -> Expression:
    return Assign(Reference(_ACTS), Constant(0), _ACTS.type)


def _given(visible: VisibleEvents, column: str, target: Expression, variables: Mapping[str, Term]) -> Expression:
    if not isinstance(target, Reference | Index):
        raise UsageError(
            f"`{column}` of `{visible.event}`, which comes from outside, has no place to go to",
            "an event from outside sets variables, and is none of their expressions",
        )
    return Assign(target, variables[column].expression, target.type)


def _as_broadcast(visible: VisibleEvents, modelled: list[Process]) -> dict[Variable, Variable]:
    """The channel of an input as a broadcast channel, so that the system ignores what it is not ready for."""
    variable = channel_variable(visible.channel)
    receivers = [process for process in modelled if any(_uses(process, variable))]
    if len(receivers) > 1:
        raise UsageError(
            f"`{visible.event}` may be received by {receivers[0].name} or by {receivers[1].name}",
            "give each process of the system a channel of its own, or make it a broadcast channel",
        )
    return {variable: replace(variable, type=_broadcast(variable.type))}


def _uses(process: Process, variable: Variable) -> Iterator[bool]:
    for edge in process.edges:
        sync = edge.synchronisation
        yield sync is not None and channel_variable(sync.channel) is variable


def _broadcast(type_: Type) -> Type:
    if isinstance(type_, ArrayType):
        return replace(type_, element=_broadcast(type_.element))
    assert isinstance(type_, ChannelType)
    return replace(type_, broadcast=True, urgent=False)
