"""Each transformation of `tachk.transform`, of a random network: a new one is a line more in `TRANSFORMATIONS`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from fractions import Fraction
from random import Random

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.operators import BinaryOperator
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.meaning.step import StepError, delay, initial_state, successors
from tachk.model.event import BecomesTrue
from tachk.model.expressions import BOOL, Binary, Constant, Expression, LocationTest, VariableKind
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tachk.model.run import TimedStep, TimedTrace
from tachk.model.traversal import process_expressions
from tachk.simulation.fmi.environment import open_network
from tachk.transform.blocking_processes import without_blocking
from tachk.transform.cone_of_influence import cone_of_influence, mentioned
from tachk.transform.doubled_edges import strongly_non_zeno, with_guessed_resets, with_guessed_suffix
from tachk.transform.event_timer import with_event_timer
from tachk.transform.extension import with_clock
from tachk.transform.guided import guided
from tachk.transform.liveness_slice import liveness_preserving_slice
from tachk.transform.monotone_counters import monotone_counters
from tachk.transform.observed import observed
from tachk.transform.transformation import Transformation
from tests.support.observer_agreement import random_watched

Transforming = Callable[[Random, Network, Expression], Transformation | None]
"""From a network, and what is asked about it, to a transformation; None where there is none."""


def _observed(random: Random, network: Network, _: Expression) -> Transformation | None:
    if network.has_priorities:
        return None
    query = random_watched(random, network)
    return None if query is None else observed(network, query.observer)


def _with_bounded_clock(random: Random, network: Network, _: Expression) -> Transformation:
    bound = Constant(random.randrange(1, 6))
    return with_clock(network, lambda clock: Binary(BinaryOperator.LESS_EQUAL, clock, bound, BOOL))


def _with_event_timer(random: Random, network: Network, _: Expression) -> Transformation:
    start, end = (BecomesTrue(LocationTest(0, place), random.random() < 0.5) for place in (0, 1))
    return with_event_timer(network, random.choice([None, start]), end, random.random() < 0.5)


def _with_guessed_suffix(random: Random, network: Network, _: Expression) -> Transformation | None:
    if network.has_priorities:
        return None
    edges = [(n, edge) for n, process in enumerate(network.processes) for edge in range(len(process.edges))]
    return with_guessed_suffix(network, random.sample(edges, len(edges) // 2))


def _guided(random: Random, network: Network, target: Expression) -> Transformation | None:
    relaxed = without_blocking(network, [target])
    run = random_run(random, relaxed.network)
    if run is None or not run.path:
        return None
    members = {number for number, process in enumerate(relaxed.network.processes) if process.edges}
    return guided(network, run.path, members, monotone_counters(network, [target]))


def _open(random: Random, network: Network, _: Expression) -> Transformation | None:
    process = random.choice(network.processes)
    own = {*network.variables, *process.variables}
    if any(variable.kind is VariableKind.LOCAL for variable in mentioned(process_expressions(process))[1] - own):
        return None  # its edges use a clock that another transformation has put beside another process
    with suppress(UsageError):
        return open_network(network, [process.name])
    return None


TRANSFORMATIONS: Mapping[str, Transforming] = {
    "cone of influence": lambda _, network, target: cone_of_influence(network, [target]),
    "without what only blocks": lambda _, network, target: without_blocking(network, [target]),
    "liveness-preserving slice": lambda _, network, target: liveness_preserving_slice(network, [target]),
    "guided": _guided,
    "observed": _observed,
    "clock": lambda _random, network, _target: with_clock(network),
    "bounded clock": _with_bounded_clock,
    "event timer": _with_event_timer,
    "strongly non-Zeno": lambda random, network, _: strongly_non_zeno(network, random.randrange(1, 4)),
    "guessed suffix": _with_guessed_suffix,
    "guessed resets": lambda _random, network, _target: with_guessed_resets(network),
    "open network": _open,
}


def random_run(random: Random, network: Network, moves: int = 12) -> TimedTrace | None:
    """A run as the meaning of the network has it; None if it has none."""
    model = prepare(network)
    try:
        return _random_run(random, model, moves)
    except (StepError, EvaluationFault):
        return None


def _random_run(random: Random, model: PreparedNetwork, moves: int) -> TimedTrace:
    state = initial = initial_state(model)
    steps: list[TimedStep] = []
    waited = Fraction(0)
    for _ in range(moves):
        with suppress(StepError, EvaluationFault):
            pause = Fraction(random.choice([0, 0, 1, 1, 2, 5]), random.choice([1, 2]))
            state, waited = delay(model, state, pause), waited + pause
        try:
            following = successors(model, state)
        except EvaluationFault:
            break
        if following:
            transition, state = random.choice(following)
            steps.append(TimedStep(waited, transition, state))
            waited = Fraction(0)
    if waited:
        steps.append(TimedStep(waited, None, state))
    return TimedTrace(initial, tuple(steps))
