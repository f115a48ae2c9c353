"""Fault injection: a plan says which of the faults that a model allows happen in its runs, and how often.

A fault is an edge whose documentation names it (``/// ! is lost``), beside edges of the same location that answer the
same message otherwise. A fault-injection plan gives it a probability, or says which messages it concerns. The model
stays what it is: a plan makes weights and counters for the simulation only, so that every run remains one of the model.
Where the other edges of the location do something else (a link that holds a message delivers it by a channel, and loses
it by an edge of its own), the edges into the location draw what happens to what came with them.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import reduce
from math import inf, lcm

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.base.exact_numbers import DIGITS, is_whole
from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass, replace
from tachk.base.words import Direction
from tachk.model.connectives import any_of, both, conjuncts, negation
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
from tachk.model.floating import DOUBLE, FloatingOperation, halves
from tachk.model.floating_calls import floating_constant, operated
from tachk.model.network import Branching, Edge, Network, Process
from tachk.model.traversal import reads_clock
from tachk.model.types import ChannelType, IntType, leaves

_LARGEST = 2**31 - 1
_NOW = "now"
_FINEST = 10**6
_RANGE = re.compile(rf"({DIGITS})(?:\.\.({DIGITS}))?")
_CHANNEL = re.compile(r"(\w+(?:\.\w+)?)((?:\[\w+\])*)")


@dataclass(frozen=True, slots=True)
class InjectedFault:
    """A fault of a plan.

    Attributes:
        fault: the words that name it.
        probability: of each message that no list is about; None: there is a list, or ``now``.
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
        """True if it is to happen whenever it can."""
        return self.probability is None and not self.messages


def parse_fault(written: str) -> InjectedFault:
    """``lost=0.01``, ``lost=send[UP][DATA]:3,5..7``, ``falls asleep=now``. Raises UsageError."""
    fault, equals, wanted = (part.strip() for part in written.partition("="))
    help = "such as lost=0.01, or lost=send[0][1]:3,5..7, or 'falls asleep=now'"
    if not (fault and equals and wanted):
        raise UsageError(f"fault `{written}`: expected FAULT=PLAN", help)
    if wanted == _NOW:
        return InjectedFault(fault, None, "", (), written)
    channel, colon, listed = wanted.rpartition(":")
    if colon:
        ranges = []
        for part in listed.split(","):
            match = _RANGE.fullmatch(part.strip())
            if match is None or int(match[1]) < 1:
                raise UsageError(f"fault `{written}`: {part.strip()!r} is not a number of a message, from 1", help)
            ranges.append((int(match[1]), int(match[2] or match[1])))
        return InjectedFault(fault, None, channel.strip(), tuple(ranges), written)
    try:
        probability = Fraction(wanted).limit_denominator(_FINEST)
    except (ValueError, ZeroDivisionError):
        raise UsageError(f"fault `{written}`: {wanted!r} is not a probability", help) from None
    if not 0 <= probability <= 1:
        raise UsageError(f"fault `{written}`: a probability is between 0 and 1", help)
    return InjectedFault(fault, probability, "", (), written)


@dataclass(frozen=True, slots=True)
class FaultedNetwork:
    """A network with the faults of a plan.

    Attributes:
        network: its edges have the numbers of those of the model, its new variables come after all others.
        done: for each fault with a list the slot of the number of messages for which it happened.
        missed: the same of those for which the model did not allow it.
    """

    network: Network
    done: Mapping[str, int]
    missed: Mapping[str, int]


def with_faults(network: Network, plan: Sequence[InjectedFault]) -> FaultedNetwork:
    """The network with a plan carried out. Raises UsageError for a fault that the model does not have."""
    injection = _Injection(network, plan)
    processes = [injection.process(process) for process in network.processes]
    for injected in plan:
        if injected.written not in injection.found:
            reason, remedy = injection.why_not(injected)
            raise UsageError(f"fault `{injected.written}`: {reason}", remedy)
    counters = list(injection.counters())
    last = replace(processes[-1], variables=(*processes[-1].variables, *counters))
    slots = sum(len(list(leaves(variable.type))) for variable in network.all_variables())
    numbers = {variable: len(network.processes) + slots + place for place, variable in enumerate(counters)}
    return FaultedNetwork(
        replace(network, processes=(*processes[:-1], last)),
        {written: numbers[variable] for written, variable in injection.done.items()},
        {written: numbers[variable] for written, variable in injection.missed.items()},
    )


