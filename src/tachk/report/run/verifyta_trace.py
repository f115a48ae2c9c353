"""Traces in the text form of UPPAAL's verifyta.

A state is ``State:``, the locations between parentheses, and clocks and variables in one line; a transition is
``Transitions:`` and one line for each edge; ``Delay: d`` stands between two states.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from tachk.formats.edge_text import edge_text
from tachk.meaning.dbm import Zone, bound_value, is_strict
from tachk.meaning.discrete import prepare, stopped_clocks
from tachk.meaning.run_view import Snapshot, view_trace
from tachk.meaning.zones_of_run import clocks_after, zones_of_run
from tachk.model.network import Network
from tachk.model.run import TimedTrace, Transition


def concrete_trace(network: Network, run: TimedTrace) -> str:
    """The run with its delays and the values of all clocks."""
    view = view_trace(network, run)
    model = prepare(network)
    blocks = [_state("State:", view.initial, _clock_values(view.initial, run.initial.clocks))]
    state, shown = run.initial, view.initial
    for step, seen in zip(run.steps, view.steps, strict=True):
        if step.delay:
            blocks.append(f"Delay: {_number(step.delay)}\n")
            late = clocks_after(state.clocks, step.delay, stopped_clocks(model, state.discrete))
            blocks.append(_state("State:", shown, _clock_values(shown, late)))
        if step.transition is not None:
            blocks.append(_transition(network, step.transition))
            blocks.append(_state("State:", seen.state, _clock_values(seen.state, step.state.clocks)))
        state, shown = step.state, seen.state
    return "\n" + "\n".join(blocks)


def symbolic_trace(network: Network, run: TimedTrace) -> str:
    """The transitions of the run with all valuations that can take them."""
    view = view_trace(network, run)
    names = ["t(0)", *(name for name, _ in view.initial.clocks or ())]
    zones = iter(zones_of_run(network, run))
    blocks = [_state("State", view.initial, _bounds(names, next(zones)))]
    for step, seen in zip(run.steps, view.steps, strict=True):
        if step.transition is not None:
            blocks.append(_transition(network, step.transition))
            blocks.append(_state("State", seen.state, _bounds(names, next(zones))))
    return "\n" + "\n".join(blocks)


def _state(head: str, state: Snapshot, clocks: Iterator[str]) -> str:
    locations = " ".join(f"{process}.{location}" for process, location in state.locations)
    values = [*clocks, *(f"{name}={int(value)}" for name, value in state.variables)]
    return f"{head}\n( {locations} )\n{' '.join(values)}\n"


def _clock_values(state: Snapshot, values: tuple[Fraction, ...]) -> Iterator[str]:
    names = (name for name, _ in state.clocks or ())
    return (f"{name}={_number(value)}" for name, value in zip(names, values, strict=True))


def _bounds(names: list[str], zone: Zone) -> Iterator[str]:
    """The bounds of a zone; those on a single clock without clock 0, lower bounds turned round."""
    for i, j, raw in zone.constraints():
        sign, value = "<" if is_strict(raw) else "<=", bound_value(raw)
        if i == 0:
            if raw != 1:
                yield f"{names[j]}{sign.replace('<', '>')}{-value}"
        elif j == 0:
            yield f"{names[i]}{sign}{value}"
        else:
            yield f"{names[i]}-{names[j]}{sign}{value}"


def _transition(network: Network, transition: Transition) -> str:
    lines = ["Transitions:"]
    for participant in transition.participants:
        process = network.processes[participant.process]
        edge = process.edges[participant.edge]
        said = edge_text(network, process, edge, ":=")
        source, target = process.locations[edge.source].name, process.locations[edge.target].name
        labels = f"{said.guard}, {said.synchronisation}, {said.updates}"
        lines.append(f"  {process.name}.{source}->{process.name}.{target} {{ {labels} }}")
    return "\n".join(lines) + "\n"


def _number(value: Fraction) -> str:
    return str(value.numerator) if value.denominator == 1 else f"{float(value):.9g}"
