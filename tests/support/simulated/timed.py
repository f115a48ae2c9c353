"""Runs as `certify` replays them: with all their states, times as fractions."""

from __future__ import annotations

from fractions import Fraction

from tachk.engine.simulation.simulator import RecordedChanges, Simulated
from tachk.model.network import Network
from tachk.model.run import DiscreteState, TimedState, TimedStep, TimedTrace
from tachk.model.types import leaves
from tachk.simulation.columns import Column

WITH_STATES = RecordedChanges(actions=True, observed=True, clocks=True)
"""What has to be recorded of the runs, with the columns `state_columns`."""


def state_columns(network: Network) -> tuple[Column, ...]:
    """The whole discrete state."""
    slots = sum(len(list(leaves(variable.type))) for variable in network.all_variables())
    return tuple(Column(str(slot), slot) for slot in range(len(network.processes) + slots))


def timed_trace(network: Network, run: Simulated, slots: int | None = None) -> TimedTrace:
    """The run with the states that the simulator has found.

    Args:
        slots: how many of the columns behind the locations belong to the state; None: all.
    """
    processes = len(network.processes)
    states = []
    for row, (time, values) in enumerate(zip(run.times.tolist(), run.observed.tolist(), strict=True)):
        clocks = run.clocks[row].tolist() if len(run.clocks) else []
        discrete = DiscreteState(tuple(values[:processes]), tuple(values[processes:][:slots]))
        states.append(
            TimedState(
                discrete, tuple(Fraction(c, run.ticks_per_unit) for c in clocks), Fraction(time, run.ticks_per_unit)
            )
        )
    steps = (
        TimedStep(after.time - before.time, action, after)
        for before, after, action in zip(states, states[1:], run.actions, strict=False)
    )
    return TimedTrace(states[0], tuple(steps))
