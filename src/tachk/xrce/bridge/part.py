"""The run of a part of a network: its environment feeds it events, and it gives those that it sends."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from tachk import _core
from tachk.base.records import dataclass
from tachk.engine.simulation.policy import Policy
from tachk.model.network import Network
from tachk.simulation.fmi.environment import OUTSIDE, SENT
from tachk.simulation.fmi.unit import CoSimulationUnit, Role, UnitVariable, open_unit
from tachk.simulation.fmi.unit_run import begin_run

_NANOSECONDS = 10**9


@dataclass(frozen=True, slots=True)
class SentEvent:
    """Attributes:
    time: nanoseconds since the start of the run.
    channel: over which the part has sent.
    values: of the variables that go along.
    """

    time: int
    channel: str
    values: Mapping[str, int]


class BridgedPart:
    """A run of some processes of a network, as the simulator draws it; the rest is the real system.

    Attributes:
        receives, sends: the channels that lead into it and out of it.
    """

    def __init__(
        self, network: Network, names: Sequence[str], seed: int = 0, policy: Policy = Policy.STOCHASTIC
    ) -> None:
        """Raises UsageError for a part that cannot run on its own, UnsupportedError for what is not simulated."""
        self._unit: CoSimulationUnit = open_unit(network, names, "part", clocks=True)
        self._places = {variable.name: place for place, variable in enumerate(self._unit.variables)}
        self.receives = self._channels(Role.RECEIVES)
        self.sends = self._channels(Role.SENDS)
        self._payload = [v for v in self._unit.variables if v.role is Role.OBSERVED and v.name.startswith(SENT)]
        self._unit_run = begin_run(self._unit, seed, policy)

    @property
    def is_over(self) -> bool:
        """True if nothing can happen any more, independently of the others."""
        return self._unit_run.over

    def next_event(self) -> int | None:
        """The time of the next event, in nanoseconds, rounded up; None if nothing happens by itself."""
        event = self._unit_run.next_event()
        if event >= _core.latest_end():
            return None
        return -int(-event * _NANOSECONDS // self._unit.second)

    def advance(self, until: int) -> Iterator[SentEvent]:
        """The outputs up to a moment, in nanoseconds, if there is no input."""
        last = int(until * self._unit.second / _NANOSECONDS)
        while (event := self._unit_run.next_event()) <= last and not self.is_over:
            self._unit_run.wait_until(event)
            moved = False
            for sent in self._reactions():
                moved = True
                if sent is not None:
                    yield sent
            if not moved:
                break  # nothing can happen until a message arrives
        if last > self._unit_run.now:
            self._unit_run.wait_until(last)

    def receive(self, channel: str, values: Mapping[str, int]) -> Iterator[SentEvent]:
        """The outputs at once after an input over a channel. Raises ValueError for values out of range."""
        for name, value in values.items():
            place = self._places.get(OUTSIDE + name)
            if place is not None:
                self._unit_run.set_number(place, self._unit.variables[place].kind, value)
        self._unit_run.set_ticks(self._places[f"{channel}?"])
        yield from (sent for sent in self._reactions() if sent is not None)

    def _reactions(self) -> Iterator[SentEvent | None]:
        """One for each transition at this moment, and more for one that sends over several channels."""
        while self._unit_run.react():
            yield None
            now = int(self._unit_run.now * _NANOSECONDS / self._unit.second)
            for channel in self.sends:
                if self._unit_run.ticks(self._places[f"{channel}!"]):
                    yield SentEvent(now, channel, {v.name.removeprefix(SENT): self._value(v) for v in self._payload})

    def _value(self, variable: UnitVariable) -> int:
        return self._unit_run.number(self._places[variable.name], variable.kind)

    def _channels(self, role: Role) -> tuple[str, ...]:
        return tuple(variable.name[:-1] for variable in self._unit.variables if variable.role is role)
