"""The moments of a run whose last part can be repeated for ever with the same delays, as a problem for z3.

Every clock constraint is a bound on the difference of two moments; that a clock has the same value before and after the
last part relates four. Where there is a solution, one in multiples of one half is preferred, which is easy to read.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from importlib.util import find_spec
from itertools import pairwise
from typing import TYPE_CHECKING

from tachk.engine.exact.schedule import SchedulePhase, ScheduleRequirement, formula_of, standstills
from tachk.engine.solver_context import release_from_any_thread
from tachk.meaning.repetition import ObservableClocks

if TYPE_CHECKING:
    import z3

MILLISECONDS = 2000
"""The time limit of z3 for one question."""


def repeating(
    phases: Sequence[SchedulePhase],
    requirements: Sequence[ScheduleRequirement],
    start: int,
    observable_clocks: ObservableClocks,
    takes_time: bool,
) -> list[Fraction] | None:
    """The durations of the phases of a run that can go on from the beginning of the last phase as it went on from that
    of phase ``start``; None if none was found, and where z3 is not installed.

    Args:
        takes_time: at least one time unit passes between the two.
    """
    if find_spec("z3") is None:
        return None
    found = _solve(phases, requirements, start, observable_clocks, takes_time, whole=False)
    if found is None:
        return None
    return _solve(phases, requirements, start, observable_clocks, takes_time, whole=True) or found


def _solve(
    phases: Sequence[SchedulePhase],
    requirements: Sequence[ScheduleRequirement],
    start: int,
    observable_clocks: ObservableClocks,
    takes_time: bool,
    whole: bool,
) -> list[Fraction] | None:
    import z3

    release_from_any_thread()
    unit = 2 if whole else 1
    make = z3.Int if whole else z3.Real
    moments: list[z3.ArithRef] = [make(f"t{k}") for k in range(len(phases) + 1)]
    solver = z3.SolverFor("QF_LIA" if whole else "QF_LRA")
    solver.set("timeout", MILLISECONDS)
    solver.add(moments[0] == 0, *(a <= b for a, b in pairwise(moments)))

    def value(clock: int, phase: int, at_end: bool) -> z3.ArithRef:
        if clock == 0:
            return z3.IntVal(0) if whole else z3.RealVal(0)
        since, start_value = phases[phase].resets[clock]
        passed = moments[phase + at_end] - moments[since]
        for k in standstills(phases, clock, phase, at_end):
            passed -= moments[k + 1] - moments[k]
        return passed + start_value * unit

    solver.add(*(formula_of(requirement, value, unit) for requirement in requirements))
    last = len(phases) - 1
    if takes_time:
        solver.add(moments[last] - moments[start] >= unit)
    for clock in range(1, len(phases[0].resets) - 1):
        if clock not in observable_clocks.related and clock not in observable_clocks.largest:
            continue
        before, after = (value(clock, phase, False) for phase in (start, last))
        beyond = observable_clocks.largest.get(clock, 0) * unit
        free = [] if clock in observable_clocks.related else [z3.And(before > beyond, after > beyond)]
        solver.add(z3.Or([before == after, *free]))
    if solver.check() != z3.sat:
        return None
    times = _early(solver, moments[-1], moments, unit)
    return [after - before for before, after in pairwise(times)]


def _early(solver: z3.Solver, end: z3.ArithRef, moments: Sequence[z3.ArithRef], unit: int) -> list[Fraction]:
    """A solution that ends early, as far as a few more questions show."""
    import z3

    def solution() -> list[Fraction]:
        model = solver.model()
        values = [model.eval(moment, model_completion=True) for moment in moments]
        if unit > 1:
            return [Fraction(value.as_long(), unit) for value in values]
        return [Fraction(value.numerator_as_long(), value.denominator_as_long()) for value in values]

    best = solution()
    low = Fraction(0)
    for _ in range(8):
        middle = (low + best[-1]) / 2
        if best[-1] - low < 1:
            break
        solver.push()
        solver.add(end <= (int(middle * unit) if unit > 1 else z3.Q(middle.numerator, middle.denominator)))
        if solver.check() == z3.sat:
            best = solution()
        else:
            low = middle
        solver.pop()
    return best
