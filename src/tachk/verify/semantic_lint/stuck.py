"""States from which no action is possible, now or later: deadlocks, and among them those that time cannot leave."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import reduce

from tachk.analysis.conditions import ClockAtom, split_conjunction
from tachk.analysis.fold import Known
from tachk.base.diagnostics.diagnostic import Diagnostic, Label
from tachk.base.records import dataclass
from tachk.meaning.discrete import PreparedNetwork, environment
from tachk.meaning.step import StepError, delay
from tachk.model.connectives import both, either, negation
from tachk.model.evaluate import evaluate
from tachk.model.expressions import BOOL, Constant, Deadlock, Expression, LocationTest
from tachk.model.network import Network
from tachk.model.run import TimedTrace


@dataclass(frozen=True, slots=True)
class TimeBoundedLocation:
    """A location that lets only a limited time pass where the condition is true: it is urgent or committed, or its
    invariant has an upper bound."""

    process: int
    location: int
    condition: Expression
    invariant: bool


def bounds_on_time(network: Network, known: Known) -> Iterator[TimeBoundedLocation]:
    """The locations that limit time. Only right where no clock ever stops."""
    for number, process in enumerate(network.processes):
        for place, location in enumerate(process.locations):
            if location.urgent or location.committed:
                yield TimeBoundedLocation(number, place, Constant(1, BOOL), False)
            elif location.invariant is not None:
                parts = split_conjunction(location.invariant, known)
                for condition, atom in parts.clocks:
                    if _is_upper(atom):
                        yield TimeBoundedLocation(
                            number, place, Constant(1, BOOL) if condition is None else condition, True
                        )


def _is_upper(atom: ClockAtom) -> bool:
    return atom.left is not None and atom.right is None


def time_locks(bounds: list[TimeBoundedLocation]) -> Expression:
    """The states from which neither an action is possible nor time can pass for ever."""
    return both(Deadlock(), _limited(bounds))


def plain_deadlocks(bounds: list[TimeBoundedLocation]) -> Expression:
    """The states from which no action is possible while time passes."""
    return both(Deadlock(), unlimited(bounds))


def unlimited(bounds: list[TimeBoundedLocation]) -> Expression:
    """The states in which no invariant and no urgent or committed location limits time."""
    return negation(_limited(bounds))


def _limited(bounds: list[TimeBoundedLocation]) -> Expression:
    conditions = [both(LocationTest(bound.process, bound.location), bound.condition) for bound in bounds]
    return reduce(either, conditions) if conditions else Constant(0, BOOL)


def time_lock_finding(model: PreparedNetwork, bounds: list[TimeBoundedLocation], run: TimedTrace) -> Diagnostic:
    """The invariants that stop time at the end of a run: the first location, and the others."""
    state = run.states[-1].discrete
    values = environment(model, state)
    ending = [
        bound
        for bound in bounds
        if state.locations[bound.process] == bound.location and evaluate(bound.condition, values) != 0
    ]
    names, spans = [], []
    for bound in ending:
        process = model.network.processes[bound.process]
        location = process.locations[bound.location]
        names.append(f"{process.name}.{location.name}")
        whole = location.invariant.span if bound.invariant and location.invariant is not None else location.span
        spans.append(whole)
    what = f"the invariant of {names[0]}" if ending[0].invariant else f"{names[0]}, which must be left at once,"
    return Diagnostic(
        "W0605",
        f"time-lock: {what} lets no more time pass, and no action is possible: no run goes on from here",
        spans[0],
        "give the location an edge that can be taken in time, or a weaker invariant",
        tuple(Label(span, f"{name}, too") for name, span in dict(zip(names[1:], spans[1:], strict=True)).items()),
    )


def time_passes(model: PreparedNetwork, run: TimedTrace) -> bool:
    """True if time may pass at the end of a run that no invariant and no location stops.

    An urgent channel stops it where the guards of a synchronisation hold and an invariant of its targets does not.
    """
    try:
        delay(model, run.states[-1], Fraction(1))
    except StepError:
        return False
    return True


def urgent_lock_finding(network: Network, run: TimedTrace) -> Diagnostic:
    """A time-lock at the end of a run by an urgent channel whose synchronisation an invariant forbids."""
    state = run.states[-1].discrete
    here = [process.locations[place] for process, place in zip(network.processes, state.locations, strict=True)]
    span = next(
        (
            edge.spans[0]
            for process, place in zip(network.processes, state.locations, strict=True)
            for edge in process.edges
            if edge.source == place and edge.begins and edge.is_urgent
        ),
        here[0].span,
    )
    return Diagnostic(
        "W0605",
        "time-lock: an urgent channel lets no more time pass, but the invariant behind its edges forbids to take them, "
        "and no action is possible: no run goes on from here",
        span,
        "let the guard of the edge say what the invariant of its target demands",
    )


def every_run_ends(time_lock: Diagnostic) -> Diagnostic:
    """The note on a time-lock where no run lets time pass without end."""
    return Diagnostic(
        "W0610",
        "every run of the model ends in a time-lock: in none does time pass without end",
        time_lock.span,
        "an `A[]` that holds here says only that nothing bad happens before time stops",
    )


def deadlock_finding(network: Network, run: TimedTrace) -> Diagnostic:
    """The finding that a deadlock is reached, at the process that moved last, if one did."""
    state = run.states[-1].discrete
    moved = run.path
    number = moved[-1].participants[0].process if moved else 0
    where = ", ".join(
        f"{process.name}.{process.locations[location].name}"
        for process, location in zip(network.processes, state.locations, strict=True)
        if not network.hides(process)
    )
    process = network.processes[number]
    return Diagnostic(
        "W0606",
        f"deadlock: time passes, but no action is possible any more in {where}",
        process.locations[state.locations[number]].span,
        "if the system ends here, this is as it should be; if not, an edge is missing or never possible",
    )
