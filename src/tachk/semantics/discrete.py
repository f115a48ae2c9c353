"""The discrete side of a network's semantics: who can take part in a transition, and what its updates do.

Shared by the concrete (`tachk.semantics.step`) and the symbolic (`tachk.semantics.symbolic`) semantics, which add time.
Interprets the `Network` directly, on purpose without the compiled program: it is the independent reading of a model.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import product

from tachk.model.evaluate import Environment, channel_number, clock_number, evaluate, execute
from tachk.model.expressions import Binary, Constant, Expression, Field, Index, Reference, Unary, Variable
from tachk.model.fault import EvaluationFault
from tachk.model.layout import CellLayout, cell_layout
from tachk.model.network import Direction, Edge, Location, Network
from tachk.model.traversal import walk
from tachk.model.types import ChannelType, bounds, cell_count, leaves
from tachk.semantics.trace import DiscreteState, Participant, Transition

Priority = tuple[int, int]
"""Channel priority, then process priority."""


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """A network prepared for interpretation; made by `prepare`.

    Attributes:
        instances: for each process and location, the outgoing edges, once for each combination of select values.
        channels: for each channel its type and priority.
        fixed: the channels of those synchronisations that name the same one in every state.
    """

    network: Network
    layout: CellLayout
    instances: tuple[tuple[tuple[Participant, ...], ...], ...]
    channels: tuple[tuple[ChannelType, int], ...]
    fixed: dict[Participant, int] = field(repr=False)

    @property
    def dimension(self) -> int:
        """The number of clocks, the reference clock included."""
        return len(self.layout.clock_cells) + 1

    def edge(self, participant: Participant) -> Edge:
        return self.network.processes[participant.process].edges[participant.edge]

    def current(self, discrete: DiscreteState) -> tuple[Location, ...]:
        """The current location of every process."""
        return tuple(p.locations[n] for p, n in zip(self.network.processes, discrete.locations, strict=True))


@dataclass(frozen=True, slots=True)
class Offer:
    """An edge that could be taken, with the channel it names in the current state; None for an internal edge."""

    participant: Participant
    channel: int | None
    sends: bool


def prepare(network: Network) -> Model:
    layout = cell_layout(network)
    channels = []
    for variable in network.all_variables():
        first = layout.first[variable]
        for cell, type_ in enumerate(layout.types[first : first + cell_count(variable.type)]):
            if isinstance(type_, ChannelType):
                given = variable.priorities
                channels.append((type_, given[cell] if given else network.default_priority))
    instances = tuple(_instances(network, p) for p in range(len(network.processes)))
    return Model(network, layout, instances, tuple(channels), _fixed_channels(network, layout, instances))


def _fixed_channels(
    network: Network, layout: CellLayout, instances: Iterable[Iterable[Iterable[Participant]]]
) -> dict[Participant, int]:
    scratch = Environment(layout, list(layout.initial), tuple(process.initial for process in network.processes))
    found = {}
    for participant in (p for of_process in instances for of_location in of_process for p in of_location):
        edge = network.processes[participant.process].edges[participant.edge]
        if edge.synchronisation is None or not _is_fixed(edge.synchronisation.channel, edge.selects):
            continue
        for variable, value in zip(edge.selects, participant.selects, strict=True):
            scratch.bind(variable, value)
        with suppress(EvaluationFault):  # whoever takes the edge will meet the fault
            found[participant] = channel_number(edge.synchronisation.channel, scratch)
    return found


def _is_fixed(channel: Expression, selects: Sequence[Variable]) -> bool:
    def is_fixed(node: Expression) -> bool:
        if isinstance(node, Reference):
            of_channels = all(isinstance(leaf, ChannelType) for _, leaf in leaves(node.variable.type))
            return of_channels or node.variable in selects
        return isinstance(node, Constant | Index | Field | Binary | Unary)

    return all(map(is_fixed, walk(channel)))


def _instances(network: Network, process: int) -> tuple[tuple[Participant, ...], ...]:
    by_location: list[list[Participant]] = [[] for _ in network.processes[process].locations]
    for number, edge in enumerate(network.processes[process].edges):
        ranges = [bounds(v.type) for v in edge.selects]  # type: ignore[arg-type]
        for values in product(*(range(low, high + 1) for low, high in ranges)):
            by_location[edge.source].append(Participant(process, number, values))
    return tuple(tuple(i) for i in by_location)


def initial_discrete(model: Model) -> DiscreteState:
    return DiscreteState(tuple(p.initial for p in model.network.processes), model.layout.initial)


def environment(model: Model, discrete: DiscreteState, clocks: Sequence[Fraction] | None = None) -> Environment:
    """Where the expressions of a state are evaluated."""
    return Environment(model.layout, list(discrete.values), discrete.locations, clocks)


def bind_selects(model: Model, participant: Participant, scratch: Environment) -> None:
    """Gives the select variables of a participant their values."""
    for variable, value in zip(model.edge(participant).selects, participant.selects, strict=True):
        scratch.bind(variable, value)


def offers(model: Model, scratch: Environment, is_open: Callable[[Participant], bool]) -> tuple[tuple[Offer, ...], ...]:
    """For each process the outgoing edges that ``is_open`` accepts, with their channels. Raises EvaluationFault.

    ``scratch`` is the environment of the state; ``is_open`` finds the select variables bound in it.
    """

    def of_process(process: int, location: int) -> Iterator[Offer]:
        for participant in model.instances[process][location]:
            bind_selects(model, participant, scratch)
            if is_open(participant):
                yield offer(model, participant, scratch)

    return tuple(tuple(of_process(p, location)) for p, location in enumerate(scratch.locations))


def offer(model: Model, participant: Participant, scratch: Environment) -> Offer:
    """The offer that an edge makes, with its select variables bound in the environment. Raises EvaluationFault."""
    synchronisation = model.edge(participant).synchronisation
    if synchronisation is None:
        return Offer(participant, None, sends=False)
    channel = model.fixed.get(participant)
    if channel is None:
        channel = channel_number(synchronisation.channel, scratch)
    return Offer(participant, channel, synchronisation.direction is Direction.SEND)


def may_denote(model: Model, place: Expression, channel: int) -> bool:
    """Whether a channel expression can denote a channel in any state, judged by the variable it is built on."""
    match place:
        case Index(base) | Field(base):
            return may_denote(model, base, channel)
        case Reference(variable):
            first = model.layout.first[variable]
            return first <= model.layout.channel_cells[channel] < first + cell_count(variable.type)
        case _:
            return True


def combinations(
    model: Model,
    discrete: DiscreteState,
    offered: Sequence[Sequence[Offer]],
    may_abstain: Callable[[Sequence[Offer]], bool],
) -> Iterator[Transition]:
    """The transitions that the offers allow and the committed rule admits.

    For a broadcast ``may_abstain`` says of a process's matching offers whether the process can also stay out.
    """
    for first in (o for of_process in offered for o in of_process):
        if first.channel is None:
            candidates: Iterator[Transition] = iter([Transition((first.participant,))])
        elif not first.sends:
            continue
        elif model.channels[first.channel][0].broadcast:
            candidates = _broadcasts(first, offered, may_abstain)
        else:
            candidates = _handshakes(first, offered)
        yield from (t for t in candidates if _admitted(model, discrete, t))


def _matching(sender: Offer, offered: Sequence[Sequence[Offer]]) -> list[list[Offer]]:
    """For each other process its receiving offers on the sender's channel."""
    return [
        [o for o in of_process if o.channel == sender.channel and not o.sends]
        for process, of_process in enumerate(offered)
        if process != sender.participant.process
    ]


