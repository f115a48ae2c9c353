"""Findings about infinitely many actions in finite time (`tachk.analysis.recurrent_edges` says which edges do that)."""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Sequence

from tachk.analysis.edge_steps import EdgeStep
from tachk.analysis.fold import Known
from tachk.analysis.recurrent_edges import steps_but, suspicious
from tachk.base.diagnostics.diagnostic import Diagnostic, InternalError, Label
from tachk.base.job import StoppedError, limited
from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass
from tachk.engine.compiler.lower import lower_recurrence
from tachk.engine.lasso import lasso
from tachk.engine.liveness import find_recurring_run
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import LivenessStatus, Obligation
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.meaning.judge.replay import ReplayError, replay
from tachk.meaning.judge.replay_lasso import replay_lasso
from tachk.model.expressions import BOOL, Binary, Constant
from tachk.model.network import Network, Process
from tachk.model.run import TimedTrace, Transition
from tachk.transform.doubled_edges import with_guessed_suffix

_SECONDS_FOR_DELAYS = 10.0


@dataclass(frozen=True, slots=True)
class ZenoRun:
    """Attributes:
    loop: transitions that are taken again and again in finite time.
    run: one that does, which has been replayed; None if its delays were not found in time.
    """

    loop: tuple[Transition, ...]
    run: TimedTrace | None


def find_zeno_run(
    model: PreparedNetwork,
    lasting: Collection[tuple[int, int]],
    options: Options,
    limits: Limits,
) -> ZenoRun | bool:
    """A run in which time does not diverge although it takes infinitely many transitions. True where there may be one:
    a limit was hit, or an error of the model, or clocks stop; False where there is none.

    Args:
        lasting: the edges (process and number) that such a run may take for ever.
    """
    doubled = with_guessed_suffix(model.network, lasting)
    never, late = Constant(0, BOOL), Binary(BinaryOperator.GREATER_EQUAL, doubled.clock, Constant(1), BOOL)
    program, goals = lower_recurrence(doubled.network, late, never, doubled.mark, ())
    outcome = find_recurring_run(program, goals, True, options, limits)
    if outcome.status is LivenessStatus.NONE:
        return False
    if outcome.run is None or not outcome.exact:
        return True
    whole = prepare(doubled.network)
    obligation = Obligation(late, doubled.mark)
    loop = tuple(map(doubled.lift_transition, outcome.run.loop))
    try:
        with limited(_SECONDS_FOR_DELAYS):
            run = lasso(whole, outcome.run, obligation)
    except StoppedError:
        return ZenoRun(loop, None)
    if run is None:
        return ZenoRun(loop, None)
    alone = doubled.lift(run)
    try:
        replay_lasso(whole, run, obligation.goal, obligation.trigger)
        replay(model, alone)
    except ReplayError as error:
        raise InternalError(f"the run found to take finite time does not replay: {error}") from error
    return ZenoRun(loop, alone)


def zeno_findings(network: Network, known: Known, never: Collection[tuple[int, int]]) -> tuple[Diagnostic, ...]:
    """A cycle of each template that may be taken for ever in finite time. None where there is certainly no such run.

    Args:
        never: edges that are known never to be taken.
    """
    left = suspicious(steps_but(network, known, never))
    findings = []
    named: set[str] = set()
    for number, process in enumerate(network.processes):
        own = [step for step in sorted(left, key=lambda step: step.number) if step.process == number]
        if not own or process.template in named or all(step.channels and not step.sends for step in own):
            continue
        named.add(process.template)
        cycle = _shortest_cycle(own)
        edges = [step.number for step in cycle]
        findings.append(_finding(process, edges, f"`{process.name}` may go round"))
    return tuple(findings)


def zeno_finding(network: Network, loop: Sequence[Transition]) -> Diagnostic:
    """The finding that a loop is taken for ever in finite time, at the process that decides its first transition."""
    number = loop[0].participants[0].process
    edges = [p.edge for transition in loop for p in transition.participants if p.process == number]
    process = network.processes[number]
    return _finding(process, edges, f"`{process.name}` goes round")


def _finding(process: Process, edges: Sequence[int], what: str) -> Diagnostic:
    taken = [process.edges[edge] for edge in edges]
    names = [process.locations[edge.source].name for edge in taken]
    spans = [edge.spans[0] for edge in taken]
    return Diagnostic(
        "W0607",
        f"{what} `{' -> '.join([*names, names[0]])}` without end in finite time",
        spans[0],
        "let a clock be reset in the cycle and compared there with at least 1, if time is to pass",
        tuple(Label(span, "then this") for span in dict.fromkeys(spans[1:]) if span != spans[0]),
    )


def _shortest_cycle(steps: list[EdgeStep]) -> list[EdgeStep]:
    """A shortest cycle through one of the edges, each of which lies on one."""
    best: list[EdgeStep] = []
    for first in steps:
        ways: dict[int, list[EdgeStep]] = {first.target: [first]}
        waiting = deque([first.target])
        while waiting and first.source not in ways:
            here = waiting.popleft()
            for step in steps:
                if step.source == here and step.target not in ways:
                    ways[step.target] = [*ways[here], step]
                    waiting.append(step.target)
        way = ways.get(first.source, [])
        if way and (not best or len(way) < len(best)):
            best = way
    return best
