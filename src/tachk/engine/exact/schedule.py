"""The schedules of a path: its clock constraints, and two ways to solve them.

A path of n transitions has phases 0 to n; phase k begins when transition k fires (phase 0 at time 0) and ends when the
next one does. A `ScheduleRequirement` says what must hold at the beginning or the end of a phase, as a choice between
conjunctions of clock constraints.

`earliest` treats the moments of the transitions as unknowns. As long as all clocks run, every clock constraint is a
bound on the difference of two moments, and the least solution is found by relaxation (Bellman and Ford) over pairs of
an integer and a number of infinitesimals, one for each strict bound on the way. `any_solution` is a linear problem
for z3, for clocks that stop.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any

from tachk.base.optional_packages import optional_packages
from tachk.base.records import dataclass, field
from tachk.engine.solver_context import release_from_any_thread
from tachk.meaning.dbm import INFINITY, LESS_EQUAL_ZERO, Constraint, bound_value, is_strict

INFINITESIMAL_BITS = 40
"""A moment is an integer: time units shifted by this, plus the number of infinitesimals."""


RETRIES = 2000
"""The number of choices that are taken back before z3 solves the problem."""


@dataclass(frozen=True, slots=True)
class PhaseConstraint:
    """A clock constraint at the beginning or the end of a phase."""

    at_end: bool
    constraint: Constraint


@dataclass(frozen=True, slots=True)
class ScheduleRequirement:
    """Conjunctions of clock constraints in a phase, one of which must hold."""

    phase: int
    conjunctions: Sequence[Sequence[PhaseConstraint]]


@dataclass(frozen=True, slots=True)
class Standstill:
    """A phase that added nothing to the value of a clock, and the one before it, if there is one."""

    phase: int
    before: Standstill | None


@dataclass(frozen=True, slots=True)
class SchedulePhase:
    """Attributes:
    resets: for each clock (entry 0 is unused) the phase at whose beginning it was set last, and the value it got. A
        clock that was set to another one was set when that one was.
    stopped: the clocks that stand still in this phase.
    stood: for clocks that stood still since they were set, the last phase before this one in which they did. A clock
        that was set to another one stood still when that one did.
    """

    resets: tuple[tuple[int, int], ...]
    stopped: frozenset[int]
    stood: Mapping[int, Standstill] = field(default_factory=dict)

    def standstills(self, clock: int) -> Iterator[int]:
        """The phases since the clock was set, before this one, that added nothing to its value; the last one first."""
        last = self.stood.get(clock)
        while last is not None:
            yield last.phase
            last = last.before


@dataclass(slots=True)
class _LeastMoments:
    """The least moments that satisfy a growing set of difference constraints, with undo.

    Moment k is the beginning of phase k; moment 0 is fixed at 0. A constraint ``t_a - t_b < c`` is kept as a lower
    bound on ``t_b``: an arc from a to b with the weight ``-c`` plus an infinitesimal.
    """

    least: list[int]
    arcs: list[list[tuple[int, int]]]
    undo: list[tuple[int, int]] = field(default_factory=list)
    """(moment, its value before) for raised moments; (-1 - a, 0) for an arc added at a."""

    def require(self, a: int, b: int, raw: int) -> bool:
        """Adds ``t_a - t_b`` bounded by ``raw``; False if that contradicts what is there."""
        if raw >= INFINITY:
            return True
        if a == b:
            return raw >= LESS_EQUAL_ZERO
        weight = (-bound_value(raw) << INFINITESIMAL_BITS) + is_strict(raw)
        self.arcs[a].append((b, weight))
        self.undo.append((-1 - a, 0))
        if self.least[a] + weight <= self.least[b]:
            return True
        self._raise(b, self.least[a] + weight)
        changed = deque([b])
        while changed:
            node = changed.popleft()
            if node in (0, a):
                return False  # the start cannot move; a new arc that raises its own source closes a cycle
            value = self.least[node]
            for target, step in self.arcs[node]:
                if value + step > self.least[target]:
                    self._raise(target, value + step)
                    changed.append(target)
        return True

    def _raise(self, moment: int, value: int) -> None:
        self.undo.append((moment, self.least[moment]))
        self.least[moment] = value

    def back_to(self, mark: int) -> None:
        while len(self.undo) > mark:
            place, value = self.undo.pop()
            if place < 0:
                self.arcs[-1 - place].pop()
            else:
                self.least[place] = value


def earliest(phases: Sequence[SchedulePhase], requirements: Sequence[ScheduleRequirement]) -> list[Fraction] | None:
    """The durations of the phases of an early run; None if there is no run.

    Takes for each requirement the first conjunction with which a solution is left, and then the least moments. Where
    choices have to be taken back too often, z3 finds some run instead.
    """
    moments = _LeastMoments([0] * (len(phases) + 1), [[] for _ in range(len(phases) + 1)])
    choices: list[tuple[int, int, int]] = []  # requirement, next conjunction to try, length of the undo list before
    number, alternative, taken_back = 0, 0, 0
    while number < len(requirements):
        mark = len(moments.undo)
        phase, options = requirements[number].phase, requirements[number].conjunctions
        while alternative < len(options):
            if all(moments.require(*_difference(phases, phase, moment)) for moment in options[alternative]):
                break
            moments.back_to(mark)
            alternative += 1
        if alternative < len(options):
            if alternative + 1 < len(options):
                choices.append((number, alternative + 1, mark))
            number, alternative = number + 1, 0
        elif choices:
            if taken_back == RETRIES:
                return any_solution(phases, requirements)
            taken_back += 1
            number, alternative, mark = choices.pop()
            moments.back_to(mark)
        else:
            return None
    return _durations(moments.least)


def _difference(phases: Sequence[SchedulePhase], phase: int, moment: PhaseConstraint) -> Constraint:
    """A clock constraint as a bound on the difference of two moments."""
    now = phase + moment.at_end
    i, j, raw = moment.constraint
    resets = phases[phase].resets
    # A clock is `now - (phase of its reset) + value`; without a clock there is `now - now + 0`.
    from_i, value_i = resets[i] if i else (now, 0)
    from_j, value_j = resets[j] if j else (now, 0)
    return from_j, from_i, raw if raw >= INFINITY else raw - 2 * (value_i - value_j)


def _durations(least: Sequence[int]) -> list[Fraction]:
    """Replaces infinitesimals by a number so small that no two different integers plus infinitesimals swap places."""
    mask = (1 << INFINITESIMAL_BITS) - 1
    small = Fraction(1, 1 + max(moment & mask for moment in least))
    times = [(moment >> INFINITESIMAL_BITS) + (moment & mask) * small for moment in least]
    return [after - before for before, after in pairwise(times)]


def any_solution(phases: Sequence[SchedulePhase], requirements: Sequence[ScheduleRequirement]) -> list[Fraction] | None:
    """The durations of the phases of some run, where clocks may stop; None if there is no run."""
    with optional_packages():
        import z3

    durations, formulas = _linear_problem(phases, requirements)
    solver = z3.Solver()
    solver.add(*formulas)
    if solver.check() != z3.sat:
        return None
    return _values(solver.model(), durations)


@dataclass(frozen=True, slots=True)
class ExtremeTime:
    """The least or the largest time that some phases take together, and a run that is at it or close to it.

    Attributes:
        total: the limit; None where there is none.
        attained: the run takes exactly so long; otherwise runs come as close to it as one likes.
    """

    durations: list[Fraction]
    total: Fraction | None
    attained: bool


def extreme_solution(
    phases: Sequence[SchedulePhase],
    requirements: Sequence[ScheduleRequirement],
    latest: bool,
    milliseconds: int | None = None,
) -> ExtremeTime | None:
    """A run whose last transition is as late as possible, or a run that ends as early as possible.

    The late one ends as early as it can behind its last transition. None if there is no run.

    Raises TimeoutError if z3 has not found it in so many milliseconds.
    """
    with optional_packages():
        import z3

    durations, formulas = _linear_problem(phases, requirements)
    time = z3.Sum(durations[:-1] if latest else durations) if durations[latest:] else z3.RealVal(0)
    total, attained = _limit(formulas, time, latest, milliseconds)
    if total is None or attained:
        close = z3.BoolVal(True) if total is None else time == z3.Q(total.numerator, total.denominator)
    else:
        limit = total - _TOLERANCE if latest else total + _TOLERANCE
        bound = z3.Q(limit.numerator, limit.denominator)
        close = time >= bound if latest else time <= bound
    # Without a limit on the time, or close to it, the run that ends first is as good as any.
    end, at_end = _limit([*formulas, close], z3.Sum(durations), False, milliseconds)
    if end is None:
        return None
    last = z3.Q(end.numerator, end.denominator)
    half = z3.Q(_TOLERANCE.numerator, _TOLERANCE.denominator)
    solver = z3.Solver()
    solver.add(*formulas, close, z3.Sum(durations) == last if at_end else z3.Sum(durations) <= last + half)
    if solver.check() != z3.sat:
        return None
    return ExtremeTime(_values(solver.model(), durations), total, attained)


_TOLERANCE = Fraction(1, 2)
"""So close a run comes to a limit that no run is at."""


def _limit(formulas: Sequence[Any], time: Any, largest: bool, milliseconds: int | None) -> tuple[Fraction | None, bool]:
    """The least or the largest value of a sum, and whether it is taken; None where there is no limit or no value."""
    with optional_packages():
        import z3

    optimiser = z3.Optimize()
    if milliseconds is not None:
        optimiser.set("timeout", max(milliseconds, 1))
    optimiser.add(*formulas)
    objective = optimiser.maximize(time) if largest else optimiser.minimize(time)
    found = optimiser.check()
    if found == z3.unknown:
        raise TimeoutError
    if found == z3.unsat:
        return None, False
    infinite, value, infinitesimal = objective.upper_values() if largest else objective.lower_values()
    if not z3.is_true(z3.simplify(infinite == 0)):
        return None, False
    return _fraction(value), z3.is_true(z3.simplify(infinitesimal == 0))


def _linear_problem(
    phases: Sequence[SchedulePhase], requirements: Sequence[ScheduleRequirement]
) -> tuple[list[Any], list[Any]]:
    """The durations of the phases as unknowns of z3, and what they must satisfy."""
    with optional_packages():
        import z3

    release_from_any_thread()
    durations = [z3.Real(f"d{k}") for k in range(len(phases))]

    def clock(number: int, phase: int, at_end: bool) -> z3.ArithRef:
        if number == 0:
            return z3.RealVal(0)
        since, value = phases[phase].resets[number]
        stood = standstills(phases, number, phase, at_end)
        passed = [durations[k] for k in range(since, phase + at_end) if k not in stood]
        return z3.Sum([z3.RealVal(value), *passed])

    choices = [formula_of(requirement, clock) for requirement in requirements]
    return durations, [*(d >= 0 for d in durations), *choices]


def formula_of(requirement: ScheduleRequirement, clock: Callable[[int, int, bool], Any], unit: int = 1) -> Any:
    """A requirement as a formula of z3.

    Args:
        clock: the value of a clock at the beginning or the end of a phase.
        unit: the number of units of these values that are one of the network's.
    """
    with optional_packages():
        import z3

    def formula(moment: PhaseConstraint) -> z3.BoolRef:
        i, j, raw = moment.constraint
        if raw >= INFINITY:
            return z3.BoolVal(True)
        difference = clock(i, requirement.phase, moment.at_end) - clock(j, requirement.phase, moment.at_end)
        bound = bound_value(raw) * unit
        return difference < bound if is_strict(raw) else difference <= bound

    return z3.Or([z3.And([formula(m) for m in conjunction]) for conjunction in requirement.conjunctions])


def standstills(phases: Sequence[SchedulePhase], clock: int, phase: int, at_end: bool) -> set[int]:
    """The phases that added nothing to the value of a clock since it was set."""
    here = phases[phase]
    found = set(here.standstills(clock))
    if at_end and clock in here.stopped:
        found.add(phase)
    return found


def _values(model: Any, durations: Sequence[Any]) -> list[Fraction]:
    return [_fraction(model.eval(d, model_completion=True)) for d in durations]


def _fraction(value: Any) -> Fraction:
    return Fraction(value.as_string())