def _handshakes(sender: Offer, offered: Sequence[Sequence[Offer]]) -> Iterator[Transition]:
    for receivers in _matching(sender, offered):
        for receiver in receivers:
            yield Transition((sender.participant, receiver.participant))


def _broadcasts(
    sender: Offer, offered: Sequence[Sequence[Offer]], may_abstain: Callable[[Sequence[Offer]], bool]
) -> Iterator[Transition]:
    choices: list[list[tuple[Participant, ...]]] = []
    for receivers in _matching(sender, offered):
        joins: list[tuple[Participant, ...]] = [(r.participant,) for r in receivers]
        choices.append(joins + ([()] if may_abstain(receivers) else []))
    for chosen in product(*choices):
        yield Transition((sender.participant, *(p for join in chosen for p in join)))


def _admitted(model: Model, discrete: DiscreteState, transition: Transition) -> bool:
    """The committed rule: where a current location is committed, the transition leaves a committed location."""
    committed = [location.committed for location in model.current(discrete)]
    return not any(committed) or any(committed[p.process] for p in transition.participants)


def channel_of(model: Model, discrete: DiscreteState, transition: Transition) -> int | None:
    """The channel of a transition that starts in a state; None for an internal one."""
    scratch = environment(model, discrete)
    bind_selects(model, transition.participants[0], scratch)
    return offer(model, transition.participants[0], scratch).channel


def is_urgent(model: Model, discrete: DiscreteState, transition: Transition) -> bool:
    """Whether the transition is a synchronisation over an urgent channel."""
    channel = channel_of(model, discrete, transition)
    return channel is not None and model.channels[channel][0].urgent


def priority(model: Model, discrete: DiscreteState, transition: Transition) -> Priority:
    """What decides between transitions; larger goes first."""
    channel = channel_of(model, discrete, transition)
    of_channel = model.network.default_priority if channel is None else model.channels[channel][1]
    return of_channel, max(model.network.processes[p.process].priority for p in transition.participants)


def has_priorities(model: Model) -> bool:
    """Whether any two transitions can differ in priority."""
    of_channels = {p for _, p in model.channels} | {model.network.default_priority}
    return len(of_channels) > 1 or len({p.priority for p in model.network.processes}) > 1


def execute_updates(
    model: Model, discrete: DiscreteState, transition: Transition
) -> tuple[DiscreteState, dict[int, int]]:
    """The discrete state after a transition, and the clocks it sets with their new values. Raises EvaluationFault.

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
    values = (
        initial if meta else value
        for value, initial, meta in zip(scratch.values, model.layout.initial, model.layout.meta, strict=True)
    )
    return DiscreteState(tuple(locations), tuple(values)), scratch.resets


def may_delay(model: Model, discrete: DiscreteState) -> bool:
    """Whether no current location is urgent or committed."""
    return not any(location.urgent or location.committed for location in model.current(discrete))


def stopped_clocks(model: Model, discrete: DiscreteState) -> frozenset[int]:
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
