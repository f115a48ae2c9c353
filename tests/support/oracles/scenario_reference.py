"""Whether some run has the events of a scenario, by all runs with whole delays.

Networks and scenarios without strict bounds have such a run if they have any (Henzinger, Manna, Pnueli, "What good are
digital clocks?", 1992).
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from random import Random

from tachk.base.records import replace
from tachk.frontend.queries.scenario_observer import ObservedChannel, ScenarioEvent
from tachk.meaning.discrete import PreparedNetwork, channel_of, meta_values, prepare
from tachk.meaning.step import StepError, delay, initial_state, satisfies, successors
from tachk.model.network import Network
from tachk.model.run import TimedState, Transition
from tachk.model.types import ChannelType, element_type, slot_count

_BEYOND = 8
"""Clocks beyond every constant are the same."""


def channels_of(network: Network) -> list[ObservedChannel]:
    """The channels of a network by their numbers."""
    return [
        ObservedChannel(variable, place)
        for variable in network.all_variables()
        if isinstance(element_type(variable.type), ChannelType)
        for place in range(slot_count(variable.type))
    ]


def is_possible(
    network: Network, events: Sequence[ScenarioEvent], also: Sequence[ObservedChannel], most: int
) -> bool | None:
    """Whether a run has these events and no others on the channels that count; None after so many states."""
    model, names = prepare(network), channels_of(network)
    observed = {*also, *(channel for event in events for channel in event.channels)}
    start = (_clipped(initial_state(model)), 0, 0)
    seen, pending = {start}, [start]
    while pending:
        state, count, since = pending.pop()
        if count == len(events):
            return True
        found = []
        event = events[count]
        if not event.channels and since == event.earliest:
            found.append((state, count + 1, 0))
        for transition, after in successors(model, state):
            number = channel_of(model, state.discrete, transition)
            if number is None or names[number] not in observed:
                found.append((after, count, since))
            elif names[number] in event.channels and event.earliest <= since:
                if event.latest is None or since <= event.latest:
                    if event.condition is None or satisfies(
                        model, _shown(model, state, transition, after), event.condition
                    ):
                        found.append((after, count + 1, 0))
        later = _later(model, state)
        if later is not None:
            found.append((later, count, min(since + 1, _BEYOND)))
        for after, happened, time in found:
            key = (_clipped(after), happened, time)
            if key not in seen:
                seen.add(key)
                pending.append(key)
        if len(seen) > most:
            return None
    return False


def random_run_events(network: Network, random: Random, steps: int) -> list[tuple[int, ObservedChannel]]:
    """The events of a random run with whole delays, each with the time since the one before."""
    model, names = prepare(network), channels_of(network)
    state, since = initial_state(model), 0
    found: list[tuple[int, ObservedChannel]] = []
    for _ in range(steps):
        later = _later(model, state)
        next_ = successors(model, state)
        if later is not None and (not next_ or random.random() < 0.4):
            state, since = later, since + 1
        elif next_:
            transition, after = random.choice(next_)
            number = channel_of(model, state.discrete, transition)
            if number is not None:
                found.append((since, names[number]))
                since = 0
            state = after
        else:
            break
    return found


def _later(model: PreparedNetwork, state: TimedState) -> TimedState | None:
    try:
        return delay(model, state, Fraction(1))
    except StepError:
        return None


def _shown(model: PreparedNetwork, state: TimedState, transition: Transition, after: TimedState) -> TimedState:
    """The state behind a transition, with what meta variables held at its end."""
    values = list(after.discrete.values)
    for slot, value in meta_values(model, state.discrete, transition).items():
        values[slot] = value
    return replace(after, discrete=replace(after.discrete, values=tuple(values)))


def _clipped(state: TimedState) -> TimedState:
    clocks = tuple(min(clock, Fraction(_BEYOND)) for clock in state.clocks)
    return replace(state, clocks=clocks, time=Fraction(0))
