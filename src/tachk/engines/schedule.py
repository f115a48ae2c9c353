"""When the transitions of a path can fire: its clock constraints, and two ways to solve them.

A path of n transitions has phases 0 to n; phase k begins when transition k fires (phase 0 at time 0) and ends when the
next one does. A `Requirement` says what must hold at the beginning or the end of phases, as a choice between
conjunctions of clock constraints.

`earliest` treats the moments of the transitions as unknowns. As long as all clocks run, every clock constraint is a
bound on the difference of two moments, and the least solution is found by relaxation (Bellman and Ford) over pairs of
an integer and a number of infinitesimals, one for each strict bound on the way. `any_solution` is a linear problem
for z3, for clocks that stop.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import field
from fractions import Fraction
from itertools import pairwise

from tachk.records import dataclass
from tachk.semantics.dbm import INFINITY, LESS_EQUAL_ZERO, Constraint, bound_value, is_strict

INFINITESIMAL_BITS = 40
"""A moment is an integer: time units shifted by this, plus the number of infinitesimals."""


RETRIES = 2000
"""Choices taken back before z3 is asked."""


@dataclass(frozen=True, slots=True)
class Moment:
    """A clock constraint at the beginning or the end of a phase."""

    phase: int
    at_end: bool
    constraint: Constraint


Requirement = list[tuple[Moment, ...]]
"""One of the conjunctions must hold."""


@dataclass(frozen=True, slots=True)
class Phase:
    """Attributes:
    resets: for each clock (entry 0 is unused) the phase at whose beginning it was set last, and the value it got.
    stopped: the clocks that stand still in this phase.
    """

    resets: tuple[tuple[int, int], ...]
    stopped: frozenset[int]


@dataclass(slots=True)
class _Moments:
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


def earliest(phases: Sequence[Phase], requirements: Sequence[Requirement]) -> list[Fraction] | None:
    """The durations of the phases of an early run; None if there is no run.

    Takes for each requirement the first conjunction with which a solution is left, and then the least moments. Where
    choices have to be taken back too often, z3 finds some run instead.
    """
    moments = _Moments([0] * (len(phases) + 1), [[] for _ in range(len(phases) + 1)])
    choices: list[tuple[int, int, int]] = []  # requirement, next conjunction to try, length of the undo list before
    number, alternative, taken_back = 0, 0, 0
    while number < len(requirements):
        mark = len(moments.undo)
        options = requirements[number]
        while alternative < len(options):
            if all(moments.require(*_difference(phases, moment)) for moment in options[alternative]):
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


def _difference(phases: Sequence[Phase], moment: Moment) -> Constraint:
    """A clock constraint as a bound on the difference of two moments."""
    now = moment.phase + moment.at_end
    i, j, raw = moment.constraint
    resets = phases[moment.phase].resets
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


def any_solution(phases: Sequence[Phase], requirements: Sequence[Requirement]) -> list[Fraction] | None:
    """The durations of the phases of some run, where clocks may stop; None if there is no run."""
    import z3

    durations = [z3.Real(f"d{k}") for k in range(len(phases))]
    solver = z3.Solver()
    solver.add(*(d >= 0 for d in durations))

    def clock(number: int, moment: Moment) -> z3.ArithRef:
        if number == 0:
            return z3.RealVal(0)
        since, value = phases[moment.phase].resets[number]
        passed = [durations[k] for k in range(since, moment.phase + moment.at_end) if number not in phases[k].stopped]
        return z3.Sum([z3.RealVal(value), *passed])

    def formula(moment: Moment) -> z3.BoolRef:
        i, j, raw = moment.constraint
        if raw >= INFINITY:
            return z3.BoolVal(True)
        difference = clock(i, moment) - clock(j, moment)
        return difference < bound_value(raw) if is_strict(raw) else difference <= bound_value(raw)

    for requirement in requirements:
        solver.add(z3.Or([z3.And([formula(m) for m in conjunction]) for conjunction in requirement]))
    if solver.check() != z3.sat:
        return None
    model = solver.model()
    values = [model.eval(d, model_completion=True) for d in durations]
    return [Fraction(v.numerator_as_long(), v.denominator_as_long()) for v in values]
