"""Networks with an observer beside them, and the runs of the network alone that the observer's runs show."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.base.records import dataclass
from tachk.model.cell_layout import cell_layout
from tachk.model.network import Network
from tachk.model.query import Observer, Query
from tachk.model.run import DiscreteState, RunTimeFault, TimedState, TimedStep, TimedTrace, Transition


@dataclass(frozen=True, slots=True)
class ObserverMove:
    """``time``: since the start of the run; ``location``: where the observer is from then on."""

    time: Fraction
    location: str


def observed(network: Network, observer: Observer | None) -> Network:
    """The network with the observer as its last process."""
    if observer is None:
        return network
    return replace(network, processes=(*network.processes, observer.process))


def check_observable(network: Network, query: Query) -> None:
    """Raises UnsupportedError if an observer would keep the network from acting, which priorities make it do."""
    if query.observer is not None and network.has_priorities:
        raise UnsupportedError(
            Diagnostic(
                "E0732",
                "temporal properties are not checked in models with priorities of channels or processes",
                query.span,
                "let a location of the model mark the violation, and ask with A[] that it is not reached",
            )
        )


def without_observer(network: Network, trace: TimedTrace) -> tuple[TimedTrace, tuple[ObserverMove, ...]]:
    """A run of the observed network as the run of the network alone, and what the observer did meanwhile.

    Args:
        network: with the observer.
    """
    observer = len(network.processes) - 1
    process = network.processes[observer]
    alone = cell_layout(replace(network, processes=network.processes[:-1]))
    cells, clocks = len(alone.initial), len(alone.clock_cells)

    def own(state: TimedState) -> TimedState:
        discrete = DiscreteState(state.discrete.locations[:observer], state.discrete.values[:cells])
        return TimedState(discrete, state.clocks[:clocks], state.time)

    steps: list[TimedStep] = []
    moves: list[ObserverMove] = []
    waited = Fraction(0)
    loop_start: int | None = None
    due = trace.due
    for number, step in enumerate(trace.steps):
        if trace.due is not None and number == trace.due.steps:
            due = replace(trace.due, steps=len(steps))
        if number == trace.loop_start:
            if waited:
                steps.append(TimedStep(waited, None, own(trace.states[number])))
                waited = Fraction(0)
            loop_start = len(steps)
        waited += step.delay
        if step.transition is None or _is_own(step.transition, observer):
            location = process.locations[step.state.discrete.locations[observer]]
            if step.transition is not None and not location.committed:
                moves.append(ObserverMove(step.state.time, location.name))
            continue
        steps.append(TimedStep(waited, step.transition, own(step.state)))
        waited = Fraction(0)
    if waited:
        steps.append(TimedStep(waited, None, own(trace.steps[-1].state)))
    return TimedTrace(own(trace.initial), tuple(steps), trace.ending, loop_start, due), tuple(moves)


def fault_without_observer(network: Network, fault: RunTimeFault) -> RunTimeFault:
    """A run-time error of the observed network, told of the network alone."""
    observer = len(network.processes) - 1
    path = tuple(transition for transition in fault.path if not _is_own(transition, observer))
    failed = None if fault.transition is None or _is_own(fault.transition, observer) else fault.transition
    run = None if fault.run is None else without_observer(network, fault.run)[0]
    return replace(fault, path=path, transition=failed, run=run)


def _is_own(transition: Transition, observer: int) -> bool:
    return transition.participants[0].process == observer
