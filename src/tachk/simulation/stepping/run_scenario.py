"""A run as a scenario of its model: the events over channels that can be named, and their distances."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import ceil, floor

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.meaning.discrete import channel_of, meta_values
from tachk.meaning.run_view import RunNames
from tachk.model.expressions import VariableKind
from tachk.model.run import DiscreteState, TimedTrace, Transition
from tachk.model.types import BoolType, IntType, slot_count
from tachk.syntax.printing.scenario_text import scenario_text

SUFFIX = ".ta"


def scenario_of_run(names: RunNames, run: TimedTrace, name: str) -> str:
    """A scenario that the run shows: all that happens on the channels of its events, with whole bounds around times.

    What the global `meta` variables hold at the end of a step stands behind `with`, where it is not what they held
    before. Raises UsageError if nothing in the run can be named.
    """
    lines = list(_events(names, run))
    if not lines:
        raise UsageError("nothing happens on a global channel in this run, so it makes no scenario")
    return scenario_text(name, lines)


def _events(names: RunNames, run: TimedTrace) -> Iterator[str]:
    layout = names.layout
    channels = [layout.names[slot] for slot in layout.channel_slots]
    state, last = run.initial, Fraction(0)
    for step in run.steps:
        number = None if step.transition is None else channel_of(names.model, state.discrete, step.transition)
        if step.transition is not None and number is not None and "." not in channels[number]:
            since = step.state.time - last
            last = step.state.time
            values = " && ".join(_contents(names, state.discrete, step.transition))
            yield f"{_bounds(since)}{channels[number]}{' with ' if values else ''}{values}"
        state = step.state


def _bounds(since: Fraction) -> str:
    return f"from {floor(since)} to {ceil(since)} " if since else "within 0 "


def _contents(names: RunNames, before: DiscreteState, transition: Transition) -> Iterator[str]:
    slots = {
        names.layout.first[variable] + place
        for variable in names.network.variables
        if variable.kind is VariableKind.GLOBAL
        for place in range(slot_count(variable.type))
    }
    for slot, value in meta_values(names.model, before, transition).items():
        if slot in slots and isinstance(names.layout.types[slot], IntType | BoolType) and value != before.values[slot]:
            yield f"{names.layout.names[slot]} == {value}"
