"""The run that a search has found, with exact times, judged by other code than what found it.

A short run is judged by the reference meaning of the network, which shares not even the compiler with the search. It
takes a millisecond a transition and copies the recording's tables, so long ones are judged by the core (exact_run), and
by the reference only where the core cannot tell.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate
from math import lcm

from tachk.base.diagnostics.diagnostic import InternalError
from tachk.engine.compiler.program import Goal, Program
from tachk.engine.exact.concretise import concretise
from tachk.engine.exact.exact_run import Moments, exact_run
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import replay
from tachk.model.run import TimedTrace, Transition
from tachk.recordings.conformance.followers import Following

SHORT = 100
"""Runs of so many transitions are judged by the reference, too."""


def moments_of_run(
    following: Following, program: Program, goal: Goal, actions: Sequence[Sequence[int]], path: Sequence[Transition]
) -> Moments:
    """When the transitions of a path happen in a run to the end of the recording. Raises InternalError, ReplayError.

    Args:
        program, goal: of the network that follows the recording.
        actions: the path by the numbers of the edges of the program.
    """
    moments, _ = exact_run(program, goal, actions)
    if moments is not None and len(path) > SHORT:
        return moments
    by_reference = moments_of_trace(run_by_reference(following, path), len(path))
    return by_reference if moments is None else moments


def run_by_reference(following: Following, path: Sequence[Transition]) -> TimedTrace:
    """The earliest run along a path, made and judged by the meaning of the network. Raises as `moments_of_run`."""
    model = prepare(following.network)
    trace = concretise(model, path, following.done)
    if trace is None:
        raise InternalError("the run that was found cannot be made")
    replay(model, trace, following.done)
    return trace


def moments_of_trace(trace: TimedTrace, transitions: int) -> Moments:
    """When its transitions happen, and when it ends."""
    times = list(accumulate(step.delay for step in trace.steps))
    times += times[-1:] if len(times) == transitions else []
    unit = lcm(*(time.denominator for time in times))
    return Moments(tuple(int(time * unit) for time in times), unit)
