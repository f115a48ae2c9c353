"""From packets that arrive to packets that leave: what a relay decides, without sockets and clocks.

Events are arrivals and moments at which something was to be done; the answer to each is what leaves now, and when to
ask again. The same events give the same answers: chance is drawn from a seed, for each rule and each direction of each
client separately, so that the order in which packets of different clients arrive has no influence.
"""

from __future__ import annotations

from collections.abc import Iterable
from random import Random
from typing import Final

from tachk.base.records import dataclass
from tachk.xrce.messages import Endpoint
from tachk.xrce.proxy.rules import Chosen, ChosenPackets, PacketDirection, RelayAction, RelayRule
from tachk.xrce.proxy.sightings import Said, are_among, said


@dataclass(frozen=True, slots=True)
class RelayArrival:
    """A datagram reaches the relay.

    Attributes:
        port: where the relay listens for its client.
        client: the address of the client.
        way: where it goes.
        octets: its content.
        time: nanoseconds.
    """

    port: int
    client: Endpoint
    way: PacketDirection
    octets: bytes
    time: int


@dataclass(frozen=True, slots=True)
class Departure:
    """A datagram leaves the relay. ``arrival``: its number among the arrivals, from 0; ``copy``: it is a duplicate."""

    arrival: int
    port: int
    client: Endpoint
    way: PacketDirection
    octets: bytes
    copy: bool


@dataclass(frozen=True, slots=True)
class RelayDecision:
    """The consequences of an event.

    Attributes:
        departures: what leaves now, in this order.
        wake: when to ask again, in nanoseconds; None: when something arrives.
        applied: the indices of the rules that apply to the arrival.
    """

    departures: tuple[Departure, ...]
    wake: int | None
    applied: tuple[int, ...] = ()


_EventKey = tuple[int, Chosen]
"""The port of a client, and packets that are awaited."""


@dataclass(slots=True)
class _Held:
    """A datagram in the relay. ``needs``: what has to pass before; ``place`` orders those that leave together."""

    departure: Departure
    due: int
    needs: list[_EventKey]
    place: int


class Decisions:
    """Attributes:
    applied: for each rule, how many packets it applied to.
    """

    def __init__(self, rules: Iterable[RelayRule], seed: int = 0) -> None:
        self.rules: Final = tuple(rules)
        self.applied = [0] * len(self.rules)
        self._seed = seed
        self._chances: dict[tuple[int, int, PacketDirection], Random] = {}
        self._awaited = tuple({event for rule in self.rules for event in rule.wait.events})
        self._counts: dict[tuple[int, object], int] = {}
        self._begun: set[tuple[int, ChosenPackets]] = set()
        self._came: dict[_EventKey, tuple[int, PacketDirection]] = {}
        self._left: set[int] = set()
        self._started: dict[int, int] = {}
        self._held: list[_Held] = []
        self._arrivals = 0
        self._places = 0

    @property
    def held(self) -> tuple[Departure, ...]:
        """The datagrams in the relay."""
        return tuple(one.departure for one in self._held)

    def arrived(self, arrival: RelayArrival) -> RelayDecision:
        """The consequences of an arrival."""
        number = self._arrivals
        self._arrivals += 1
        start = self._started.setdefault(arrival.port, arrival.time)
        sayings = said(arrival.octets)
        self._note(number, arrival, sayings)
        applied = tuple(
            index
            for index, rule in enumerate(self.rules)
            if rule.begin <= arrival.time - start < rule.end and self._applies(index, rule, arrival, sayings)
        )
        for index in applied:
            self.applied[index] += 1
        self._take(number, arrival, [(index, self.rules[index]) for index in applied])
        answer = self.due(arrival.time)
        return RelayDecision(answer.departures, answer.wake, applied)

    def _note(self, number: int, arrival: RelayArrival, sayings: tuple[Said, ...]) -> None:
        """Counts for those who wait for this packet."""
        for event in self._awaited:
            count = self._count(("event", event), event, arrival, sayings)
            if count == event.first:
                self._came[(arrival.port, event)] = (number, arrival.way)

    def _count(self, key: object, chosen: Chosen, arrival: RelayArrival, sayings: tuple[Said, ...]) -> int:
        """The number of the arrival among the packets that are counted; 0 if it is none of them."""
        port, way, since = arrival.port, arrival.way, chosen.since
        if since is not None and (port, since) not in self._begun:
            if not are_among(sayings, way, port, since):
                return 0
            self._begun.add((port, since))
        if not are_among(sayings, way, port, chosen.packets):
            return 0
        count = self._counts.get((port, key), 0) + 1
        self._counts[(port, key)] = count
        return count

    def _applies(self, index: int, rule: RelayRule, arrival: RelayArrival, sayings: tuple[Said, ...]) -> bool:
        count = self._count(index, rule.chosen, arrival, sayings)
        if not rule.chosen.first <= count <= rule.chosen.last:
            return False
        return rule.share is None or self._chance(index, arrival).random() < rule.share

    def _chance(self, index: int, arrival: RelayArrival) -> Random:
        key = (index, arrival.port, arrival.way)
        if key not in self._chances:
            self._chances[key] = Random(f"{self._seed} {index} {arrival.port} {arrival.way.value}")
        return self._chances[key]

    def _take(self, number: int, arrival: RelayArrival, rules: list[tuple[int, RelayRule]]) -> None:
        """Puts the packet and its copies among those that leave, unless it is dropped."""
        due, needs, lost = arrival.time, list[_EventKey](), False
        for index, rule in rules:
            match rule.action:
                case RelayAction.DROP:
                    lost = True
                case RelayAction.DELAY:
                    due += self._drawn(index, rule, arrival)
                    needs += [(arrival.port, event) for event in rule.wait.events]
                case RelayAction.DUPLICATE:
                    events = [(arrival.port, event) for event in rule.wait.events]
                    self._hold(number, arrival, True, arrival.time + self._drawn(index, rule, arrival), events)
        if lost:
            self._left.add(number)
        else:
            self._hold(number, arrival, False, due, needs)

    def _drawn(self, index: int, rule: RelayRule, arrival: RelayArrival) -> int:
        wait = rule.wait
        if wait.shortest == wait.longest:
            return wait.shortest
        return self._chance(index, arrival).randint(wait.shortest, wait.longest)

    def _hold(self, number: int, arrival: RelayArrival, copy: bool, due: int, needs: list[_EventKey]) -> None:
        departure = Departure(number, arrival.port, arrival.client, arrival.way, arrival.octets, copy)
        self._held.append(_Held(departure, due, needs, self._places))
        self._places += 1

    def due(self, time: int) -> RelayDecision:
        """The datagrams that leave at a time."""
        departures: list[Departure] = []
        while ready := [one for one in self._held if one.due <= time and self._may_leave(one)]:
            first = min(ready, key=lambda one: (one.due, one.place))
            self._held.remove(first)
            departures.append(first.departure)
            if not first.departure.copy:
                self._left.add(first.departure.arrival)
        wakes = [one.due for one in self._held if one.due > time]
        return RelayDecision(tuple(departures), min(wakes, default=None))

    def _may_leave(self, held: _Held) -> bool:
        return all(self._has_passed(held.departure, need) for need in held.needs)

    def _has_passed(self, departure: Departure, need: _EventKey) -> bool:
        if need not in self._came:
            return False
        number, way = self._came[need]
        return way is not departure.way or number in self._left or (number == departure.arrival and not departure.copy)
