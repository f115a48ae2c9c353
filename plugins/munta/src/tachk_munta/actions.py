"""The effects of edges in the only form that Munta has: conditions on single variables and clocks, constants to assign.

Each edge, with its select variables bound, is evaluated by the reference evaluator for all contents of the variables
that it reads. So functions, arrays and arithmetic need no words in Munta.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import product

from tachk.api.plugin import (
    Conjunction,
    Diagnostic,
    Direction,
    Disjunction,
    Environment,
    Expression,
    Participant,
    PreparedNetwork,
    Span,
    UnsupportedError,
    bind_selects,
    bound_value,
    channel_named,
    conditional_constraints,
    execute,
    is_strict,
)
from tachk_munta.cases import CaseFinder, KnownContents, MuntaCase, TooManyCasesError

Said = tuple[tuple[int, int], ...]
"""Slots with the values that a sender has written into them."""


def unsupported(what: str, span: Span, help_: str | None = None) -> UnsupportedError:
    return UnsupportedError(Diagnostic("E0803", f"Munta has no {what}", span, help_))


@dataclass(frozen=True, slots=True)
class CaseEffect:
    """The effect of an edge in one case.

    Attributes:
        guard: on clocks.
        channel: the number of the channel; None for an internal edge.
        writes: slots with their new content.
        resets: the clocks that become 0.
    """

    guard: Disjunction
    channel: int | None
    writes: tuple[tuple[int, int], ...]
    resets: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class SelectedEdge:
    """An edge with its select variables bound.

    Attributes:
        direction: None for an internal edge.
        read_before: the slots whose content the updates read from before the transition.
    """

    participant: Participant
    source: int
    target: int
    direction: Direction | None
    span: Span
    cases: tuple[MuntaCase[CaseEffect], ...]
    read_before: frozenset[int]

    @property
    def written(self) -> frozenset[int]:
        return frozenset(slot for case in self.cases for slot, _ in case.outcome.writes)

    def over(self, channel: int) -> bool:
        return any(case.outcome.channel == channel for case in self.cases)


@dataclass(frozen=True, slots=True)
class ActionFinder:
    """The effects of the edges of a network."""

    model: PreparedNetwork
    finder: CaseFinder

    def actions(self, process: int) -> list[SelectedEdge]:
        """The effects of the edges of a process. Raises UnsupportedError."""
        return [self._action(p) for of_location in self.model.instances[process] for p in of_location]

    def together(self, sender: SelectedEdge, receiver: SelectedEdge, channel: int) -> tuple[MuntaCase[CaseEffect], ...]:
        """The joint effect of a sender and a receiver over a channel: the receiver sees what the sender has written."""

        def outcome(environment: Environment, contents: KnownContents) -> CaseEffect | None:
            pair = (sender.participant, receiver.participant)
            guard: Disjunction = [()]
            for participant in pair:
                bind_selects(self.model, participant, environment)
                own = self._guard(participant, environment)
                if not own or channel_named(self.model, participant, environment) != channel:
                    return None
                guard = [_tightest(one + other) for one in guard for other in own]
            for participant in pair:
                bind_selects(self.model, participant, environment)
                execute(self.model.edge(participant).updates, environment)
            return self._effect(guard, channel, environment, contents, sender.span)

        return self._found(outcome, sender.span)

    def receiving(self, receiver: SelectedEdge, channel: int, said: Said) -> tuple[MuntaCase[CaseEffect], ...]:
        """The effect of a receiver after the sender of a broadcast has written variables."""
        read_before: set[int] = set()
        cases = self._cases(receiver.participant, said, read_before)
        return tuple(case for case in cases if case.outcome.channel == channel)

    def _action(self, participant: Participant) -> SelectedEdge:
        edge = self.model.edge(participant)
        read_before: set[int] = set()
        cases = self._cases(participant, (), read_before)
        direction = None if edge.synchronisation is None else edge.synchronisation.direction
        return SelectedEdge(
            participant, edge.source, edge.target, direction, edge.spans[0], cases, frozenset(read_before)
        )

    def _cases(self, participant: Participant, said: Said, read_before: set[int]) -> tuple[MuntaCase[CaseEffect], ...]:
        """The effect of an edge, if its updates find slots with other contents than its guard did; collects what they
        read."""
        edge = self.model.edge(participant)

        def outcome(environment: Environment, contents: KnownContents) -> CaseEffect | None:
            bind_selects(self.model, participant, environment)
            guard = self._guard(participant, environment)
            if not guard:
                return None
            channel = channel_named(self.model, participant, environment)
            for slot, value in said:
                contents.settle(slot, value)
            contents.read.clear()
            try:
                execute(edge.updates, environment)
            finally:
                read_before.update(contents.read)
            return self._effect(guard, channel, environment, contents, edge.spans[0])

        return self._found(outcome, edge.spans[0])

    def _found(
        self, outcome: Callable[[Environment, KnownContents], CaseEffect | None], span: Span
    ) -> tuple[MuntaCase[CaseEffect], ...]:
        try:
            return tuple(self.finder.find(outcome))
        except TooManyCasesError as error:
            name = self.model.layout.names[error.slot]
            raise too_many_cases(name, self.finder.range_of(error.slot), span) from None

    def _guard(self, participant: Participant, environment: Environment) -> Disjunction:
        edge = self.model.edge(participant)
        return clock_conjunctions(conditional_constraints(edge.guard, environment), edge.spans[0])

    def _effect(
        self, guard: Disjunction, channel: int | None, environment: Environment, contents: KnownContents, span: Span
    ) -> CaseEffect:
        layout = self.model.layout
        writes = tuple((slot, list.__getitem__(contents, slot)) for slot in sorted(contents.written))
        for clock, (source, value) in environment.resets.items():
            if source or value:
                name = layout.names[layout.clock_slots[clock - 1]]
                what = "the value of a clock" if source else value
                raise unsupported(f"clocks that are set to another value than 0, here `{name}` to {what}", span)
        return CaseEffect(guard, channel, writes, tuple(sorted(environment.resets)))


def too_many_cases(name: str, range_: tuple[int, int], span: Span) -> UnsupportedError:
    low, high = range_
    return unsupported(
        f"expressions over several variables, and here are too many cases to list them one by one: `{name}` is one of "
        f"what is read",
        span,
        f"declare a smaller range than [{low}, {high}], or read less on one edge",
    )


def clock_conjunctions(disjunction: Disjunction, span: Span) -> Disjunction:
    """A guard without conditions that are always true and without alternatives that are never true.

    Raises UnsupportedError for a difference of two clocks.
    """
    found = []
    for conjunction in disjunction:
        uncertain = [constraint for constraint in conjunction if not _is_certain(*constraint)]
        if any(i and j for i, j, _ in uncertain):
            raise unsupported("comparisons of two clocks", span)
        if not any(i and (bound_value(raw), not is_strict(raw)) < (0, True) for i, _, raw in uncertain):
            found.append(_tightest(tuple(uncertain)))
    return found


def _is_certain(i: int, _: int, raw: int) -> bool:
    """True if a constraint says no more than that a clock is not negative."""
    return not i and raw >= 1


def _tightest(conjunction: Conjunction) -> Conjunction:
    """One constraint for each pair of clocks."""
    tightest: dict[tuple[int, int], int] = {}
    for i, j, raw in conjunction:
        tightest[i, j] = min(raw, tightest.get((i, j), raw))
    return tuple((i, j, raw) for (i, j), raw in tightest.items())


def constant_invariant(invariant: Expression | None, span: Span, finder: CaseFinder) -> Conjunction:
    """The constraints of an invariant of the location at a place. Raises UnsupportedError."""
    place = span if invariant is None else invariant.span

    def outcome(environment: Environment, contents: KnownContents) -> Disjunction:
        return clock_conjunctions(conditional_constraints(invariant, environment), place)

    try:
        cases = finder.find(outcome)
    except TooManyCasesError:
        cases = []
    if len(cases) != 1 or cases[0].conditions:
        raise unsupported("invariants that depend on variables", place, "make several locations of it")
    if len(cases[0].outcome) != 1:
        raise unsupported("invariants with alternatives", place, "make several locations of it")
    return cases[0].outcome[0]


def conflicting(
    senders: Iterable[SelectedEdge], receivers: Sequence[SelectedEdge]
) -> tuple[SelectedEdge, SelectedEdge] | None:
    """A sender and a receiver for which the order of their updates matters."""
    for sender, receiver in product(senders, receivers):
        if sender.participant.process != receiver.participant.process:
            if sender.written & (receiver.written | receiver.read_before):
                return sender, receiver
    return None
