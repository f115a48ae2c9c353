"""All violations that the monitors find, against the oracle: what is asked for where, by the definition of G."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from random import Random

from tachk.recordings.monitors.trace_semantics import HeldValues
from tachk.recordings.traces.violation_watch import ViolationWatch
from tachk.recordings.traces.violations import TriggerCounts, violations_of
from tachk.syntax import formula as syntax
from tests.support.exact_monitor import Window, satisfaction
from tests.support.formulas import MonitoringCase
from tests.support.monitor_input import MonitorInput, monitor_input, portions

Stretch = tuple[int, int]


def violation_problems(case: MonitoringCase, refinement: int = 1) -> tuple[str, ...]:
    """Where the violations and the counts of triggers differ from those of the oracle."""
    given = monitor_input(case, refinement)
    found = violations_of(HeldValues().explainer(given.program, given.trace))
    stretches: list[Stretch] = []
    counts: list[TriggerCounts] = []
    joined = False
    for formula, cells in asked(case.formula, frozenset((0,)), given):
        exact = satisfaction(formula, case.trace)
        truth = {cell: exact.value(given.instant(cell)).truth for cell in cells}
        false = runs({cell for cell in cells if truth[cell] is False})
        stretches += false
        joined = joined or isinstance(formula, syntax.Or)  # `a != b || c` of conditions has a trigger for monitors
        if (trigger := trigger_of(formula)) is not None:
            asking = satisfaction(trigger, case.trace)
            triggers = runs({cell for cell in cells if asking.value(given.instant(cell)).truth is True})
            seen = [{truth[cell] for cell in range(first, last + 1)} for first, last in triggers]
            violated = sum(False in each for each in seen)
            counts.append(TriggerCounts(len(triggers), violated, sum(None in e and False not in e for e in seen)))
    problems = []
    if (each := [(finding.cell, finding.last) for finding in found]) != sorted(stretches, key=lambda each: each[0]):
        problems.append(f"violations {each}, not {stretches}")
    expected = sum(counts, TriggerCounts(0, 0, 0)) if counts else None
    if found.triggers != expected and not joined:
        problems.append(f"triggers {found.triggers}, not {expected}")
    return tuple(problems)


def online_violation_problems(case: MonitoringCase, refinement: int, seed: int) -> tuple[str, ...]:
    """Where the violations that are told while the trace comes in portions differ from those of the whole trace, or
    one is told that does not begin there."""
    given = monitor_input(case, refinement)
    whole = [
        (finding.formula, finding.cell, finding.last + 1)
        for finding in violations_of(HeldValues().explainer(given.program, given.trace))
    ]
    watch = ViolationWatch(
        [given.program],
        given.program.columns,
        decimals=0,
        parts=given.trace.ticks_per_unit,
        exact=lambda time: int(time * given.trace.ticks_per_unit),
    )
    begun: list[tuple[str, int]] = []
    ended: list[tuple[str, int, int]] = []

    def take() -> None:
        for change in watch.take():
            if change.end is None:
                begun.append((change.part, change.first))
            else:
                ended.append((change.part, change.first, change.end))

    for times, columns in portions(given, Random(seed)):
        watch.push(times, dict(zip(given.program.columns, columns, strict=True)), 1)
        take()
    watch.finish(Fraction(given.trace.end, given.trace.ticks_per_unit) if seed % 2 else None)
    take()
    if seed % 2 == 0 and given.trace.end != int(given.trace.times[-1]):
        return ()
    problems = []
    if sorted(ended) != sorted(whole):
        problems.append(f"online {ended}, not {whole}")
    if sorted(begun) != sorted((text, first) for text, first, _ in whole):
        problems.append(f"begun {begun}, not {whole}")
    return tuple(problems)


def asked(
    formula: syntax.Formula, cells: frozenset[int], given: MonitorInput
) -> Iterator[tuple[syntax.Formula, frozenset[int]]]:
    """What has to be true in which cells of the trace, so that a formula is true in some."""
    match formula:
        case syntax.And(operands=operands):
            for operand in operands:
                yield from asked(operand, cells, given)
        case syntax.Always(interval=interval, operand=operand):
            point = interval.upper is not None and interval.upper.value == interval.lower.value
            if point and not (interval.lower_closed and interval.upper_closed):
                yield formula, cells  # nothing is asked for
                return
            windows = [_window(interval, given.instant(cell)) for cell in cells]
            inside = frozenset(
                cell for cell in range(2 * given.trace.end + 1) if any(_meets(w, cell, given) for w in windows)
            )
            yield from asked(operand, inside, given)
        case _:
            yield formula, cells


def trigger_of(formula: syntax.Formula) -> syntax.Formula | None:
    match formula:
        case syntax.Implies(left=left):
            return left
        case _:
            return None


def runs(cells: set[int]) -> list[Stretch]:
    """The longest stretches of cells."""
    found: list[Stretch] = []
    for cell in sorted(cells):
        if found and found[-1][1] == cell - 1:
            found[-1] = (found[-1][0], cell)
        else:
            found.append((cell, cell))
    return found


def _window(interval: syntax.Interval, instant: Fraction) -> Window:
    lower, upper = interval.lower.value, None if interval.upper is None else interval.upper.value
    if not isinstance(lower, Fraction) or not (upper is None or isinstance(upper, Fraction)):
        raise TypeError("durations have to be numbers")
    end = None if upper is None else instant + upper
    return Window(instant + lower, interval.lower_closed, end, interval.upper_closed)


def _meets(window: Window, cell: int, given: MonitorInput) -> bool:
    """Whether a window has an instant of a cell: of a point, or of the open interval between two."""
    if cell % 2:
        first, last = given.instant(cell - 1), given.instant(cell + 1)
        if window.upper is None:
            return window.lower < last
        low, high = max(first, window.lower), min(last, window.upper)
        point = low == high and window.lower_closed and window.upper_closed and first < low < last
        return low < high or point
    at = given.instant(cell)
    above = at > window.lower or (at == window.lower and window.lower_closed)
    return above and (window.upper is None or at < window.upper or (at == window.upper and window.upper_closed))
