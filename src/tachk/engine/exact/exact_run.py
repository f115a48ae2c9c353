"""Runs with exact times along long paths: the counterpart of `engine.exact.concretise` and `meaning.judge.replay`.

Making and judging them are two pieces of C++. They share with the search the compiled program and the machine that
evaluates expressions, and nothing else; each other they do not know.
"""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from fractions import Fraction

from tachk import _core
from tachk.base.records import dataclass
from tachk.engine.compiler.program import Goal, Program
from tachk.engine.program_image import encode


@dataclass(frozen=True, slots=True)
class Moments:
    """The moments of the transitions of a path.

    Attributes:
        ticks: of each transition, and of the end of the run, counted from its start.
        unit: the number of ticks of a unit of time.
    """

    ticks: tuple[int, ...]
    unit: int

    def __getitem__(self, number: int) -> Fraction:
        """The moment of a transition, in units of time."""
        return Fraction(self.ticks[number], self.unit)


def exact_run(program: Program, goal: Goal, actions: Sequence[Sequence[int]]) -> tuple[Moments | None, str]:
    """The earliest moments at which a path leads to a goal, if the judge accepts that run; else why there are none.

    There are none where clocks stop, where there are priorities, or where urgent channels are used. Receivers of
    broadcasts that would have to wait until they cannot receive make no run either, though there may be one.

    Args:
        actions: the numbers of the edges of each transition.
    """
    found = timed_path(program, goal, actions)
    return (None, found) if isinstance(found, str) else (found.moments, "")


@dataclass(frozen=True, slots=True)
class RunState:
    """Attributes:
    slots: those of the state.
    clocks: the ticks that each clock shows.
    """

    slots: tuple[int, ...]
    clocks: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class TimedPath:
    """A path with moments that the judge accepts."""

    path: _core.PathOfRun
    moments: Moments

    def state_after(self, transitions: int) -> RunState | None:
        """The state right after so many transitions; None where clocks stop."""
        found = self.path.state(self.moments.unit, array("q", self.moments.ticks), transitions)
        return None if found is None else RunState(tuple(found[0]), tuple(found[1]))


def timed_path(program: Program, goal: Goal, actions: Sequence[Sequence[int]]) -> TimedPath | str:
    """The path with the moments of `exact_run`, or why there are none."""
    path = _core.PathOfRun(encode(program, [goal]), actions)
    found = path.earliest()
    if found is None:
        return "no times were found"
    unit, ticks = found
    objection = path.objection(unit, array("q", ticks))
    if objection is not None:
        return f"step {objection[0]}: {objection[1]}"
    return TimedPath(path, Moments(tuple(ticks), unit))


def end_of_path(program: Program, actions: Sequence[Sequence[int]]) -> tuple[tuple[int, ...], tuple[int, ...]] | None:
    """The slots of the state in which a path ends, and the raw bounds of its clocks, row by row; none of them if clocks
    do not allow the path. None if the core cannot decide it."""
    found = _core.PathOfRun(encode(program, []), actions).end()
    return None if found is None else (tuple(found[0]), tuple(found[1]))
