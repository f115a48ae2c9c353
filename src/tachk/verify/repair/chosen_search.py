"""Searches that try many choices for the parts of a model: each gives a variable a value.

A choice is made at the beginning, by a process that is added, or on the way, by an edge of the part itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

from tachk.base.job import check_job
from tachk.base.records import dataclass, replace
from tachk.engine.compiler.lower import lower
from tachk.engine.options import Limits, Options, SearchOrder
from tachk.engine.outcome import INTERRUPTED, Status
from tachk.engine.zone import explore
from tachk.model.builder import ProcessBuilder, Term
from tachk.model.expressions import Reference, Variable, VariableKind
from tachk.model.network import Edge
from tachk.model.run import RunTimeFault
from tachk.recordings.conformance.components import IndependentComponent, restricted
from tachk.recordings.conformance.event_streams import EventStreams, make_streams
from tachk.recordings.conformance.events import EventLog
from tachk.recordings.conformance.nearest_log import NearestLogSearch, Start
from tachk.recordings.conformance.resumed import resumed
from tachk.recordings.conformance.trace_product import TraceProduct

_STATES = 400_000
"""So many states at most are stored in a search."""
_BATCH = 40
"""So many choices are tried in one search."""


@dataclass(frozen=True, slots=True)
class ChosenValue:
    """Attributes:
    number: of what is chosen.
    variable, value: the variable holds the value where it is chosen.
    first: it is made at the beginning.
    """

    number: int
    variable: Variable
    value: int
    first: bool

    @property
    def term(self) -> Term:
        return Term(Reference(self.variable))


def accepting_choices(
    near: NearestLogSearch,
    recording: EventLog,
    choices: Sequence[ChosenValue],
    product_of: Callable[[EventStreams, IndependentComponent, frozenset[int]], TraceProduct],
    made_by: Callable[[Edge], int | None] = lambda edge: None,
) -> set[int]:
    """The numbers of the choices with which the parts of a model go along with events. One that leads to a run-time
    error is no such choice, nor one that is not decided within the limits.

    Args:
        near: knows the states from which the parts go on.
        product_of: the network that follows the events of a part, with the edges that make choices with these numbers.
        made_by: the number of the choice that an edge of a part makes.
    """
    streams = make_streams(near.network, near.mapping, recording, near.constants, near.uncertainty)
    left = list(choices)
    for start, known in zip(near.starts, near.known, strict=True):
        if left and not near.part(start, known, streams):
            component = start.reached.component
            product = partial(product_of, restricted(streams, component), component)
            accepting = _accepting(left, product, start, near.limits, made_by)
            left = [choice for choice in left if choice.number in accepting]
    return {choice.number for choice in left}


def _accepting(
    choices: Sequence[ChosenValue],
    product_of: Callable[[frozenset[int]], TraceProduct],
    start: Start,
    limits: Limits,
    made_by: Callable[[Edge], int | None],
) -> set[int]:
    """The choices with which one part goes along."""
    accepting: set[int] = set()
    for first in range(0, len(choices), _BATCH):
        batch = list(choices[first : first + _BATCH])
        while batch:
            product = product_of(frozenset(choice.number for choice in batch))
            mentioned = set(product.network.variables)
            batch = [choice for choice in batch if choice.variable in mentioned]
            reached, failing = _reached(product, start, batch, limits, made_by)
            accepting |= reached
            done = reached | {failing}
            batch = [choice for choice in batch if choice.number not in done] if failing is not None else []
    return accepting


def _reached(
    product: TraceProduct,
    start: Start,
    choices: Sequence[ChosenValue],
    limits: Limits,
    made_by: Callable[[Edge], int | None],
) -> tuple[set[int], int | None]:
    """The choices with which the events are a run, and the one that leads to the run-time error that ended the
    search."""
    check_job()
    later = product if start.end is None else resumed(product, start.reached.product, start.end)
    if later is None:
        return set(), None
    firsts = [choice for choice in choices if choice.first]
    if firsts:
        later = _with_chooser(later, firsts, len(firsts) < len(choices))
    goals = [((choice.term == choice.value) & Term(later.done)).expression for choice in choices]
    program, compiled = lower(later.network, goals, later.tables)
    outcome = explore(program, compiled, Options(order=SearchOrder.DFS), limits.of_states(_STATES))
    if outcome.reason == INTERRUPTED:
        raise KeyboardInterrupt
    answers = zip(choices, outcome.goals, strict=True)
    reached = {choice.number for choice, goal in answers if goal.status is Status.REACHED}
    return reached, None if outcome.fault is None else _culprit(later, outcome.fault, firsts, made_by)


_CHOOSER = "chooser"


def _with_chooser(product: TraceProduct, firsts: Sequence[ChosenValue], others: bool) -> TraceProduct:
    """The network with a process that makes one of the choices at the beginning.

    Args:
        others: it may also make none.
    """
    process = ProcessBuilder("chooser.", VariableKind.LOCAL, name=_CHOOSER)
    here, there = process.location("choosing", committed=True), process.location("chosen")
    for choice in firsts:
        process.edge(here, there, updates=[choice.term.assign(choice.value)])
    if others:
        process.edge(here, there)
    network = replace(
        product.network,
        processes=(*product.network.processes, process.build()),
        hidden=(*product.network.hidden, _CHOOSER),
    )
    return replace(product, network=network)


def _culprit(
    product: TraceProduct, fault: RunTimeFault, firsts: Sequence[ChosenValue], made_by: Callable[[Edge], int | None]
) -> int | None:
    """The choice that was made on the way to a run-time error."""
    for transition in (*fault.path, *([fault.transition] if fault.transition is not None else [])):
        for participant in transition.participants:
            process = product.network.processes[participant.process]
            if process.name == _CHOOSER:
                if participant.edge < len(firsts):
                    return firsts[participant.edge].number
                continue
            number = made_by(process.edges[participant.edge])
            if number is not None:
                return number
    return None
