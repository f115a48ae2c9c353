"""The discrete side of a network's semantics: who can take part in a transition, and what its updates do.

Shared by the concrete (`tachk.semantics.step`) and the symbolic (`tachk.semantics.symbolic`) semantics, which add time.
Interprets the `Network` directly, on purpose without the compiled program: it is the independent reading of a model.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product

from tachk.model.evaluate import Environment, channel_number, clock_number, evaluate, execute
from tachk.model.layout import CellLayout, cell_layout
from tachk.model.network import Direction, Edge, Location, Network
from tachk.model.types import ChannelType, bounds, cell_count
from tachk.semantics.trace import DiscreteState, Participant, Transition

Priority = tuple[int, int]
"""Channel priority, then process priority."""


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """A network prepared for interpretation; made by `prepare`.

    Attributes:
        instances: for each process and location, the outgoing edges, once for each combination of select values.
        channels: for each channel its type and priority.
    """

    network: Network
    layout: CellLayout
    instances: tuple[tuple[tuple[Participant, ...], ...], ...]
    channels: tuple[tuple[ChannelType, int], ...]

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
    return Model(network, layout, tuple(_instances(network, p) for p in range(len(network.processes))), tuple(channels))


def _instances(network: Network, process: int) -> tuple[tuple[Participant, ...], ...]:
    by_location: list[list[Participant]] = [[] for _ in network.processes[process].locations]
    for number, edge in enumerate(network.processes[process].edges):
        ranges = [bounds(v.type) for v in edge.selects]  # type: ignore[arg-type]
        for values in product(*(range(low, high + 1) for low, high in ranges)):
            by_location[edge.source].append(Participant(process, number, values))
    return tuple(tuple(i) for i in by_location)


def initial_discrete(model: Model) -> DiscreteState:
    return DiscreteState(tuple(p.initial for p in model.network.processes), model.layout.initial)


def environment(
    model: Model,
    discrete: DiscreteState,
    participant: Participant | None = None,
    clocks: Sequence[Fraction] | None = None,
) -> Environment:
    """Where expressions are evaluated in a state, with the select variables of one participant bound."""
    result = Environment(model.layout, list(discrete.values), discrete.locations, clocks)
    if participant is not None:
        for variable, value in zip(model.edge(participant).selects, participant.selects, strict=True):
            result.bind(variable, value)
    return result


def offers(
    model: Model, discrete: DiscreteState, is_open: Callable[[Participant], bool]
) -> tuple[tuple[Offer, ...], ...]:
    """For each process the outgoing edges that ``is_open`` accepts, with their channels. Raises EvaluationFault."""
    return tuple(
        tuple(
            _offer(model, discrete, participant)
            for participant in model.instances[process][location]
            if is_open(participant)
        )
        for process, location in enumerate(discrete.locations)
    )


def _offer(model: Model, discrete: DiscreteState, participant: Participant) -> Offer:
    synchronisation = model.edge(participant).synchronisation
    if synchronisation is None:
        return Offer(participant, None, sends=False)
    channel = channel_number(synchronisation.channel, environment(model, discrete, participant))
    return Offer(participant, channel, synchronisation.direction is Direction.SEND)


def combinations(
    model: Model,
    discrete: DiscreteState,
    offered: Sequence[Sequence[Offer]],
    may_abstain: Callable[[Sequence[Offer]], bool],
) -> Iterator[Transition]:
    """The transitions that the offers allow and the committed rule admits.

    For a broadcast ``may_abstain`` says of a process's matching offers whether the process can also stay out.
    """
    for offer in (o for of_process in offered for o in of_process):
        if offer.channel is None:
            candidates: Iterator[Transition] = iter([Transition((offer.participant,))])
        elif not offer.sends:
            continue
        elif model.channels[offer.channel][0].broadcast:
            candidates = _broadcasts(offer, offered, may_abstain)
        else:
            candidates = _handshakes(offer, offered)
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
    return _offer(model, discrete, transition.participants[0]).channel


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
        edge = model.edge(participant)
        for variable, value in zip(edge.selects, participant.selects, strict=True):
            scratch.bind(variable, value)
        execute(edge.updates, scratch)
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
