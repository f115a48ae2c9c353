"""The observer of a scenario.

It counts the events of the scenario (Damm, Harel, "LSCs: Breathing Life into Message Sequence Charts", 2001, call that
the cut of a chart). It hears the channels that the scenario names, and everything that happens there has to be the next
event; otherwise it is lost and lets no more time pass. It never keeps the network from a step, so urgent channels and
committed locations mean what they mean without it.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from functools import reduce
from itertools import zip_longest
from operator import or_

from tachk.base.records import dataclass
from tachk.model.builder import ProcessBuilder, Term, conditional
from tachk.model.expressions import BOOL, Constant, Expression, Index, Reference, Variable, VariableKind
from tachk.model.query import JoinedChannel, Observer
from tachk.model.types import ArrayType, BoolType, ChannelType, IntType, element_type, slot_count


@dataclass(frozen=True, slots=True)
class ObservedChannel:
    """``place`` counts the channels of an array."""

    variable: Variable
    place: int


@dataclass(frozen=True, slots=True)
class ScenarioEvent:
    """Attributes:
    channels: on which the event may happen; empty: nothing happens for `earliest`.
    earliest, latest: since the event before; None: no upper bound.
    """

    channels: tuple[ObservedChannel, ...]
    earliest: int
    latest: int | None
    condition: Expression | None


def scenario_observer(
    name: str, events: Sequence[ScenarioEvent], also: Sequence[ObservedChannel]
) -> tuple[Observer, Expression]:
    """The observer of a scenario, and the condition that all of its events have happened.

    Args:
        name: of its process.
        also: channels that it hears beside those of the events.
    """
    builder = _ObserverBuilder(name, events, also)
    return builder.build(), builder.reached()


class _ObserverBuilder:
    """The observer of a scenario of n events: `at` counts those that have happened, n + 1 is lost.

    Attributes:
        ripe: the next event is not too early.
        since: the clock since the event before.
    """

    def __init__(self, name: str, steps: Sequence[ScenarioEvent], also: Sequence[ObservedChannel]) -> None:
        self.steps = steps
        named = [channel for step in steps for channel in step.channels]
        self.observed = tuple(dict.fromkeys((*named, *also)))
        self.lost = len(steps) + 1
        self._arrays: dict[str, Term] = {}
        self.process = ProcessBuilder(f"{name}.", VariableKind.LOCAL, name=name)
        self.at = self.process.integer("at", 0, self.lost)
        self.ripe = self.process.boolean("ripe", self._at_once(0))
        self.agrees = self.process.boolean("agrees", False)
        self.element = self.process.integer("element", -1, len(self.observed) - 1, -1)
        self.since = self.process.clock("since")

    def reached(self) -> Expression:
        return (self.at == len(self.steps)).expression

    def build(self) -> Observer:
        steps, process = self.steps, self.process
        latest = [step.earliest if not step.channels else step.latest for step in steps]
        bounded = [*(bound is not None for bound in latest), False, True]
        upper = self._table("latest", [*(bound or 0 for bound in latest), 0, 0])
        lower = self._table("earliest", [*(step.earliest for step in steps), 0, 0])
        here = process.location(
            "following",
            (~self._flags("bounded", bounded) | (self.since <= upper)) & (self.ripe | (self.since <= lower)),
        )
        silent = self._flags("silent", [*(not step.channels for step in steps), False, False])
        due = ~self.ripe & (self.since >= lower)
        process.edge(here, here, guard=due & ~silent, updates=[self.ripe.assign(True)])
        if any(not step.channels for step in steps):
            updates = [self.at.assign(self.at + 1), self._ripens(), self.since.assign(0)]
            process.edge(here, here, guard=due & silent, updates=updates)
        joined: dict[Variable, list[int]] = {}
        for number, channel in enumerate(self.observed):
            type_ = element_type(channel.variable.type)
            if isinstance(type_, ChannelType) and type_.broadcast:
                receive = Term(_channel(Reference(channel.variable), channel.place))
                process.edge(here, here, receive=receive, updates=self._updates(number, [channel]))
            else:
                places = [-1] * slot_count(channel.variable.type)
                joined.setdefault(channel.variable, places)[channel.place] = number
        own = [channel for channel in self.observed if channel.variable in joined]
        updates = [*self._updates(self.element, own), self.element.assign(-1)] if joined else []
        channels = tuple(
            JoinedChannel(
                variable,
                _variable(self.element),
                _variable(self._array(f"numbers of {variable.name}", IntType(-1, max(numbers)), numbers)),
                tuple(update.expression for update in updates),
            )
            for variable, numbers in joined.items()
        )
        return Observer(process.build(), 0, "", joined=channels)

    def _at_once(self, step: int) -> bool:
        """True if a step may come at the time of the one before; after the last one nothing is too early."""
        return step >= len(self.steps) or (self.steps[step].earliest == 0 and bool(self.steps[step].channels))

    def _ripens(self) -> Term:
        return self.ripe.assign(self._flags("instant", [self._at_once(n) for n in range(self.lost + 1)]))

    def _updates(self, number: Term | int, among: Collection[ObservedChannel]) -> list[Term]:
        """An event happens on one of some channels."""
        agrees = self.ripe & self._expected(number)
        conditions = self._conditions(among)
        if conditions is not None:
            agrees = agrees & conditions
        return [
            self.agrees.assign(agrees),
            self.at.assign(conditional(self.agrees, self.at + 1, self.lost)),
            self._ripens(),
            self.since.assign(0),
            self.agrees.assign(False),
        ]

    def _expected(self, number: Term | int) -> Term:
        """The next event may be on the channel with this number.

        Steps with the same channels share a number above 0, so that no table grows with the events and the channels.
        """
        different = list(dict.fromkeys(step.channels for step in self.steps))
        which = self._table("channels", [*(1 + different.index(step.channels) for step in self.steps), 0, 0])
        if not isinstance(number, int):
            rows = [channel in channels for channels in ((), *different) for channel in self.observed]
            return self._flags("expected", rows, which * len(self.observed) + number)
        parts = [which == place for place, channels in enumerate(different, 1) if self.observed[number] in channels]
        return reduce(or_, parts) if parts else Term(Constant(0, BOOL))

    def _conditions(self, among: Collection[ObservedChannel]) -> Term | None:
        """The condition of the next event is true if it is on one of these channels; None if there are none."""
        different = list(dict.fromkeys(step.condition for step in self.steps if step.condition is not None))
        numbers = [0 if step.condition is None else 1 + different.index(step.condition) for step in self.steps]
        which = self._table("condition", [*numbers, 0, 0])
        used = {step.condition for step in self.steps if not set(among).isdisjoint(step.channels)}
        parts = [(which != number) | Term(each) for number, each in enumerate(different, 1) if each in used]
        while len(parts) > 1:  # as flat as can be: there may be hundreds
            pairs = zip_longest(parts[::2], parts[1::2])
            parts = [left if right is None else left & right for left, right in pairs]
        return parts[0] if parts else None

    def _flags(self, name: str, values: Sequence[bool], place: Term | None = None) -> Term:
        return self._array(name, BOOL, [int(value) for value in values])[self.at if place is None else place]

    def _table(self, name: str, values: Sequence[int]) -> Term:
        return self._array(name, IntType(min(values), max(values)), values)[self.at]

    def _array(self, name: str, type_: IntType | BoolType, values: Sequence[int]) -> Term:
        """A constant array."""
        if name not in self._arrays:
            self._arrays[name] = self.process.declare(name, ArrayType(type_, IntType(0, len(values) - 1)), values)
        return self._arrays[name]


def _variable(term: Term) -> Variable:
    assert isinstance(term.expression, Reference)
    return term.expression.variable


def _channel(channel: Expression, place: int) -> Expression:
    """The channel with this place among those of an array."""
    if not isinstance(channel.type, ArrayType):
        return channel
    size = slot_count(channel.type.element)
    index = Constant(channel.type.low + place // size)
    return _channel(Index(channel, index, channel.type.element), place % size)
