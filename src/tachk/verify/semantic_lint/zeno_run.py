"""Whether infinitely many actions really happen in finite time, by a search.

From some moment on such a run takes less than one time unit. So it is a run that goes on for ever without reaching the
time of one unit after one of its actions: which one is guessed.
"""

from __future__ import annotations

from collections.abc import Collection

from tachk.base.diagnostics.diagnostic import InternalError
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
