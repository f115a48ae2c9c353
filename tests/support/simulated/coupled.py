"""A master that couples units of parts of one network, by FMI 3.0 with event mode, early return and clocks.

After each transition of a unit the others get the variables that it has changed and the channels over which it has
sent. Where some process is committed, only units with such processes go on. This is what one network does.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, suppress
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

from fmpy.fmi3 import FMU3Slave

from tachk.engine.simulation.policy import Policy
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, SimulationOptions
from tachk.meaning.discrete import prepare
from tachk.meaning.step import StepError, delay, initial_state, possible
from tachk.model.network import Network
from tachk.model.run import TimedState
from tachk.simulation.columns import all_columns
from tachk.simulation.fmi.description import FmiVersion
from tachk.simulation.fmi.environment import OUTSIDE, SENT
from tachk.simulation.fmi.resource_file import resource_file
from tachk.simulation.fmi.unit import CoSimulationUnit, FmiType, Role
from tests.support.simulated.cosimulated import extract

Values = dict[str, int]


class Member:
    """A unit that runs together with others, and what it shares with them."""

    def __init__(self, unit: CoSimulationUnit, folder: Path, drawing: SimulationOptions, run: int) -> None:
        self.unit = unit
        self.places = {variable.name: place for place, variable in enumerate(unit.variables)}
        self.next, self.transitions = 0.0, 0
        self._slave = FMU3Slave(
            guid=resource_file(unit).token,
            unzipDirectory=extract(unit, FmiVersion.THREE, folder),
            modelIdentifier=unit.name,
            instanceName=unit.name,
        )
        self._slave.instantiate(eventModeUsed=True, earlyReturnAllowed=True)
        self._slave.setUInt64([self.places["seed"], self.places["run"]], [drawing.seed, run])
        self._slave.setInt64([self.places["policy"]], [list(Policy).index(drawing.policy)])
        self._slave.enterInitializationMode()
        self._slave.exitInitializationMode()

    def values(self) -> Values:
        """What can be seen of the unit."""
        result: Values = {}
        for kind, read in (
            (FmiType.INTEGER, self._slave.getInt32),
            (FmiType.TRUTH, self._slave.getBoolean),
            (FmiType.ENUMERATION, self._slave.getInt64),
        ):
            names = [v.name for v in self.unit.variables if v.role is Role.OBSERVED and v.kind is kind]
            result |= zip(names, map(int, read([self.places[name] for name in names])), strict=True)
        return result

    def update(self) -> bool:
        """One transition, or what the others have done. Whether there was a transition."""
        _, over, _, _, known, self.next = self._slave.updateDiscreteStates()
        assert not over
        if not known:
            self.next = float("inf")
        before, (self.transitions,) = self.transitions, self._slave.getUInt64([self.places["transitions"]])
        return self.transitions > before

    def sent(self) -> list[str]:
        """The channels over which the last transition has sent."""
        names = [variable.name for variable in self.unit.variables if variable.role is Role.SENDS]
        ticks = self._slave.getClock([self.places[name] for name in names])
        return [name[:-1] for name, tick in zip(names, ticks, strict=True) if tick]

    def hear(self, values: Values, channels: Sequence[str], seen: Values) -> bool:
        """Takes over values and messages; whether there is something new to the unit, which has been seen so before."""
        news = False
        for name, value in values.items():
            place = self.places.get(OUTSIDE + name)
            if place is None:
                continue
            write = self._slave.setBoolean if self.unit.variables[place].kind is FmiType.TRUTH else self._slave.setInt32
            write([place], [value])
            news = news or seen.get(name, value) != value
        clocks = [self.places[f"{name}?"] for name in channels if f"{name}?" in self.places]
        if clocks:
            self._slave.setClock(clocks, [True] * len(clocks))
        return news or bool(clocks)

    def step(self, time: float, size: float) -> None:
        """To a moment at which something may happen first, and into event mode there."""
        self._slave.enterStepMode()
        _, _, _, last = self._slave.doStep(time, size)
        assert last == time + size or self.next == last
        self._slave.enterEventMode()

    def close(self) -> None:
        self._slave.terminate()
        self._slave.freeInstance()


def coupled(
    units: Sequence[CoSimulationUnit], folder: Path, drawing: SimulationOptions, run: int, until: float
) -> Iterator[tuple[int, Values]]:
    """The time in ticks and all values after each transition of the whole."""
    with ExitStack() as stack:
        members = [Member(unit, folder / unit.name, drawing, run) for unit in units]
        for member in members:
            stack.callback(member.close)
        seen = [member.values() for member in members]
        yield 0, _all(seen)
        time = 0.0
        while True:
            for _ in _happenings(members, seen, time):
                yield round(Fraction(time) * units[0].second), _all(seen)
            later = min(member.next for member in members)
            if later <= time or later > until:
                return
            for member in members:
                member.step(time, later - time)
            time = later


def _happenings(members: Sequence[Member], seen: list[Values], time: float) -> Iterator[None]:
    """Everything that happens at a moment, one transition after another."""
    moved = True
    while moved:
        moved = False
        committed = [n for n, values in enumerate(seen) if values["committed"]]
        for number in committed or range(len(members)):
            member = members[number]
            if member.next > time:
                continue
            if not member.update():
                continue
            after, channels = member.values(), member.sent()
            changed = {name: value for name, value in after.items() if seen[number].get(name) != value}
            seen[number] = after
            _tell(members, seen, number, changed, channels)
            moved = True
            yield
            break


def _tell(members: Sequence[Member], seen: list[Values], number: int, changed: Values, channels: Sequence[str]) -> None:
    """Tells the others what a member has changed and sent, and all what these change in turn."""
    if channels:
        sent = {name: value for name, value in seen[number].items() if name.startswith(SENT)}
        changed = {name: v for name, v in changed.items() if not name.startswith(SENT)}
        changed |= {name.removeprefix(SENT): value for name, value in sent.items()}
    news: list[tuple[int, Values]] = []
    for other, member in enumerate(members):
        if other != number and member.hear(changed, channels, seen[other]):
            member.update()
            after = member.values()
            own = {k: v for k, v in after.items() if seen[other].get(k) != v and changed.get(k) != v}
            seen[other] = after
            news += [(other, own)] if own else []
    for other, own in news:
        _tell(members, seen, other, own, ())


def _all(seen: Sequence[Values]) -> Values:
    return {name: value for values in seen for name, value in values.items() if not name.startswith(SENT)}


def not_a_run(network: Network, rows: Sequence[tuple[int, Values]]) -> str:
    """Where rows stop being what a network does by its reference semantics; empty if they are a run of it."""
    model = prepare(network)
    columns = [c for c in all_columns(network) if isinstance(c.value, int) and c.name in rows[0][1]]

    def fits(state: TimedState, values: Values) -> bool:
        slots = (*state.discrete.locations, *state.discrete.values)
        return all(slots[c.value] == values[c.name] for c in columns if isinstance(c.value, int))

    states = [state for state in [initial_state(model)] if fits(state, rows[0][1])]
    for number, (before, (time, values)) in enumerate(pairwise(rows)):
        later: list[TimedState] = []
        for state in states:
            with suppress(StepError):
                state = delay(model, state, Fraction(time - before[0], TICKS_PER_UNIT))
                later += [after for _, after in possible(model, state) if fits(after, values)]
        states = list(dict.fromkeys(later))
        if not states:
            return f"transition {number + 1}, at {time}"
    return ""
