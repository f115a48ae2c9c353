"""Random networks and predicates, for tests of engines against each other.

`random_case` draws from a `random.Random`, so a seed names a case.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from random import Random

from tachk.model.builder import (
    LocationHandle,
    NetworkBuilder,
    ProcessBuilder,
    Term,
    bound_variable,
    conditional,
    deadlock,
)
from tachk.model.expressions import Constant, Expression
from tachk.model.network import Network
from tachk.model.random_language import TOP, Language, random_copy, random_language
from tachk.model.types import IntType

INTEGER_TOP = TOP
"""The integers of random networks range over ``[0, INTEGER_TOP]``."""


@dataclass(frozen=True, slots=True)
class Shape:
    """Parameters of random networks.

    Attributes:
        processes, locations, clocks: the largest number of each (locations for each process).
        constant: the largest constant clocks are compared with or set to, in units.
        unit: by which all times are multiplied.
        uneven: times may be one more or less than a multiple of the unit.
        predicates: how many are drawn for each network.
        strict: constraints with ``<`` and ``>``.
        diagonals: guards that compare two clocks.
        priorities: of channels and processes.
        stopwatches: locations that stop clocks.
        urgent_channels, broadcast, committed: whether they occur.
        clocks_on_urgent: clock guards on edges that decide when a synchronisation over an urgent channel is enabled.
        clocks_on_broadcast: clock guards on edges that receive a broadcast.
        lower_invariants: invariants with lower bounds.
        deadlocks: predicates that ask for deadlock.
        receivers: the largest number of further processes that only receive and change little of the others.
        blockers: how many further processes do the same but may also hinder the others, and talk to each other.
        companions: the largest number of further processes with a clock of their own that mostly move before their
            invariants end, and at once where time stands still.
        own_data: how often a process has clocks and variables that no other process uses, and few others.
        exact: how often a guard asks for one exact value of a clock, so that events fall on the bounds of others; with
            ``diagonals`` invariants compare two clocks.
        hurried: the share of the locations that are urgent or committed.
        groups: how many groups of processes there are with variables, clocks and channels of their own, which hardly
            touch those of the others; not with ``language``.
        language: arrays, records, functions with loops and early returns, computed channels, conditional updates.
        copies: the share of updates that set a clock to the value of a clock.
        advances: such updates add to the value.
        starts: the share of the clocks that do not begin with 0.
        faults: in which share of the networks something can be a run-time error; needs ``language``.
    """

    processes: int = 3
    locations: int = 4
    clocks: int = 3
    constant: int = 4
    unit: int = 1
    uneven: bool = False
    predicates: int = 3
    strict: bool = True
    diagonals: bool = False
    priorities: bool = False
    stopwatches: bool = False
    urgent_channels: bool = True
    broadcast: bool = True
    committed: bool = True
    clocks_on_urgent: bool = False
    clocks_on_broadcast: bool = True
    lower_invariants: bool = True
    deadlocks: bool = True
    receivers: int = 0
    blockers: int = 0
    companions: int = 0
    own_data: float = 0.0
    exact: float = 0.0
    hurried: float = 0.2
    groups: int = 1
    copies: float = 0.0
    advances: bool = True
    starts: float = 0.0
    language: bool = False
    faults: float = 0.0


@dataclass(frozen=True, slots=True)
class RandomCase:
    network: Network
    predicates: tuple[Expression, ...]


@dataclass(slots=True)
class _NetworkParts:
    """The declarations of a network under construction."""

    clocks: list[Term]
    integers: list[Term]
    channels: list[tuple[Term, bool, bool, bool]]
    """channel, whether it is an array, broadcast, urgent"""
    scratch: Term
    """a meta variable"""
    language: Language | None = None


def random_case(random: Random, shape: Shape = Shape()) -> RandomCase:
    """A network that satisfies its invariants initially, with predicates on it that cannot fail.

    Nothing else can fail either, but in the share of networks that the shape says.
    """
    network = NetworkBuilder()
    if shape.groups > 1:
        return _groups(random, shape, network)
    parts = _declare(random, shape, network)
    if shape.language:
        may_fail = random.random() < shape.faults
        parts.language = random_language(random, network, parts.integers, parts.clocks, may_fail)
    handles: list[list[LocationHandle]] = []
    mentioned = parts
    for number in range(random.randint(2, max(2, shape.processes))):
        priority = random.randint(0, 1) if shape.priorities else 0
        process = network.process(f"P{number}", priority)
        used = parts
        if shape.own_data and random.random() < shape.own_data:
            used = _own(random, shape, parts, process)
            clocks, integers = [*mentioned.clocks, *used.clocks], [*mentioned.integers, *used.integers]
            mentioned = replace(mentioned, clocks=clocks, integers=integers)
        handles.append(_locations(random, shape, used, process))
        for source in handles[-1]:
            for _ in range(random.choice((1, 2, 2, 3, 3))):
                _edge(random, shape, used, process, source, random.choice(handles[-1]))
    for number in range(random.randint(1, shape.receivers) if shape.receivers else 0):
        _receiver(random, shape, parts, network.process(f"S{number}"))
    if shape.blockers:
        _blockers(random, shape, parts, network)
    for number in range(random.randint(1, shape.companions) if shape.companions else 0):
        _companion(random, parts, network.process(f"C{number}"))
    predicates = tuple(_predicate(random, shape, mentioned, handles).expression for _ in range(shape.predicates))
    return RandomCase(network.build(), predicates)


def _groups(random: Random, shape: Shape, network: NetworkBuilder) -> RandomCase:
    """Most edges can be taken, so that there is much to leave out."""
    declared = [_declare(random, shape, network, prefix=f"g{number}_") for number in range(shape.groups)]
    predicates = []
    for group, parts in enumerate(declared):
        other = random.choice(declared)
        mixed = replace(parts, integers=parts.integers + other.integers, channels=parts.channels + other.channels)
        handles: list[list[LocationHandle]] = []
        for number in range(random.randint(1, shape.processes)):
            process = network.process(f"P{group}_{number}")
            handles.append(_locations(random, shape, parts, process, limited=0.15))
            for place, source in enumerate(handles[-1]):
                if random.random() < 0.15:
                    _edge(random, shape, parts, process, source, random.choice(handles[-1]))
                following = handles[-1][(place + 1) % len(handles[-1])]
                for target in (following, *random.sample(handles[-1], random.randint(0, 1))):
                    _easy_edge(random, shape, mixed if random.random() < 0.05 else parts, process, source, target)
        predicate = random.choice(handles[-1]).reached & _integer_condition(random, parts.integers)
        if random.random() < 0.3:
            predicate = predicate & _clock_condition(random, shape, parts)
        predicates.append(predicate.expression)
    return RandomCase(network.build(), tuple(predicates))


def _easy_edge(
    random: Random,
    shape: Shape,
    parts: _NetworkParts,
    process: ProcessBuilder,
    source: LocationHandle,
    target: LocationHandle,
) -> None:
    channel, array, broadcast, _ = random.choice(parts.channels)
    named = channel[random.randint(0, 1)] if array else channel
    syncs = random.random()
    guard = None
    if syncs > 0.3:
        kind = random.random()
        guard = random.choice(parts.clocks) >= random.randint(0, 2) if kind < 0.2 else guard
        guard = _integer_condition(random, parts.integers) if kind > 0.8 else guard
    process.edge(
        source,
        target,
        guard=guard,
        send=named if syncs < 0.15 or (broadcast and syncs < 0.25) else None,
        receive=named if 0.25 <= syncs < 0.3 else None,
        updates=[_update(random, shape, parts, []) for _ in range(random.choice((0, 1, 1)))],
    )


def _declare(random: Random, shape: Shape, network: NetworkBuilder, prefix: str = "") -> _NetworkParts:
    clocks = [network.clock(f"{prefix}x{i}", _start(random, shape)) for i in range(random.randint(1, shape.clocks))]
    integers = [network.integer(f"{prefix}n{i}", 0, INTEGER_TOP) for i in range(random.randint(1, 2))]
    scratch = network.integer(f"{prefix}scratch", 0, INTEGER_TOP, initial=1, meta=True)
    channels = []
    for i in range(random.randint(1, 3)):
        broadcast = shape.broadcast and random.random() < 0.4
        urgent = shape.urgent_channels and random.random() < 0.25
        array = random.random() < 0.25
        priority = random.randint(-1, 1) if shape.priorities else None
        channels.append(
            (
                network.channel(f"{prefix}c{i}", broadcast, urgent, priority, size=2 if array else 0),
                array,
                broadcast,
                urgent,
            )
        )
    return _NetworkParts(clocks, integers, channels, scratch)


def _start(random: Random, shape: Shape) -> int:
    """The initial value of a clock."""
    if not shape.starts or random.random() >= shape.starts:
        return 0
    return _time(random, shape, random.randint(1, shape.constant))


def _own(random: Random, shape: Shape, parts: _NetworkParts, process: ProcessBuilder) -> _NetworkParts:
    """Clocks and variables of a process, and now and then one that others use, too."""
    clocks = [process.clock(f"y{i}", _start(random, shape)) for i in range(random.randint(1, 2))]
    integers = [process.integer("m", 0, INTEGER_TOP)]
    if random.random() < 0.15:
        clocks.append(random.choice(parts.clocks))
    if random.random() < 0.3:
        integers.append(random.choice(parts.integers))
    return replace(parts, clocks=clocks, integers=integers)


def _time(random: Random, shape: Shape, units: int) -> int:
    if shape.uneven and units:
        return units * shape.unit + random.randint(-1, 1)
    return units * shape.unit


def _computed(shape: Shape, units: Term) -> Term:
    return units if shape.unit == 1 else units * shape.unit


def _receiver(random: Random, shape: Shape, parts: _NetworkParts, process: ProcessBuilder) -> None:
    clock, number = process.clock("age"), process.integer("seen", 0, INTEGER_TOP)
    own = replace(parts, clocks=[*parts.clocks, clock], integers=[*parts.integers, number])
    received = [(channel, array) for channel, array, broadcast, _ in parts.channels if broadcast]
    locations = [process.location(f"L{i}") for i in range(random.randint(2, 3))]
    for source in locations:
        for _ in range(random.randint(1, 2)):
            receive = None
            if received and random.random() < 0.6:
                channel, array = random.choice(received)
                receive = channel[random.randint(0, 1)] if array else channel
            guard = _guard(random, shape, own, [], with_clocks=receive is None)
            updates = [random.choice([clock.assign(0), number.assign((number + 1) % (INTEGER_TOP + 1))])]
            if random.random() < 0.05:
                updates.append(_update(random, shape, parts, []))
            process.edge(source, random.choice(locations), guard=guard, receive=receive, updates=updates)


def _blockers(random: Random, shape: Shape, parts: _NetworkParts, network: NetworkBuilder) -> None:
    """Processes with clocks, variables and channels of their own that also listen to the others."""
    own = _declare(random, shape, network, prefix="own_")
    received = [channel for channel in parts.channels if channel[2] or random.random() < 0.2]
    reads = replace(own, integers=[*own.integers, *parts.integers])
    for number in range(shape.blockers):
        process = network.process(f"B{number}")
        locations = _locations(random, shape, own, process)
        for source in locations:
            for _ in range(random.randint(1, 2)):
                if received and random.random() < 0.4:
                    channel, array, _, urgent = random.choice(received)
                    receive = channel[random.randint(0, 1)] if array else channel
                    updates = [_update(random, shape, own, [])] if random.random() < 0.5 else []
                    guard = _guard(random, shape, reads, [], with_clocks=not urgent)
                    process.edge(source, random.choice(locations), guard=guard, receive=receive, updates=updates)
                else:
                    _edge(random, shape, own, process, source, random.choice(locations))


def _companion(random: Random, parts: _NetworkParts, process: ProcessBuilder) -> None:
    clock = process.clock("age")
    received = [(channel, array) for channel, array, broadcast, _ in parts.channels if broadcast]
    ends = [random.randint(0, 3) for _ in range(random.randint(2, 3))]
    waiting = [random.random() < 0.6 for _ in ends]
    locations = [
        process.location(f"L{n}", invariant=clock <= end)
        if waits
        else process.location(f"L{n}", urgent=random.random() < 0.2, committed=random.random() < 0.2)
        for n, (end, waits) in enumerate(zip(ends, waiting, strict=True))
    ]
    for source, end in zip(locations, ends, strict=True):
        low = clock >= (end if random.random() < 0.8 else random.randint(0, 3))
        split = random.choice(parts.integers) == random.randint(0, 2)
        guards = random.choice([[low], [low & split, low & ~split], [split], [split, ~split], [low & split]])
        for guard in guards:
            resets = [clock.assign(0)] if random.random() < 0.8 else []
            process.edge(source, random.choice(locations), guard=guard, updates=resets)
        if received and random.random() < 0.4:
            channel, array = random.choice(received)
            resets = [clock.assign(0)] if random.random() < 0.8 else []
            receive = channel[random.randint(0, 1)] if array else channel
            process.edge(source, random.choice(locations), receive=receive, updates=resets)


def _locations(
    random: Random, shape: Shape, parts: _NetworkParts, process: ProcessBuilder, limited: float = 1.0
) -> list[LocationHandle]:
    handles = []
    for number in range(random.randint(2, shape.locations)):
        kind = random.random()
        stopped = [c for c in parts.clocks if shape.stopwatches and random.random() < 0.2]
        handles.append(
            process.location(
                f"L{number}",
                _invariant(random, shape, parts, initial=number == 0) if limited == 1 or kind > 1 - limited else None,
                urgent=kind < shape.hurried / 2,
                committed=shape.committed and shape.hurried / 2 <= kind < shape.hurried,
                rates=[(c, 0 if random.random() < 0.7 else conditional(parts.integers[0] == 0, 1, 0)) for c in stopped],
            )
        )
    return handles


def _invariant(random: Random, shape: Shape, parts: _NetworkParts, initial: bool) -> Term | None:
    if random.random() < 0.6:
        return None
    clock = random.choice(parts.clocks)
    bound = _time(random, shape, random.randint(1, shape.constant))
    result = clock < bound if shape.strict and random.random() < 0.4 else clock <= bound
    kind = random.random()
    if kind < 0.15:
        return (random.choice(parts.integers) == 0) | result
    if kind < 0.25:
        number = random.choice(parts.integers)
        value = number if initial or parts.language is None else parts.language.value()
        return clock <= _computed(shape, value + 1)
    if shape.exact and shape.diagonals and len(parts.clocks) > 1 and random.random() < 0.4:
        difference = random.choice(parts.clocks[1:]) - parts.clocks[0]
        return result & (difference <= _time(random, shape, random.randint(0, 2)))
    if kind < 0.35 and shape.lower_invariants and not initial:
        low = _time(random, shape, random.randint(0, 2))
        return result & (random.choice(parts.clocks) >= low)
    return result


def _edge(
    random: Random,
    shape: Shape,
    parts: _NetworkParts,
    process: ProcessBuilder,
    source: LocationHandle,
    target: LocationHandle,
) -> None:
    selects = [bound_variable("i", IntType(0, 1))] if random.random() < 0.2 else []
    send, receive, with_clocks = None, None, True
    if random.random() < 0.5:
        channel, array, broadcast, urgent = random.choice(parts.channels)
        if array:
            index: Term | int = selects[0] if selects and random.random() < 0.6 else random.randint(0, 1)
            if parts.language is not None and random.random() < 0.5:
                index = parts.language.channel_index()
            channel = channel[index]
        if random.random() < 0.5:
            send = channel
            with_clocks = shape.clocks_on_urgent or not urgent
        else:
            receive = channel
            # A broadcast over an urgent channel is urgent for all receivers.
            with_clocks = shape.clocks_on_broadcast if broadcast else shape.clocks_on_urgent or not urgent
    guard = None if random.random() < 0.2 else _guard(random, shape, parts, selects, with_clocks)
    updates = [_update(random, shape, parts, selects) for _ in range(random.choice((0, 1, 1, 1, 2, 2)))]
    process.edge(source, target, guard=guard, send=send, receive=receive, updates=updates, selects=selects)


def _guard(
    random: Random, shape: Shape, parts: _NetworkParts, selects: Sequence[Term], with_clocks: bool
) -> Term | None:
    conditions: list[Term] = []
    if random.random() < 0.25:
        conditions.append(_integer_condition(random, [*parts.integers, *selects]))
    if parts.language is not None and random.random() < 0.35:
        conditions.append(parts.language.condition())
    if with_clocks and shape.exact and random.random() < shape.exact:
        conditions.append(random.choice(parts.clocks) == _time(random, shape, random.randint(0, shape.constant)))
    if with_clocks:
        for _ in range(random.choice((0, 0, 1, 1, 1, 2))):
            condition = _clock_condition(random, shape, parts, parts.language)
            kind = random.random()
            if kind < 0.08:
                condition = _integer_condition(random, parts.integers) | condition
            elif kind < 0.14:
                condition = _integer_condition(random, parts.integers).implies(condition)
            elif kind < 0.2 and shape.strict:
                condition = ~condition
            conditions.append(condition)
    if parts.language is not None:
        random.shuffle(conditions)
    if not conditions:
        return None
    result = conditions[0]
    for condition in conditions[1:]:
        result = result & condition
    return result


def _integer_condition(random: Random, integers: Sequence[Term]) -> Term:
    number = random.choice(integers)
    value = random.randint(0, INTEGER_TOP)
    return random.choice([number == value, number != value, number < value + 1, number >= value])


def _clock_condition(random: Random, shape: Shape, parts: _NetworkParts, language: Language | None = None) -> Term:
    """A comparison whose negation is not a disjunction."""
    left: Term = random.choice(parts.clocks)
    units = random.randint(0, shape.constant)
    if shape.diagonals and len(parts.clocks) > 1 and random.random() < 0.35:
        left = left - random.choice([c for c in parts.clocks if c is not left])
        bound: Term | int = _time(random, shape, random.randint(-2, 2))
    elif random.random() < 0.15:
        number = random.choice(parts.integers)
        bound = _computed(shape, (number if language is None else language.bound()) + random.randint(0, 1))
    else:
        bound = _time(random, shape, units)
    choices = [left <= bound, left >= bound]
    if shape.strict:
        choices += [left < bound, left > bound]
    return random.choice(choices)


def _update(random: Random, shape: Shape, parts: _NetworkParts, selects: Sequence[Term]) -> Term:
    if parts.language is not None and random.random() < 0.4:
        return parts.language.update()
    if shape.copies and random.random() < shape.copies:

        def offset() -> Term | int:
            if parts.language is not None and random.random() < 0.5:
                return parts.language.value(1) - (random.randint(0, 1) if parts.language.may_fail else 0)
            number = random.choice(parts.integers) if random.random() < 0.3 else Term(Constant(random.randint(0, 2)))
            return _computed(shape, number) if shape.advances else 0

        return random_copy(random, parts.clocks, lambda: _integer_condition(random, parts.integers), offset)
    kind = random.random()
    clock, number = random.choice(parts.clocks), random.choice(parts.integers)
    if kind < 0.45:
        return clock.assign(0)
    if kind < 0.55:
        return clock.assign(_time(random, shape, random.randint(1, 3)))
    if kind < 0.6:
        return clock.assign(_computed(shape, random.choice(parts.integers)))
    if kind < 0.7:
        return number.assign(random.randint(0, INTEGER_TOP))
    if kind < 0.8:
        return number.assign((number + 1) % (INTEGER_TOP + 1))
    if kind < 0.87:
        return number.assign(selects[0] if selects else parts.scratch)
    if kind < 0.94:
        return parts.scratch.assign(number)
    return number.assign(conditional(random.choice(parts.integers) > 0, 0, 1))


def _predicate(random: Random, shape: Shape, parts: _NetworkParts, handles: Sequence[Sequence[LocationHandle]]) -> Term:
    def place() -> Term:
        return random.choice(random.choice(handles)).reached

    kind = random.random()
    if shape.deadlocks and kind < 0.15:
        return deadlock()
    if shape.deadlocks and kind < 0.25:
        return deadlock() & place()
    if shape.deadlocks and kind < 0.3:
        return ~deadlock() & place() & _clock_condition(random, shape, parts)
    if kind < 0.45:
        return place() & place()
    if kind < 0.6:
        return place() & _integer_condition(random, parts.integers) & place()
    if kind < 0.85:
        return place() & _clock_condition(random, shape, parts) & _clock_condition(random, shape, parts)
    return (place() | _integer_condition(random, parts.integers)) & _clock_condition(random, shape, parts)
