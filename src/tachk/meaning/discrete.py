"""The discrete side of a network's semantics: who can take part in a transition, and what its updates do.

Shared by the concrete (`tachk.meaning.step`) and the symbolic (`tachk.meaning.symbolic`) semantics, which add time.
Interprets the `Network` directly, on purpose without the compiled program: it is the independent reading of a model.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import cached_property
from itertools import product
from weakref import WeakValueDictionary

from tachk.base.job import check_job
from tachk.base.records import dataclass
from tachk.base.words import Direction
from tachk.meaning.dbm import ClockValues
from tachk.meaning.memory import Memory, by_state
from tachk.model.evaluate import Environment, channel_number, clock_number, evaluate, execute
from tachk.model.expressions import Binary, Constant, Expression, Field, Index, Reference, Unary, Variable
from tachk.model.fault import EvaluationFault
from tachk.model.network import Edge, Location, Network
from tachk.model.run import DiscreteState, Participant, Transition
from tachk.model.selections import check_selections
from tachk.model.traversal import children, process_expressions, written_variables
from tachk.model.types import ChannelType, bounds, slot_count
from tachk.model.variable_layout import VariableLayout, variable_layout

Priority = tuple[int, int]
"""Channel priority, then process priority."""


@dataclass(frozen=True, eq=False)
class PreparedNetwork:
    """A network prepared for interpretation; made by `prepare`.

    Attributes:
        channels: for each channel its type and priority.
        most_cases: of so many conjunctions the guards of all transitions of one discrete state may be disjunctions.
    """

    network: Network
    layout: VariableLayout
    channels: tuple[tuple[ChannelType, int], ...]
    most_cases: int = 10_000_000

    @cached_property
    def instances(self) -> tuple[tuple[tuple[Participant, ...], ...], ...]:
        """For each process and location, the outgoing edges, once for each combination of select values. There may be
        millions, which most of what needs a model never looks at. Raises UnsupportedError (E0708) for too many."""
        check_selections(self.network)
        return tuple(_instances(self.network, p) for p in range(len(self.network.processes)))

    @cached_property
    def meta_slots(self) -> tuple[tuple[int, int], ...]:
        """The slots of meta variables, with their initial values."""
        return tuple((slot, self.layout.initial[slot]) for slot, meta in enumerate(self.layout.meta) if meta)

    @cached_property
    def fixed(self) -> dict[Participant, int]:
        """The channels of those synchronisations that name the same one in every state."""
        return _fixed_channels(self.network, self.layout, self.instances)

    @cached_property
    def memory(self) -> Memory:
        """The cached facts about the last discrete states."""
        return Memory()

    @cached_property
    def has_priorities(self) -> bool:
        return self.network.has_priorities

    @property
    def dimension(self) -> int:
        """The number of clocks, the reference clock included."""
        return len(self.layout.clock_slots) + 1

    def edge(self, participant: Participant) -> Edge:
        return self.network.processes[participant.process].edges[participant.edge]

    def current(self, discrete: DiscreteState) -> tuple[Location, ...]:
        """The current location of every process."""
        return tuple(p.locations[n] for p, n in zip(self.network.processes, discrete.locations, strict=True))


_PREPARED: WeakValueDictionary[int, PreparedNetwork] = WeakValueDictionary()
"""By the identities of their networks, as long as they are used."""


def prepare(network: Network) -> PreparedNetwork:
    """The network for interpretation, with what is remembered of it where it is in use already."""
    found = _PREPARED.get(id(network))
    if found is None:
        found = _PREPARED[id(network)] = _prepared(network)
    return found


def _prepared(network: Network) -> PreparedNetwork:
    layout = variable_layout(network)
    channels = []
    for variable in network.all_variables():
        first = layout.first[variable]
        for slot, type_ in enumerate(layout.types[first : first + slot_count(variable.type)]):
            if isinstance(type_, ChannelType):
                given = variable.priorities
                channels.append((type_, given[slot] if given else network.default_priority))
    return PreparedNetwork(network, layout, tuple(channels))


def _fixed_channels(
    network: Network, layout: VariableLayout, instances: Iterable[Iterable[Iterable[Participant]]]
) -> dict[Participant, int]:
    scratch = Environment(layout, list(layout.initial), tuple(process.initial for process in network.processes))
    written = written_variables([e for process in network.processes for e in process_expressions(process)])
    found = {}
    for participant in (p for of_process in instances for of_location in of_process for p in of_location):
        edge = network.processes[participant.process].edges[participant.edge]
        if edge.synchronisation is None or not _is_the_same_everywhere(edge.synchronisation.channel, written):
            continue
        for variable, value in zip(edge.selects, participant.selects, strict=True):
            scratch.bind(variable, value)
        with suppress(EvaluationFault):  # which counts only where the channel of the edge is evaluated
            found[participant] = channel_number(edge.synchronisation.channel, scratch)
    return found


def _is_the_same_everywhere(place: Expression, written: Container[Variable]) -> bool:
    """True if a place is the same in every state: made of constants and of variables that nothing writes."""
    match place:
        case Reference(variable):
            return not variable.reference and variable not in written
        case Constant() | Field() | Index() | Unary() | Binary():
            return all(_is_the_same_everywhere(child, written) for child in children(place))
        case _:
            return False


def _instances(network: Network, process: int) -> tuple[tuple[Participant, ...], ...]:
    by_location: list[list[Participant]] = [[] for _ in network.processes[process].locations]
    for number, edge in enumerate(network.processes[process].edges):
        ranges = [bounds(v.type) for v in edge.selects]  # type: ignore[arg-type]
        for values in product(*(range(low, high + 1) for low, high in ranges)):
            check_job()
            by_location[edge.source].append(Participant(process, number, values))
    return tuple(tuple(i) for i in by_location)


def initial_clocks(model: PreparedNetwork) -> tuple[Fraction, ...]:
    return tuple(map(Fraction, model.layout.starts))


def initial_discrete(model: PreparedNetwork) -> DiscreteState:
    return DiscreteState(tuple(p.initial for p in model.network.processes), model.layout.initial)


def environment(
    model: PreparedNetwork, discrete: DiscreteState, clocks: Sequence[Fraction] | None = None
) -> Environment:
    """The environment in which the expressions of a state are evaluated."""
    return Environment(model.layout, list(discrete.values), discrete.locations, clocks)


def bind_selects(model: PreparedNetwork, participant: Participant, scratch: Environment) -> None:
    """Gives the select variables of a participant their values."""
    for variable, value in zip(model.edge(participant).selects, participant.selects, strict=True):
        scratch.bind(variable, value)


# ---- which guards are evaluated, and when ---------------------------------------------------------------------------
#
# The rule for run-time errors (docs/semantics.md): the guards of internal and sending edges are evaluated in every
# state, those of a receiving edge only where the guard of a sender holds whose channel it may name; a channel index is
# evaluated where the guard of its edge holds. All enumerations of transitions use these functions.


@by_state
def initiators(model: PreparedNetwork, discrete: DiscreteState) -> tuple[Participant, ...]:
    """The edges that can begin a transition: senders, and the internal edges that the committed rule admits."""
    admitted = _admitted(model, discrete)
    found = []
    for process, location in enumerate(discrete.locations):
        for participant in model.instances[process][location]:
            synchronisation = model.edge(participant).synchronisation
            if synchronisation is None:
                if admitted[process]:
                    found.append(participant)
            elif synchronisation.direction is Direction.SEND:
                found.append(participant)
    return tuple(found)


def channel_named(model: PreparedNetwork, participant: Participant, scratch: Environment) -> int | None:
    """The channel that an edge names, its select variables bound; None for an internal one. Raises EvaluationFault."""
    synchronisation = model.edge(participant).synchronisation
    if synchronisation is None:
        return None
    fixed = model.fixed.get(participant)
    return channel_number(synchronisation.channel, scratch) if fixed is None else fixed


@by_state
def enabled_receivers(
    model: PreparedNetwork, discrete: DiscreteState, sender: Participant, channel: int
) -> tuple[tuple[Participant, ...], ...]:
    """For each other process that has some, the receiving edges that may name a channel and that the committed rule
    admits."""
    admitted = _admitted(model, discrete)
    free = model.channels[channel][0].broadcast or admitted[sender.process]
    of_processes = (
        tuple(p for p in model.instances[process][location] if may_receive(model, p, channel))
        for process, location in enumerate(discrete.locations)
        if process != sender.process and (free or admitted[process])
    )
    return tuple(filter(None, of_processes))


def may_receive(model: PreparedNetwork, participant: Participant, channel: int) -> bool:
    synchronisation = model.edge(participant).synchronisation
    if synchronisation is None or synchronisation.direction is Direction.SEND:
        return False
    fixed = model.fixed.get(participant)
    return _may_denote(model, synchronisation.channel, channel) if fixed is None else fixed == channel


def may_be_urgent(model: PreparedNetwork, participant: Participant) -> bool:
    """True if an edge names an urgent channel in some state."""
    synchronisation = model.edge(participant).synchronisation
    urgent = (number for number, (type_, _) in enumerate(model.channels) if type_.urgent)
    return synchronisation is not None and any(_may_denote(model, synchronisation.channel, n) for n in urgent)


def _may_denote(model: PreparedNetwork, place: Expression, channel: int) -> bool:
    """True if a channel expression can denote a channel in any state, decided by the variable it is built on."""
    match place:
        case Index(base) | Field(base):
            return _may_denote(model, base, channel)
        case Reference(variable):
            first = model.layout.first[variable]
            return first <= model.layout.channel_slots[channel] < first + slot_count(variable.type)
        case _:
            return True


def transitions_with(
    model: PreparedNetwork,
    discrete: DiscreteState,
    sender: Participant,
    channel: int,
    receiving: Sequence[Sequence[Participant]],
    may_abstain: Callable[[Sequence[Participant]], bool],
) -> Iterator[Transition]:
    """The transitions of a sender with its receivers, as far as the committed rule admits them.

    For a broadcast ``may_abstain`` says of the edges of one process whether the process can also stay out.
    """
    if not model.channels[channel][0].broadcast:
        yield from (Transition((sender, receiver)) for of_process in receiving for receiver in of_process)
        return
    choices: list[list[tuple[Participant, ...]]] = []
    for receivers in receiving:
        joins: list[tuple[Participant, ...]] = [(receiver,) for receiver in receivers]
        choices.append(joins + ([()] if may_abstain(receivers) else []))
    for chosen in product(*choices):
        transition = Transition((sender, *(p for join in chosen for p in join)))
        if is_admitted(model, discrete, transition):
            yield transition


def is_admitted(model: PreparedNetwork, discrete: DiscreteState, transition: Transition) -> bool:
    """True if the committed rule lets some process of a transition go."""
    admitted = _admitted(model, discrete)
    return any(admitted[participant.process] for participant in transition.participants)


@by_state
def _admitted(model: PreparedNetwork, discrete: DiscreteState) -> tuple[bool, ...]:
    """For each process, whether the committed rule lets it go."""
    locations = tuple(model.current(discrete))
    most = max((location.commitment for location in locations), default=0)
    return tuple(location.may_go(most) for location in locations)


@by_state
def channel_of(model: PreparedNetwork, discrete: DiscreteState, transition: Transition) -> int | None:
    """The channel of a transition that starts in a state; None for an internal one."""
    scratch = environment(model, discrete)
    bind_selects(model, transition.participants[0], scratch)
    return channel_named(model, transition.participants[0], scratch)


def is_urgent(model: PreparedNetwork, discrete: DiscreteState, transition: Transition) -> bool:
    """True if the transition is a synchronisation over an urgent channel."""
    channel = channel_of(model, discrete, transition)
    return channel is not None and model.channels[channel][0].urgent


def priority(model: PreparedNetwork, discrete: DiscreteState, transition: Transition) -> Priority:
    """The priority of a transition; larger goes first."""
    channel = channel_of(model, discrete, transition)
    of_channel = model.network.default_priority if channel is None else model.channels[channel][1]
    return of_channel, max(model.network.processes[p.process].priority for p in transition.participants)


@by_state
def execute_updates(
    model: PreparedNetwork, discrete: DiscreteState, transition: Transition
) -> tuple[DiscreteState, ClockValues]:
    """The discrete state after a transition, and what it sets clocks to, all at once. Raises EvaluationFault.

    Updates run sender first, then receivers in process order, each seeing the effects of those before. Meta variables
    start at their initial value, and are back at it in the resulting state.
    """
    scratch = environment(model, discrete)
    for participant in transition.participants:
        bind_selects(model, participant, scratch)
        execute(model.edge(participant).updates, scratch)
    locations = list(discrete.locations)
    for participant in transition.participants:
        locations[participant.process] = model.edge(participant).target
    for slot, initial in model.meta_slots:
        scratch.values[slot] = initial
    resets = ((clock, source, more) for clock, (source, more) in scratch.resets.items())
    return DiscreteState(tuple(locations), tuple(scratch.values)), tuple(sorted(resets))


def clocks_after(clocks: Sequence[Fraction], resets: ClockValues) -> tuple[Fraction, ...]:
    """The values of clocks after a transition that sets some of them."""
    after = list(clocks)
    for clock, source, more in resets:
        after[clock - 1] = more + (clocks[source - 1] if source else Fraction(0))
    return tuple(after)


def meta_values(model: PreparedNetwork, discrete: DiscreteState, transition: Transition) -> dict[int, int]:
    """The values of meta variables, by slot, after the updates of a transition: the messages between its processes.

    Raises EvaluationFault.
    """
    scratch = environment(model, discrete)
    for participant in transition.participants:
        bind_selects(model, participant, scratch)
        execute(model.edge(participant).updates, scratch)
    return {slot: scratch.values[slot] for slot, _ in model.meta_slots}


@by_state
def may_delay(model: PreparedNetwork, discrete: DiscreteState) -> bool:
    """True if no current location is urgent or committed."""
    return not any(location.urgent or location.committed for location in model.current(discrete))


@by_state
def stopped_clocks(model: PreparedNetwork, discrete: DiscreteState) -> frozenset[int]:
    """The numbers of the clocks that stand still. Raises ValueError for a rate other than 0 and 1."""
    stopped = set()
    scratch = environment(model, discrete)
    for location in model.current(discrete):
        for clock, rate in location.rates:
            value = evaluate(rate, scratch)
            if value not in (0, 1):
                raise ValueError(f"a clock has the rate {value} in location {location.name}; only 0 and 1 are possible")
            if value == 0:
                stopped.add(clock_number(clock, scratch))
    return frozenset(stopped)
