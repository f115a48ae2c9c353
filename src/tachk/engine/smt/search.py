"""Bounded model checking and induction: the answers of the second engine.

Step after step the runs of a network are unrolled (Biere, Cimatti, Clarke, Zhu 1999; for timed automata Audemard,
Cimatti, Kornilowicz, Sebastiani 2002). A goal that some run reaches is found; a bound never proves that none does. What
does is induction over k steps (Sheeran, Singh, Stålmarck 2000), here with a set of zones as the hypothesis where plain
induction fails, or that there is no longer run at all.
"""

from __future__ import annotations

import time
from collections.abc import Sequence

from tachk.base.job import StoppedError, current_job, note_interruption
from tachk.engine.options import Limits
from tachk.engine.outcome import INTERRUPTED, GoalOutcome, Outcome, Statistics, Status
from tachk.engine.smt.proofs import Proofs
from tachk.engine.smt.relation import relation
from tachk.engine.smt.solving import GaveUpError, SolverOptions
from tachk.engine.smt.targets import Targets
from tachk.engine.smt.unrolling import Unrolled
from tachk.model.expressions import Expression
from tachk.model.network import Network
from tachk.model.run import RunTimeFault

DEPTH = 64
"""The number of steps that are unrolled where no limit is given."""


def explore(
    network: Network, goals: Sequence[Expression], limits: Limits = Limits(), induction: bool = True
) -> Outcome:
    """Searches until every goal is reached or proved unreachable, or a limit is hit.

    Without ``induction`` a goal is proved unreachable only if there is no run that could be longer.

    ``limits.depth`` bounds the steps that are unrolled, `DEPTH` if it is None. ``limits.states`` is not looked at. In
    the statistics a state is a step that was unrolled, a transition a question to z3.

    Raises UnsupportedError for what is not encoded.
    """
    started = time.monotonic()
    unrolled: Unrolled | None = None

    def statistics() -> Statistics:
        depth = 0 if unrolled is None else unrolled.depth
        return Statistics(depth, depth, settings.queries, time.monotonic() - started)

    job = current_job()

    def report() -> None:
        if job.progress is not None:
            job.progress(statistics(), job.about)

    settings = SolverOptions(
        job.ends,
        None if limits.memory_bytes is None else max(limits.memory_bytes >> 20, 1),
        report,
    )
    reason, status, fault = "", {}, None
    try:
        targets = Targets.of(relation(network), goals)
        unrolled = Unrolled(targets, settings)
        status = unrolled.status
        proofs = Proofs(targets, settings, network, goals) if induction else None
        fault, reason = _decide(unrolled, proofs, limits.depth)
    except GaveUpError as given_up:
        reason = given_up.reason
    except StoppedError as error:
        reason = error.reason
    except KeyboardInterrupt:
        note_interruption()
        reason = INTERRUPTED
    outcomes = tuple(status.get(number, GoalOutcome(Status.UNDECIDED)) for number in range(len(goals)))
    if all(goal.status is not Status.UNDECIDED for goal in outcomes):
        reason = ""
    failed = next((goal.fault for goal in outcomes if goal.fault is not None), None)
    if fault is None and failed is not None:
        fault, reason = failed, reason or "run-time error"
    return Outcome(outcomes, statistics(), reason, fault)


def _decide(unrolled: Unrolled, proofs: Proofs | None, depth_limit: int | None) -> tuple[RunTimeFault | None, str]:
    """Decides goals. Returns the error, and the reason why a goal is still open."""
    fault = unrolled.entry_fault()
    while fault is None:
        unrolled.stay()
        unrolled.note_reached_goals()
        unrolled.fail()
        if not unrolled.open:
            return None, ""
        fault = unrolled.fault()
        if fault is not None:
            break
        for number in [] if proofs is None else proofs.proved(unrolled.depth, unrolled.open):
            unrolled.status[number] = GoalOutcome(Status.UNREACHABLE)
        if not unrolled.open:
            return None, ""
        if unrolled.depth >= (DEPTH if depth_limit is None else depth_limit):
            return None, "depth limit"
        if not unrolled.go_on():
            unrolled.status |= dict.fromkeys(unrolled.open, GoalOutcome(Status.UNREACHABLE))
            return None, ""
        fault = unrolled.entry_fault()
    return fault, "run-time error"
