"""A network with a question about it in Munta's words."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from tachk.api.plugin import (
    BOOL,
    Constant,
    Deadlock,
    Direction,
    Expression,
    Network,
    PreparedNetwork,
    Query,
    QueryKind,
    Span,
    Unary,
    UnaryOperator,
    VariableLayout,
    begun_clocks,
    prepare,
)
from tachk_munta.accommodation import add_ceilings, order_of_slots
from tachk_munta.actions import (
    ActionFinder,
    CaseEffect,
    Said,
    SelectedEdge,
    conflicting,
    constant_invariant,
    unsupported,
)
from tachk_munta.cases import CaseFinder, MuntaCase, case_finder
from tachk_munta.formula import (
    FALSE,
    Formula,
    FormulaFinder,
    TooManyAlternativesError,
    alternatives,
    has_clocks,
    slots_in,
    written,
)
from tachk_munta.network import IMPOSSIBLE, MuntaEdge, MuntaNames, MuntaNetwork, MuntaProcess, Variables


@dataclass(frozen=True, slots=True)
class MuntaModel:
    """Attributes:
    network: its formula asks for a state that the property forbids, or that it wants to be possible.
    asks_deadlock: the question is whether there is a deadlock, which an option of Munta asks instead of the formula.
    """

    network: MuntaNetwork
    asks_deadlock: bool


def to_muntax(network: Network, queries: Sequence[Query]) -> str:
    """The content of a .muntax file, with the question of the first query that a reachable state decides.

    Munta's files have one formula. Without such a query it asks for a state that no run reaches. Temporal formulas are
    left out: their observers have urgent channels.

    Raises UnsupportedError: E0803, with the place of the construct that Munta lacks.
    """
    reachability = (query for query in queries if query.target is not None and query.observer is None)
    query = next(reachability, Query("", QueryKind.POSSIBLY, Constant(0, BOOL)))
    return to_munta(network, query).network.text()


def to_munta(network: Network, query: Query, ranges: Mapping[int, tuple[int, int]] | None = None) -> MuntaModel:
    """The network, with the observer of the query if it has one, and the question for a state that decides the query.

    Args:
        ranges: for some slots a part of their range. The question is then also for whether they ever leave it.

    Raises UnsupportedError: E0803, with the place of the construct that Munta lacks.
    """
    if query.target is None:
        raise unsupported(
            f"`{query.kind}` with the meaning that it has here",
            query.span,
            "for Munta, runs never end and never wait for ever; only A[] and E<> mean the same",
        )
    _check_features(network)
    model = prepare(network)
    return _MuntaWriter(model, case_finder(model, ranges)).run(query.target, query.span)


def _check_features(network: Network) -> None:
    for process in network.processes:
        for location in process.locations:
            if location.rates:
                raise unsupported("clocks that stand still", location.rates[0][0].span)
        if process.priority != network.processes[0].priority:
            raise unsupported("priorities of processes", process.span)
    for variable in begun_clocks(network):
        raise unsupported("clocks that do not begin with 0", variable.span, "set the clock on the first edge")
    for variable in network.all_variables():
        if any(p != network.default_priority for p in variable.priorities):
            raise unsupported("priorities of channels", variable.span)


def is_deadlock(predicate: Expression) -> bool:
    """True if a predicate is `deadlock`, perhaps negated twice."""
    match predicate:
        case Unary(UnaryOperator.NOT, Unary(UnaryOperator.NOT, operand)):
            return is_deadlock(operand)
        case _:
            return isinstance(predicate, Deadlock)


@dataclass(slots=True)
class _MuntaWriter:
    model: PreparedNetwork
    finder: CaseFinder
    names: MuntaNames = field(default_factory=lambda: MuntaNames({"true", "none", IMPOSSIBLE[:-1]}))
    broadcast: list[str] = field(default_factory=list)
    outside: dict[tuple[int, int], int] = field(default_factory=dict)

    @property
    def layout(self) -> VariableLayout:
        return self.model.layout

    def run(self, target: Expression, span: Span) -> MuntaModel:
        processes = self._processes()
        self._synchronise(ActionFinder(self.model, self.finder), processes)
        asks_deadlock = is_deadlock(target)
        formula = FALSE if asks_deadlock else FormulaFinder(self.finder).formula(target)
        reached = self._goals(formula, processes, span) if has_clocks(formula) else []
        if has_clocks(formula):
            formula = FALSE
        if asks_deadlock:
            processes.append(self._pause())
        self._complete(formula, processes)
        add_ceilings(processes)
        places = tuple(tuple(process.used()) for process in processes)
        variables = self._variables(formula, processes)
        names = {
            (number, place): f"{process.name}.{process.locations[place]}"
            for number, process in enumerate(processes)
            for place in places[number]
        }
        reached += [(number, place) for (number, _), place in self.outside.items()]
        goals = [names[end] for end in reached if end in names]
        if formula != FALSE or not goals:
            goals.append(written(formula, names, variables))
        network = MuntaNetwork(tuple(processes), variables, tuple(self.broadcast), f"E<> {' || '.join(goals)}", places)
        return MuntaModel(network, asks_deadlock)

    # ---- processes --------------------------------------------------------------------------------------------------

    def _processes(self) -> list[MuntaProcess]:
        found = []
        for process in self.model.network.processes:
            own = MuntaNames()
            found.append(
                MuntaProcess(
                    self.names.fresh(process.name),
                    [own.fresh(location.name) for location in process.locations],
                    [
                        constant_invariant(location.invariant, location.span, self.finder)
                        for location in process.locations
                    ],
                    {n for n, location in enumerate(process.locations) if location.urgent or location.committed},
                    {n for n, location in enumerate(process.locations) if location.committed},
                    process.initial,
                )
            )
        return found

    # ---- synchronisation --------------------------------------------------------------------------------------------

    def _synchronise(self, finder: ActionFinder, processes: Sequence[MuntaProcess]) -> None:
        actions = [action for number in range(len(processes)) for action in finder.actions(number)]
        for action in actions:
            if action.direction is None:
                self._add(processes, action, action.cases, "")
        channels = {case.outcome.channel for action in actions for case in action.cases} - {None}
        for channel in sorted(c for c in channels if c is not None):
            senders = [a for a in actions if a.direction is Direction.SEND and a.over(channel)]
            receivers = [a for a in actions if a.direction is Direction.RECEIVE and a.over(channel)]
            type_, _ = self.model.channels[channel]
            if type_.urgent:
                raise unsupported("urgent channels", self._span(channel), "make a location urgent instead")
            if type_.broadcast:
                self._check_broadcast(channel, receivers)
                self._announce(finder, channel, senders, receivers, processes)
            elif conflicting(senders, receivers):
                self._join(finder, channel, senders, receivers, processes)
            else:
                name = self._channel_name(channel)
                for action in senders + receivers:
                    label = name + ("!" if action.direction is Direction.SEND else "?")
                    self._add(processes, action, _over(action, channel), label)

    def _span(self, channel: int) -> Span:
        slot = self.layout.channel_slots[channel]
        variables = self.model.network.all_variables()
        return max((v for v in variables if self.layout.first[v] <= slot), key=self.layout.first.__getitem__).span

    def _check_broadcast(self, channel: int, receivers: Sequence[SelectedEdge]) -> None:
        for receiver in receivers:
            if any(c != () for case in _over(receiver, channel) for c in case.outcome.guard):
                raise unsupported(
                    "clock guards on edges that receive a broadcast",
                    receiver.span,
                    "receive in any case, and decide on an edge behind a committed location",
                )
            for other in receivers:
                if other.participant.process != receiver.participant.process and other.written & receiver.read_before:
                    raise unsupported(
                        "receivers of a broadcast that read what another receiver may have written", receiver.span
                    )

    def _announce(
        self,
        finder: ActionFinder,
        channel: int,
        senders: Sequence[SelectedEdge],
        receivers: Sequence[SelectedEdge],
        processes: Sequence[MuntaProcess],
    ) -> None:
        """A broadcast channel for all that senders may have written which receivers need."""
        needed = frozenset(slot for receiver in receivers for slot in receiver.read_before)
        sent: dict[Said, list[tuple[SelectedEdge, MuntaCase[CaseEffect]]]] = {}
        for sender in senders:
            for case in _over(sender, channel):
                said = tuple((slot, value) for slot, value in case.outcome.writes if slot in needed)
                sent.setdefault(said, []).append((sender, case))
        for said, sendings in sent.items():
            name = self._channel_name(channel)
            self.broadcast.append(name)
            for sender, case in sendings:
                self._add(processes, sender, [case], f"{name}!")
            for receiver in receivers:
                cases = finder.receiving(receiver, channel, said)
                self._add(processes, receiver, cases, f"{name}?")

    def _join(
        self,
        finder: ActionFinder,
        channel: int,
        senders: Iterable[SelectedEdge],
        receivers: Sequence[SelectedEdge],
        processes: Sequence[MuntaProcess],
    ) -> None:
        """A channel for each pair whose receiver needs what the sender writes: the sender's edge does the work of both,
        for Munta lets the receiver write first."""
        for sender in senders:
            for receiver in receivers:
                one, other = sender.participant.process, receiver.participant.process
                if one == other:
                    continue
                cases = finder.together(sender, receiver, channel)
                if cases:
                    name = self._channel_name(channel)
                    self._add(processes, sender, cases, f"{name}!")
                    processes[other].edges.append(MuntaEdge(receiver.source, receiver.target, label=f"{name}?"))

    def _channel_name(self, channel: int) -> str:
        return self.names.fresh(self.layout.names[self.layout.channel_slots[channel]])

    def _add(
        self,
        processes: Sequence[MuntaProcess],
        action: SelectedEdge,
        cases: Iterable[MuntaCase[CaseEffect]],
        label: str,
    ) -> None:
        """Adds an edge for each case and alternative. It leads to a location of its own if a slot leaves its range."""
        number = action.participant.process
        for case in cases:
            writes = tuple((slot, value) for slot, value in case.outcome.writes if not self.layout.meta[slot])
            target = action.target
            if any(not low <= value <= high for slot, value in writes for low, high in [self.finder.range_of(slot)]):
                target, writes = self._outside(number, processes[number], target), ()
            processes[number].edges += (
                MuntaEdge(action.source, target, case.conditions, clocks, label, writes, case.outcome.resets)
                for clocks in case.outcome.guard
            )

    def _outside(self, number: int, process: MuntaProcess, target: int) -> int:
        """A location of a process that means: a slot has left its range on the way to a location. It has the invariant
        of that location, for without it more edges could be taken."""
        if (number, target) not in self.outside:
            self.outside[number, target] = process.added_location("outside")
            process.invariants[-1] = process.invariants[target]
        return self.outside[number, target]

    # ---- the question -----------------------------------------------------------------------------------------------

    def _goals(self, formula: Formula, processes: list[MuntaProcess], span: Span) -> list[tuple[int, int]]:
        """New locations that are reached from a state if and only if the formula, with clocks, is true in it.

        While a committed location is occupied its process must take the edge, else a process made for that does.
        """
        try:
            conjunctions = alternatives(formula)
        except TooManyAlternativesError:
            raise unsupported("conditions on clocks with so many alternatives", span) from None
        for number in sorted({-1 - slot for slot in slots_in(formula) if slot < 0}):
            process = processes[number]
            process.edges = [
                replace(e, writes=(*e.writes, (-1 - number, e.target)))
                if e.source != e.target and e.target < self.finder.sizes[number]
                else e
                for e in process.edges
            ]
        watch = MuntaProcess(self.names.fresh("Goal"), ["watching", "reached"], [(), ()], set(), set(), 0, added=(0,))
        watch.edges += [MuntaEdge(0, 1, conditions, clocks) for conditions, clocks in conjunctions]
        reached = [(len(processes), 1)]
        for number, process in enumerate(processes):
            if process.committed:
                place = process.added_location("reached")
                reached.append((number, place))
                process.edges += [
                    MuntaEdge(source, place, conditions, clocks)
                    for source in sorted(process.committed)
                    for conditions, clocks in conjunctions
                    if all(c.low <= source <= c.high for c in conditions if c.slot == -1 - number)
                ]
        processes.append(watch)
        return reached

    def _pause(self) -> MuntaProcess:
        """A process that can act once, at any time. For Munta, a deadlock is a state right after a transition, while it
        may also be reached by waiting for tachk. After a pause there is no difference, before it no deadlock."""
        name = self.names.fresh("Pause")
        pause = MuntaProcess(name, ["before", "after"], [(), ()], set(), set(), 0, added=(0, 1))
        pause.edges.append(MuntaEdge(0, 1))
        return pause

    # ---- variables --------------------------------------------------------------------------------------------------

    def _complete(self, formula: Formula, processes: Sequence[MuntaProcess]) -> None:
        """Adds edges that are never taken, for Munta knows only what edges name."""
        for process in processes:
            if all(edge.source != process.initial for edge in process.edges):
                process.edges.append(MuntaEdge(process.initial, process.initial, label=IMPOSSIBLE))
        named = {c.slot for process in processes for edge in process.edges for c in edge.conditions}
        named |= {slot for process in processes for edge in process.edges for slot, _ in edge.writes}
        first = processes[0]
        for slot in sorted(slot for slot in slots_in(formula) - named if slot >= 0):
            first.edges.append(
                MuntaEdge(first.initial, first.initial, label=IMPOSSIBLE, writes=((slot, self.layout.initial[slot]),))
            )

    def _variables(self, formula: Formula, processes: Sequence[MuntaProcess]) -> Variables:
        edges = [edge for process in processes for edge in process.edges]
        read = {c.slot for edge in edges for c in edge.conditions} | {slot for slot in slots_in(formula) if slot >= 0}
        constraints = [c for edge in edges for c in edge.clocks]
        constraints += [c for process in processes for invariant in process.invariants for c in invariant]
        clocks = tuple(sorted({i or j for i, j, _ in constraints}))
        slots = order_of_slots(processes, read)
        initial = [process.initial for process in processes]
        return Variables(
            slots,
            clocks,
            {c: self.names.fresh(self.layout.names[c] if c >= 0 else f"at {processes[-1 - c].name}") for c in slots},
            {clock: self.names.fresh(self.layout.names[self.layout.clock_slots[clock - 1]]) for clock in clocks},
            {c: self.layout.initial[c] if c >= 0 else initial[-1 - c] for c in slots},
            {c: self.finder.range_of(c) for c in slots},
        )


def _over(action: SelectedEdge, channel: int) -> list[MuntaCase[CaseEffect]]:
    return [case for case in action.cases if case.outcome.channel == channel]
