"""The online monitor of the core against the oracle, step by step."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from random import Random

from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.online_monitor import OnlineMonitor
from tests.support.exact_monitor import verdict
from tests.support.exact_trace import Ending
from tests.support.formulas import MonitoringCase
from tests.support.monitor_input import MonitorInput, first_violation, guarded, monitor_input, portions, truth_of


def online_problems(case: MonitoringCase, refinement: int = 1, seed: int = 0) -> tuple[str, ...]:
    """Where the online monitor and the oracle differ first while the trace comes in portions drawn with the seed.

    After every portion the verdict has to be that of the oracle on what is known, so it comes neither too early nor too
    late. Bounds of the robustness must never widen, hold the final value, and be exact at the end.
    """
    problem = next(_problems(case, monitor_input(case, refinement), Random(seed)), None)
    return () if problem is None else (problem,)


def _problems(case: MonitoringCase, given: MonitorInput, random: Random) -> Iterator[str]:
    quantitative = random.random() < 0.8
    monitor = OnlineMonitor(given.program, robustness=quantitative)
    final = verdict(case.formula, case.trace)
    violation = first_violation(case, given) if guarded(case.formula) is not None else None
    known = truth_of(verdict(case.formula, case.trace.prefix(Fraction(0), Ending.OPEN)))
    decided_at: int | None = None
    bounds = -math.inf, math.inf
    for reached in _fed(monitor, given, random):
        finished = monitor.finished
        for time in dict.fromkeys(reached):
            if known is Truth.UNDETERMINED:
                prefix = case.trace if finished else case.trace.prefix(_instant(given, time), Ending.OPEN)
                known = truth_of(verdict(case.formula, prefix))
                decided_at = None if known is Truth.UNDETERMINED else time
        place = f"after {reached[-1]} of {given.trace.end} ticks" if reached else "after nothing"
        if monitor.verdict is not known:
            yield f"{place}: {monitor.verdict.word}, not {known.word}"
        found = monitor.decided_at
        if (None if found is None else found - monitor.beginning) != decided_at:
            yield f"{place}: decided at {found}, not {decided_at}"
        if guarded(case.formula) is not None and monitor.violation is not None:
            stretch = monitor.violation
            within = stretch.first, min(stretch.last, 2 * given.trace.end)
            if (stretch.settled or finished) and within != violation:
                yield f"{place}: violation {stretch}, not {violation}"
        if quantitative:
            low, high = monitor.robustness
            if not bounds[0] <= low <= final.low <= final.high <= high <= bounds[1]:
                yield f"{place}: robustness [{low}, {high}] after {bounds}, not around {final}"
            bounds = low, high
    if quantitative and bounds != (final.low, final.high):
        yield f"at the end: robustness {bounds}, not {final}"
    if violation is not None and monitor.violation is None:
        yield f"at the end: no violation, not {violation}"


def _fed(monitor: OnlineMonitor, given: MonitorInput, random: Random) -> Iterator[list[int]]:
    """Feeds the monitor call by call; after each call the ticks that have been reached by it, in order."""
    offset, now, end = random.choice((0, -7, 1000)), 0, given.trace.end
    pending = list(portions(given, random))
    for number, (times, columns) in enumerate(pending):
        if len(times) == 1 and random.random() < 0.7:
            monitor.update(offset + int(times[0]), [float(column[0]) for column in columns])
        else:
            monitor.push(offset + times, columns)
        yield times.tolist()
        following = next((int(later[0]) for later, _ in pending[number + 1 :] if len(later)), end)
        if len(times):
            now = int(times[-1])
            if random.random() < 0.3:
                now = random.randint(now, following)
                monitor.advance(offset + now)
                yield [now]
    monitor.finish(offset + end)
    yield [end]


def _instant(given: MonitorInput, tick: int) -> Fraction:
    return Fraction(tick, given.trace.ticks_per_unit)
