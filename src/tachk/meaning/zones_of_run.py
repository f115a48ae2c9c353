"""The zones that a run passes through: all clock valuations with which its transitions can be taken so far."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

from tachk.meaning import dbm
from tachk.meaning.dbm import Zone
from tachk.meaning.discrete import prepare
from tachk.meaning.symbolic import elapse, fire, situation
from tachk.model.network import Network
from tachk.model.run import TimedTrace


def zones_of_run(network: Network, run: TimedTrace) -> tuple[Zone, ...]:
    """One zone for the initial state and one behind each transition, delays included.

    Where the symbolic semantics splits a state into several zones, the one is taken in which the run is when it goes
    on. Exact but for stopped clocks; nothing is extrapolated.

    Args:
        run: a run of the network, as an engine has replayed it.
    """
    model = prepare(network)
    here = situation(model, run.initial.discrete)
    arrived = [dbm.point(model.layout.starts)]
    zones: list[Zone] = []
    clocks = run.initial.clocks
    for step in run.steps:
        leaving = clocks_after(clocks, step.delay, here.stopped)
        zone = _holding(elapse(here, arrived), leaving)
        zones.append(zone)
        if step.transition is None:
            return tuple(zones)
        move = next(m for m in here.moves if m.transition == step.transition)
        arrived = [_holding(fire(here, [zone], move), step.state.clocks)]
        clocks = step.state.clocks
        here = situation(model, step.state.discrete)
    zones.append(_holding(elapse(here, arrived), clocks))
    return tuple(zones)


def clocks_after(clocks: tuple[Fraction, ...], delay: Fraction, stopped: frozenset[int]) -> tuple[Fraction, ...]:
    """The values of all clocks after a delay; the stopped ones keep theirs."""
    return tuple(c if number in stopped else c + delay for number, c in enumerate(clocks, 1))


def _holding(zones: Iterable[Zone], clocks: tuple[Fraction, ...]) -> Zone:
    return next(zone for zone in zones if dbm.contains(zone, clocks))