class _Injection:
    def __init__(self, network: Network, plan: Sequence[InjectedFault]) -> None:
        self.network = network
        self.plan = plan
        self.found: set[str] = set()
        lists = [injected for injected in plan if injected.messages]
        self.channels = {injected.channel: _channel(network, injected) for injected in lists}
        self.counted = {channel: _counter(f"sent on {channel}") for channel in self.channels}
        self.done = {injected.written: _counter(f"done: {injected.written}") for injected in lists}
        self.missed = {injected.written: _counter(f"missed: {injected.written}") for injected in lists}
        self.decisions: list[Variable] = []
        self.obstacles: dict[str, str] = {}
        summed = sum((o.probability for o in plan if o.probability is not None), Fraction(0))
        if summed > 1 and len({o.fault for o in plan}) > 1:
            raise UsageError(f"the probabilities of all faults together are {summed}, more than 1")

    def counters(self) -> Iterator[Variable]:
        yield from self.counted.values()
        yield from self.done.values()
        yield from self.missed.values()
        yield from self.decisions

    def why_not(self, injected: InjectedFault) -> tuple[str, str | None]:
        """The reason and the remedy."""
        if injected.written in self.obstacles:
            return self.obstacles[injected.written], None
        documented = [edge for process in self.network.processes for edge in process.edges if edge.doc]
        events = [edge for edge in documented if edge.doc.startswith("!")]
        known = sorted({_words(edge) for edge in events or documented})
        return (
            f"no edge is documented as `{injected.fault}`",
            f"the model documents: {'; '.join(known[:12])}"
            if known
            else f"write `/// ! {injected.fault}` on a line of its own above the edge that is the fault",
        )

    def process(self, process: Process) -> Process:
        edges = list(process.edges)
        locations = list(process.locations)
        ways = max((edge.branch.way for edge in edges if edge.branch is not None), default=-1) + 1
        alone: dict[int, dict[int, tuple[InjectedFault, ...]]] = {}
        for group in _groups(edges):
            members = [edges[number] for number in group]
            faults = self._faults(members)
            if not any(faults):
                continue
            if all(plan or edge.doc.startswith("!") for plan, edge in zip(faults, members, strict=True)):
                hurried = {injected.written for plan in faults for injected in plan if injected.at_once}
                self.found |= hurried
                source = members[0].source
                if hurried:
                    locations[source] = replace(locations[source], exponential_rate=_INFINITE)
                else:  # it is decided together with the edges that synchronise otherwise
                    planned = {number: plan for number, plan in zip(group, faults, strict=True) if plan}
                    alone.setdefault(source, {}).update(planned)
                continue
            for number, edge in zip(group, self._weighted(members, faults, ways), strict=True):
                edges[number] = edge
            ways += 1
        for place, faulty in alone.items():
            self._decide_on_entry(process, edges, place, faulty)
        return replace(process, edges=tuple(edges), locations=tuple(locations))

    def _decide_on_entry(
        self, process: Process, edges: list[Edge], place: int, faulty: Mapping[int, tuple[InjectedFault, ...]]
    ) -> None:
        """Has the edges into a location draw which fault happens there: its other edges then wait, unless the model
        does not allow the fault. A model's own link is such a location: a message is in it, delivered or lost later."""
        entering = [number for number, edge in enumerate(edges) if edge.target == place]
        others = [number for number, edge in enumerate(edges) if edge.source == place and number not in faulty]
        plain = [number for number in others if not edges[number].doc.startswith("!")]
        where = f"{process.name}.{process.locations[place].name}"
        obstacle = None
        if not plain:
            obstacle = f"there is no other edge in {where}, to be taken where the fault does not happen: add one"
        elif not entering:
            obstacle = f"no edge leads to {where}, where it would be decided whether the fault happens: add one"
        elif any(_waits_for_a_partner(edges[number]) for number in faulty):
            obstacle = f"its edge in {where} waits for a partner: leave out its synchronisation"
        wanted = {injected.written: injected for plan in faulty.values() for injected in plan}
        if obstacle is not None:
            self.obstacles |= dict.fromkeys(wanted, obstacle)
            return
        self.found |= {*wanted}
        names = list(dict.fromkeys(injected.fault for injected in wanted.values()))
        decision = Variable(f"decided: {where}", IntType(0, len(names)), VariableKind.LOCAL, (0,))
        self.decisions.append(decision)
        chosen = Reference(decision)
        for number in entering:
            edge = edges[number]
            drawn = Assign(chosen, self._drawn(edge, names, list(wanted.values())), chosen.type)
            counts = self._counts(edge, {injected.channel for injected in wanted.values() if injected.messages})
            edges[number] = edge = replace(edge, updates=(*edge.updates, drawn, *counts))
        happens = {name: Binary(BinaryOperator.EQUAL, chosen, Constant(n), BOOL) for n, name in enumerate(names, 1)}
        impossible = {
            name: reduce(_and, (_forbidden(edges[number]) for number, plan in faulty.items() if _names(plan, name)))
            for name in names
        }
        for number, plan in faulty.items():
            due = any_of([happens[injected.fault] for injected in plan])
            done = [
                _increase(self.done[injected.written], happens[injected.fault])
                for injected in plan
                if injected.messages
            ]
            edge = edges[number]
            edges[number] = replace(edge, guard=both(edge.guard, due), updates=(*edge.updates, *done))
        free = any_of(
            [
                Binary(BinaryOperator.EQUAL, chosen, Constant(0), BOOL),
                *(_and(happens[name], impossible[name]) for name in names),
            ]
        )
        lists = [injected for injected in wanted.values() if injected.messages]
        for number in others:
            edge = edges[number]
            missed = [_increase(self.missed[injected.written], happens[injected.fault]) for injected in lists]
            allowed = Constant(0, BOOL) if edge.doc.startswith("!") else free
            edges[number] = replace(edge, guard=both(edge.guard, allowed), updates=(*missed, *edge.updates))

    def _drawn(self, edge: Edge, names: Sequence[str], wanted: Sequence[InjectedFault]) -> Expression:
        """The number of the fault that happens to a message that comes with an edge; 0: none."""
        value: Expression = Constant(0)
        before = sum((o.probability for o in wanted if o.probability is not None), Fraction(0))
        for number, name in reversed([*enumerate(names, 1)]):
            own = [o.probability for o in wanted if o.fault == name and o.probability is not None]
            if own and own[-1]:
                before -= own[-1]
                value = Conditional(_with_probability(own[-1] / (1 - before)), Constant(number), value, INT)
        for injected in wanted:
            if injected.messages:
                due = self._due(injected, edge)
                if due is not None:
                    value = Conditional(due, Constant(names.index(injected.fault) + 1), value, INT)
        return value

    def _counts(self, edge: Edge, channels: Iterable[str]) -> Iterator[Expression]:
        """The updates that count an edge among the messages of the channels on which it synchronises."""
        for channel in sorted(channels):
            here = self._concerns(channel, edge)
            if here is not None:
                yield _increase(self.counted[channel], here)

    def _faults(self, edges: Sequence[Edge]) -> list[tuple[InjectedFault, ...]]:
        """For each edge of a group its faults: those that match best."""
        result: list[tuple[InjectedFault, ...]] = [()] * len(edges)
        for injected in self.plan:
            fits = [_fit(injected.fault, _words(edge)) for edge in edges]
            best = max(fits)
            if best:
                result = [(*o, injected) if fit == best else o for o, fit in zip(result, fits, strict=True)]
        return result

    def _weighted(self, edges: Sequence[Edge], faults: Sequence[tuple[InjectedFault, ...]], way: int) -> Iterator[Edge]:
        """The edges of a group with weights and counters."""
        self.found |= {injected.written for plan in faults for injected in plan}
        scale = lcm(*(o.probability.denominator for plan in faults for o in plan if o.probability is not None))
        total = sum({o.fault: o.probability or Fraction(0) for plan in faults for o in plan}.values(), Fraction(0))
        lists = list({o.written: o for plan in faults for o in plan if o.messages}.values())
        for edge, plan in zip(edges, faults, strict=True):
            if edge.branch is not None:
                raise UsageError(f"{edge.spans[0]}: this edge goes into a branchpoint, whose weights say how often")
            share = sum((o.probability for o in plan if o.probability is not None), Fraction(0))
            marked = edge.doc.startswith("!")
            plain = share if plan else Fraction(0) if marked else 1 - total
            if any(o.at_once for o in plan):
                plain = Fraction(1)
            elif any(o.at_once for others in faults for o in others):
                plain = Fraction(0)
            weight: Expression = Constant(int(plain * scale))
            updates: list[Expression] = []
            for injected in lists:
                due = self._due(injected, edge)
                if due is None:
                    continue
                own = injected in plan
                weight = Conditional(due, Constant(scale if own else 0), weight, INT)
                updates.append(_increase((self.done if own else self.missed)[injected.written], due))
            updates += self._counts(edge, {injected.channel for injected in lists})
            yield replace(edge, branch=Branching(way, len(edge.selects), weight), updates=(*edge.updates, *updates))

    def _due(self, injected: InjectedFault, edge: Edge) -> Expression | None:
        """The condition that the message is one of those of the list."""
        here = self._concerns(injected.channel, edge)
        if here is None:
            return None
        count = Reference(self.counted[injected.channel])
        ranges = [
            _and(
                Binary(BinaryOperator.GREATER_EQUAL, count, Constant(first - 1), BOOL),
                Binary(BinaryOperator.LESS_EQUAL, count, Constant(last - 1), BOOL),
            )
            for first, last in injected.messages
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


def _waits_for_a_partner(edge: Edge) -> bool:
    """Whether an edge is taken only together with others, so that nobody can have it happen."""
    if edge.synchronisation is None:
        return False
    channel = edge.synchronisation.channel.type
    sends = edge.synchronisation.direction is Direction.SEND
    return not (sends and isinstance(channel, ChannelType) and channel.broadcast)


def _names(plan: Iterable[InjectedFault], fault: str) -> bool:
    return any(injected.fault == fault for injected in plan)


def _forbidden(edge: Edge) -> Expression:
    """The condition that the variables of the model forbid an edge for now, whatever the clocks are."""
    conditions = [each for each in conjuncts(edge.guard) if not reads_clock(each)]
    return any_of([negation(each) for each in conditions]) if conditions else Constant(0, BOOL)


def _with_probability(probability: Fraction) -> Expression:
    """A condition that is drawn anew wherever it is evaluated."""
    drawn = operated(FloatingOperation.RANDOM, (floating_constant(1.0),))
    return operated(FloatingOperation.LESS, (drawn, floating_constant(float(probability))))


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


def _channel(network: Network, injected: InjectedFault) -> tuple[Variable, tuple[int, ...]]:
    """The array and the indices of a channel. Raises UsageError."""
    match = _CHANNEL.fullmatch(injected.channel.replace(" ", ""))
    problem = f"fault `{injected.written}`: there is no channel {injected.channel}"
    if match is None:
        raise UsageError(problem, "such as send[0][1]")
    variable = next((v for v in network.all_variables() if v.name == match[1]), None)
    if variable is None:
        channels = [
            each.name
            for each in network.all_variables()
            if any(isinstance(leaf, ChannelType) for _, leaf in leaves(each.type))
        ]
        raise UsageError(problem, did_you_mean(match[1], channels))
    constants = dict(network.constants)
    values = []
    for index in re.findall(r"\w+", match[2]):
        if not is_whole(index) and index not in constants:
            raise UsageError(problem, f"{index} is not a constant of the model")
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


def read_plan(written: Iterable[str]) -> tuple[InjectedFault, ...]:
    """The fault-injection plan in texts such as ``lost=0.01``. Raises UsageError."""
    return tuple(map(parse_fault, written))
