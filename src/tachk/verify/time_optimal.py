"""Time-optimal traces: the fastest and the slowest run in place of the run that was found.

The fastest run of all: a clock that nothing resets is added to the network, and bisection finds the least bound on it
with which the target is still reached. Along one path all times are solutions of difference constraints with integer
bounds, so the least time is an integer that is taken or only approached; each search that reaches the target gives the
exact least time of its path.
"""

from __future__ import annotations

from collections.abc import Sequence

from tachk.base.job import StoppedError, current_job
from tachk.base.operators import BinaryOperator
from tachk.base.records import replace
from tachk.base.words import QueryKind
from tachk.engine.exact.concretise import TimeOptimalRun, time_optimal_run
from tachk.engine.options import Limits, Options, Pace
from tachk.engine.outcome import INTERRUPTED, TIME_LIMIT
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.meaning.judge.replay import replay
from tachk.model.expressions import (
    BOOL,
    Binary,
    Constant,
    Expression,
)
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.run import Transition
from tachk.model.traversal import asks_deadlock
from tachk.transform.extension import Clocked, with_clock
from tachk.transform.observed import ObservedNetwork, observed
from tachk.verify.plan import Analysis, Search, Task
from tachk.verify.strategies import reachable
from tachk.verify.verdict import Verdict


def time_optimal(
    model: PreparedNetwork,
    search: Search,
    found: dict[int, Verdict],
    options: Options,
    limits: Limits,
) -> dict[int, Verdict]:
    """Verdicts with the fastest or slowest runs, as the options say, and a note about their times."""
    watched = observed(model.network, search.observer)
    whole = prepare(watched.network)
    result = dict(found)
    for task in search.tasks:
        verdict = found[task.number]
        if verdict.trace is None:
            continue
        optimal = _TimeOptimalSearch(whole, task.target, replace(options, pace=Pace.EARLY))
        try:
            if options.pace is Pace.SLOWEST:
                best, note = optimal.slowest(verdict.path)
            else:
                best, note = optimal.fastest(verdict.path, limits)
        except (TimeoutError, StoppedError):
            best, note = None, f"the run is not the {options.pace.value} one: {TIME_LIMIT}"
        result[task.number] = _with_run(watched, task, verdict, best, note)
    return result


def without_optimum(found: dict[int, Verdict], options: Options) -> dict[int, Verdict]:
    """Verdicts whose runs go on for ever or belong to values, so that none is the fastest."""
    note = f"the run is the one that was found: there is no {options.pace.value} one for such a query"
    return {n: v if v.trace is None else replace(v, notes=(*v.notes, note)) for n, v in found.items()}


def _with_run(
    watched: ObservedNetwork, task: Task, verdict: Verdict, best: TimeOptimalRun | None, note: str
) -> Verdict:
    verdict = replace(verdict, notes=(*verdict.notes, note))
    if best is None:
        return verdict
    run = best.run
    replay(prepare(watched.network), run, task.target)
    return replace(verdict, trace=watched.lift(run), moves=watched.moves(run), path=run.path)


class _TimeOptimalSearch:
    """The search for a fastest or a slowest run to a target."""

    def __init__(self, model: PreparedNetwork, target: Expression, options: Options) -> None:
        self._model = model
        self._target = target
        self._options = options

    def slowest(self, path: Sequence[Transition]) -> tuple[TimeOptimalRun | None, str]:
        """The slowest run along a path, and a note about its time."""
        best = time_optimal_run(self._model, path, self._target, True, current_job().seconds_left)
        if best is None or best.total is None:
            return best, "along this path the last step can be as late as one likes"
        if best.attained:
            return best, f"along this path the last step is at {best.total} at the latest"
        return best, f"along this path the last step comes as close to {best.total} as one likes, and is never at it"

    def fastest(self, path: Sequence[Transition], limits: Limits) -> tuple[TimeOptimalRun | None, str]:
        """The fastest run to the target, and a note about its time.

        Times are counted in halves: 2 * t is "exactly t", 2 * t + 1 "more than t, as close to it as one likes".
        """
        best = time_optimal_run(self._model, path, self._target, False, current_job().seconds_left)
        if best is not None and any(place.rates for p in self._model.network.processes for place in p.locations):
            return (
                best,
                f"along this path no run takes less than {best.total}; clocks stop, so no other was looked at",
            )
        low = 0
        while best is not None and low < _half_units(best):
            middle = (low + _half_units(best)) // 2
            verdict = self._within(middle, limits)
            if verdict.reason:
                return best, f"a faster run may exist: {verdict.reason}"
            if verdict.trace is None:
                low = middle + 1
                continue
            best = time_optimal_run(self._model, verdict.path, self._target, False, current_job().seconds_left)
        if best is None:  # what the engine has found cannot be without a run
            raise AssertionError("a path that was found has no run")
        if best.attained:
            return best, f"no run takes less than {best.total}"
        return best, f"runs take as little more than {best.total} as one likes, and none takes {best.total}"

    def _within(self, half_units: int, limits: Limits) -> Verdict:
        """The verdict whether some run reaches the target in this number of half time units."""
        bound, strict = (half_units + 1) // 2, half_units % 2 == 1
        timed, in_time = _in_time(self._model.network, self._target, bound, strict)
        query = Query("fastest", QueryKind.POSSIBLY, in_time, text="the target in time")
        search = Search(Analysis.REACHABILITY, (Task(0, query),))
        verdict = reachable(prepare(timed.network), search, self._options, limits, True)[0]
        if verdict.reason == INTERRUPTED:
            raise KeyboardInterrupt
        return verdict


def _half_units(best: TimeOptimalRun) -> int:
    assert best.total is not None and best.total.denominator == 1
    return 2 * best.total.numerator + (not best.attained)


def _in_time(network: Network, target: Expression, bound: int, strict: bool) -> tuple[Clocked, Expression]:
    """A network with a clock that is never reset, and the target with a bound on that clock.

    Time ends at the bound, which makes the search smaller; not where a deadlock is looked for, which that would be.
    """
    operator = BinaryOperator.LESS if strict else BinaryOperator.LESS_EQUAL

    def early(clock: Expression) -> Expression:
        return Binary(operator, clock, Constant(bound), BOOL)

    timed = with_clock(network, None if asks_deadlock(target) else early)
    return timed, Binary(BinaryOperator.AND, target, early(timed.clock), BOOL)
