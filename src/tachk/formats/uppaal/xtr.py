"""Symbolic traces in UPPAAL's XTR format, which its simulator and the program ``tracer`` of its library read.

A state is its location numbers, the bounds of its zone and its variables; a transition is its edges, each with its
process and the values of select variables. A dot ends each part, each bound and the trace. A bound ``i j b`` says that
clock i less clock j is at most b / 2, or is less than it where b is odd; what is not bounded is left out.
All numbers count from 0 within their process, in the order of `tachk.formats.uppaal.intermediate`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from tachk.meaning.dbm import Zone, bound_value, is_strict
from tachk.meaning.zones_of_run import zones_of_run
from tachk.model.network import Network
from tachk.model.run import DiscreteState, TimedTrace, Transition
from tachk.model.types import ChannelType, ClockType
from tachk.model.variable_layout import VariableLayout, variable_layout


def run_to_xtr(network: Network, run: TimedTrace) -> str:
    """The run as a symbolic trace: its transitions, with all valuations that can take them."""
    layout = variable_layout(network)
    zones = zones_of_run(network, run)
    lines = list(_state(layout, run.initial.discrete, zones[0]))
    taken = (step for step in run.steps if step.transition is not None)
    for step, zone in zip(taken, zones[1:], strict=True):
        assert step.transition is not None
        lines += _state(layout, step.state.discrete, zone)
        lines.append(_transition(step.transition))
    return "\n".join((*lines, ".")) + "\n"


def _state(layout: VariableLayout, state: DiscreteState, zone: Zone) -> Iterator[str]:
    yield _row(state.locations)
    yield "."
    for i, j, raw in zone.constraints():
        yield f"{i} {j} {2 * bound_value(raw) + is_strict(raw)}"
        yield "."
    yield "."
    pairs = zip(layout.types, state.values, strict=True)
    yield _row(value for leaf, value in pairs if not isinstance(leaf, ClockType | ChannelType))
    yield "."


def _transition(transition: Transition) -> str:
    edges = ((p.process, p.edge, *p.selects) for p in transition.participants)
    return "".join(f"{_row(edge)} ; " for edge in edges) + "."


def _row(numbers: Iterable[int]) -> str:
    return " ".join(map(str, numbers))
