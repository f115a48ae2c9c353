"""Faults to order: which of the faults that a model allows happen in its runs, and how often.

A fault is an edge whose documentation names it (``/// ! is lost``), beside edges of the same location that answer the
same message otherwise. An order gives it a probability, or says which messages it concerns. The model stays what it is:
orders make weights and counters for the simulation only, so that every run remains one of the model.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import reduce
from math import inf, lcm

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.exact_numbers import DIGITS, is_whole
from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass
from tachk.base.words import Direction
from tachk.model.expressions import (
    BOOL,
    INT,
    Aggregate,
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
from tachk.model.floating import DOUBLE, halves
from tachk.model.network import Branching, Edge, Network, Process
from tachk.model.types import IntType, leaves

_LARGEST = 2**31 - 1
_NOW = "now"
_FINEST = 10**6
_RANGE = re.compile(rf"({DIGITS})(?:\.\.({DIGITS}))?")
_CHANNEL = re.compile(r"(\w+(?:\.\w+)?)((?:\[\w+\])*)")


@dataclass(frozen=True, slots=True)
class Order:
    """A requested fault.

    Attributes:
        fault: the words that name it.
        probability: of each message that no list speaks of; None: there is a list, or ``now``.
        channel: whose messages a list counts.
        messages: the first and the last number of each range of the list, counted from 1.
        written: how it was written.
    """

    fault: str
    probability: Fraction | None
    channel: str
    messages: tuple[tuple[int, int], ...]
    written: str

    @property
    def at_once(self) -> bool:
        """Whether it is to happen whenever it can."""
        return self.probability is None and not self.messages


def parse_order(written: str) -> Order:
    """``lost=0.01``, ``lost=send[UP][DATA]:3,5..7``, ``falls asleep=now``. Raises UsageError."""
    fault, equals, wanted = (part.strip() for part in written.partition("="))
    help = "such as lost=0.01, or lost=send[0][1]:3,5..7, or 'falls asleep=now'"
    if not (fault and equals and wanted):
        raise UsageError(f"--fault {written}: expected FAULT=ORDER", help)
    if wanted == _NOW:
        return Order(fault, None, "", (), written)
    channel, colon, listed = wanted.rpartition(":")
    if colon:
        ranges = []
        for part in listed.split(","):
            match = _RANGE.fullmatch(part.strip())
            if match is None or int(match[1]) < 1:
                raise UsageError(f"--fault {written}: {part.strip()!r} is no number of a message, from 1", help)
            ranges.append((int(match[1]), int(match[2] or match[1])))
        return Order(fault, None, channel.strip(), tuple(ranges), written)
    try:
        probability = Fraction(wanted).limit_denominator(_FINEST)
    except (ValueError, ZeroDivisionError):
        raise UsageError(f"--fault {written}: {wanted!r} is no probability", help) from None
    if not 0 <= probability <= 1:
        raise UsageError(f"--fault {written}: a probability is between 0 and 1", help)
    return Order(fault, probability, "", (), written)


@dataclass(frozen=True, slots=True)
class Ordered:
    """A network whose runs are drawn as ordered.

    Attributes:
        network: its edges have the numbers of those of the model, its new variables come after all others.
        done: for each order with a list the slot of the number of messages for which it was carried out.
        missed: the same of those for which the model did not allow it.
    """

    network: Network
    done: Mapping[str, int]
    missed: Mapping[str, int]


def ordered(network: Network, orders: Sequence[Order]) -> Ordered:
    """Carries out orders. Raises UsageError for an order that nothing in the model answers to."""
    ordering = _Ordering(network, orders)
    processes = [ordering.process(process) for process in network.processes]
    for order in orders:
        if order.written not in ordering.found:
            raise UsageError(f"--fault {order.written}: {ordering.why_not(order)}")
    counters = list(ordering.counters())
    last = replace(processes[-1], variables=(*processes[-1].variables, *counters))
    cells = sum(len(list(leaves(variable.type))) for variable in network.all_variables())
    numbers = {variable: len(network.processes) + cells + place for place, variable in enumerate(counters)}
    return Ordered(
        replace(network, processes=(*processes[:-1], last)),
        {written: numbers[variable] for written, variable in ordering.done.items()},
        {written: numbers[variable] for written, variable in ordering.missed.items()},
    )


class _Ordering:
    def __init__(self, network: Network, orders: Sequence[Order]) -> None:
        self.network = network
        self.orders = orders
        self.found: set[str] = set()
        lists = [order for order in orders if order.messages]
        self.channels = {order.channel: _channel(network, order) for order in lists}
        self.counted = {channel: _counter(f"sent on {channel}") for channel in self.channels}
        self.done = {order.written: _counter(f"done: {order.written}") for order in lists}
        self.missed = {order.written: _counter(f"missed: {order.written}") for order in lists}
        summed = sum((o.probability for o in orders if o.probability is not None), Fraction(0))
        if summed > 1 and len({o.fault for o in orders}) > 1:
            raise UsageError(f"--fault: the probabilities of all faults together are {summed}, more than 1")

    def counters(self) -> Iterator[Variable]:
        yield from self.counted.values()
        yield from self.done.values()
        yield from self.missed.values()

    def why_not(self, order: Order) -> str:
        known = sorted({_words(e) for p in self.network.processes for e in p.edges if e.doc.startswith("!")})
        described = "; ".join(known[:12])
        return (
            f"no edge with such a documentation has an alternative; the model marks as news: {described or 'nothing'}"
        )

    def process(self, process: Process) -> Process:
        edges = list(process.edges)
        locations = list(process.locations)
        ways = max((edge.branch.way for edge in edges if edge.branch is not None), default=-1) + 1
        for group in _groups(edges):
            faults = self._faults([edges[number] for number in group])
            if not any(faults):
                continue
            members = [edges[number] for number in group]
            if all(faults):  # nothing else can be done there
                hurried = {order.written for orders in faults for order in orders if order.at_once}
                self.found |= hurried
                source = members[0].source
                if hurried:
                    locations[source] = replace(locations[source], exponential_rate=_INFINITE)
                continue
            for number, edge in zip(group, self._weighted(members, faults, ways), strict=True):
                edges[number] = edge
            ways += 1
        return replace(process, edges=tuple(edges), locations=tuple(locations))

    def _faults(self, edges: Sequence[Edge]) -> list[tuple[Order, ...]]:
        """For each edge of a group the orders about it: about those that match best."""
        result: list[tuple[Order, ...]] = [()] * len(edges)
        for order in self.orders:
            fits = [_fit(order.fault, _words(edge)) for edge in edges]
            best = max(fits)
            if best:
                result = [(*o, order) if fit == best else o for o, fit in zip(result, fits, strict=True)]
        return result

    def _weighted(self, edges: Sequence[Edge], faults: Sequence[tuple[Order, ...]], way: int) -> Iterator[Edge]:
        """The edges of a group with weights and counters."""
        self.found |= {order.written for orders in faults for order in orders}
        scale = lcm(*(o.probability.denominator for orders in faults for o in orders if o.probability is not None))
        total = sum({o.fault: o.probability or Fraction(0) for orders in faults for o in orders}.values(), Fraction(0))
        lists = list({o.written: o for orders in faults for o in orders if o.messages}.values())
        for edge, orders in zip(edges, faults, strict=True):
            if edge.branch is not None:
                raise UsageError(f"{edge.spans[0]}: this edge goes into a branchpoint, whose weights say how often")
            share = sum((o.probability for o in orders if o.probability is not None), Fraction(0))
            marked = edge.doc.startswith("!")
            plain = share if orders else Fraction(0) if marked else 1 - total
            if any(o.at_once for o in orders):
                plain = Fraction(1)
            elif any(o.at_once for others in faults for o in others):
                plain = Fraction(0)
            weight: Expression = Constant(int(plain * scale))
            updates: list[Expression] = []
            for order in lists:
                due = self._due(order, edge)
                if due is None:
                    continue
                own = order in orders
                weight = Conditional(due, Constant(scale if own else 0), weight, INT)
                updates.append(_increase((self.done if own else self.missed)[order.written], due))
            for channel in dict.fromkeys(order.channel for order in lists):
                here = self._concerns(channel, edge)
                if here is not None:
                    updates.append(_increase(self.counted[channel], here))
            yield replace(edge, branch=Branching(way, len(edge.selects), weight), updates=(*edge.updates, *updates))

    def _due(self, order: Order, edge: Edge) -> Expression | None:
        """The condition that the message is one of those of the list."""
        here = self._concerns(order.channel, edge)
        if here is None:
            return None
        count = Reference(self.counted[order.channel])
        ranges = [
            _and(
                Binary(BinaryOperator.GREATER_EQUAL, count, Constant(first - 1), BOOL),
                Binary(BinaryOperator.LESS_EQUAL, count, Constant(last - 1), BOOL),
            )
            for first, last in order.messages
        ]
        return _and(here, reduce(lambda a, b: Binary(BinaryOperator.OR, a, b, BOOL), ranges))

    def _concerns(self, channel: str, edge: Edge) -> Expression | None:
        """The condition that an edge synchronises over the channel; None if it never does."""
        if edge.synchronisation is None:
            return None
        variable, values = self.channels[channel]
        indices: list[Expression] = []
        place = edge.synchronisation.channel
        while isinstance(place, Index):
            indices.append(place.index)
            place = place.base
        if not isinstance(place, Reference) or place.variable is not variable or len(indices) != len(values):
            return None
        equal: list[Expression] = [
            Binary(BinaryOperator.EQUAL, index, Constant(value), BOOL)
            for index, value in zip(reversed(indices), values, strict=True)
        ]
        always: Expression = Constant(1, BOOL)
        return reduce(_and, equal, always)


_INFINITE = Aggregate(tuple(Constant(half) for half in halves(inf)), DOUBLE)


def _groups(edges: Sequence[Edge]) -> Iterator[list[int]]:
    """The edges that leave a location with the same synchronisation, as it is written, or with none."""
    groups: dict[tuple[int, str, Direction | None], list[int]] = {}
    for number, edge in enumerate(edges):
        channel = edge.synchronisation
        key = ("", None) if channel is None else (channel.channel.span.text, channel.direction)
        groups.setdefault((edge.source, *key), []).append(number)
    return iter(groups.values())


def _words(edge: Edge) -> str:
    return " ".join(edge.doc.removeprefix("!").split())


def _fit(fault: str, words: str) -> int:
    """A score for how well words name a fault; 0: they do not."""
    if words == fault or words in (f"is {fault}", f"arrives {fault}"):
        return 2
    return int(re.search(rf"\b{re.escape(fault)}\b", words) is not None)


def _channel(network: Network, order: Order) -> tuple[Variable, tuple[int, ...]]:
    """The array and the indices of a channel. Raises UsageError."""
    match = _CHANNEL.fullmatch(order.channel.replace(" ", ""))
    problem = f"--fault {order.written}: there is no channel {order.channel}"
    if match is None:
        raise UsageError(problem, "such as send[0][1]")
    variable = next((v for v in network.all_variables() if v.name == match[1]), None)
    if variable is None:
        raise UsageError(problem)
    constants = dict(network.constants)
    values = []
    for index in re.findall(r"\w+", match[2]):
        if not is_whole(index) and index not in constants:
            raise UsageError(problem, f"{index} is no constant of the model")
        values.append(int(index) if is_whole(index) else constants[index])
    return variable, tuple(values)


def _counter(name: str) -> Variable:
    return Variable(name, IntType(0, _LARGEST), VariableKind.LOCAL, (0,))


def _increase(counter: Variable, condition: Expression) -> Expression:
    place = Reference(counter)
    one = Conditional(condition, Constant(1), Constant(0), INT)
    return Assign(place, Binary(BinaryOperator.ADD, place, one, INT), place.type)


def _and(left: Expression, right: Expression) -> Expression:
    return Binary(BinaryOperator.AND, left, right, BOOL)


def orders_of(written: Iterable[str]) -> tuple[Order, ...]:
    """Raises UsageError."""
    return tuple(map(parse_order, written))
