"""Goals: the events that a run must show to violate a formula, in negation normal form.

A *goal* is something to be shown of one instant. Goals are positive combinations of conditions with operators that
speak of what comes later, and with *pasts*: what must have been seen right before the instant. Signals are constant
from an instant on for some time, so a condition that holds at an instant holds right after it as well; half of the
cases of open bounds vanish for that reason.
"""

from __future__ import annotations

from collections.abc import Iterator

from tachk.base.records import dataclass
from tachk.base.span import Span
from tachk.logic.observer.conditions import all_of, any_of
from tachk.syntax import ast


class NoObserver(Exception):
    """There is no observer for a formula.

    Attributes:
        span: the part of the formula that is to blame.
        reason: in plain words, a clause that says on its own why the formula is not checked.
        help: what can be done instead, or None.
    """

    def __init__(self, span: Span, reason: str, help: str | None = None) -> None:
        super().__init__(reason)
        self.span = span
        self.reason = reason
        self.help = help


@dataclass(frozen=True, slots=True)
class GoalWindow:
    """From ``low`` to ``high`` time units ahead; without an end where ``high`` is None."""

    low: int
    high: int | None
    low_closed: bool = True
    high_closed: bool = True

    @property
    def is_empty(self) -> bool:
        if self.high is None:
            return False
        return self.low > self.high or (self.low == self.high and not (self.low_closed and self.high_closed))

    @property
    def is_now(self) -> bool:
        return self.low == 0 == self.high and not self.is_empty

    @property
    def is_ever(self) -> bool:
        """True if every later instant is inside, the present one included."""
        return self.low == 0 and self.low_closed and self.high is None

    def then(self, other: GoalWindow) -> GoalWindow:
        """The window from which one reaches this one in steps of both."""
        high = None if self.high is None or other.high is None else self.high + other.high
        return GoalWindow(
            self.low + other.low,
            high,
            self.low_closed and other.low_closed,
            high is None or (self.high_closed and other.high_closed),
        )


# ---- the past right before an instant -------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class HeldBefore:
    """The condition held for some time right before. ``initially``: whether it counts as having held before the run."""

    condition: ast.Expression
    initially: bool


@dataclass(frozen=True, slots=True)
class HeldFor:
    """The condition held for the last ``length`` time units, or from the start of the run; always if None."""

    condition: ast.Expression
    length: int | None


@dataclass(frozen=True, slots=True)
class Was:
    """``there`` held for some time that ended less than ``length`` ago, and ``since`` from then on."""

    since: ast.Expression
    there: ast.Expression
    length: int | None


@dataclass(frozen=True, slots=True)
class Saved:
    """Right before, the expression had the value that was saved. ``initially`` as for `HeldBefore`."""

    expression: ast.Expression
    initially: bool


Past = HeldBefore | HeldFor | Was | Saved


# ---- goals ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Holds:
    condition: ast.Expression


@dataclass(frozen=True, slots=True)
class Preceded:
    past: Past


@dataclass(frozen=True, slots=True)
class Differs:
    """The expression has the value that was saved (``equal``), or another one."""

    expression: ast.Expression
    equal: bool


@dataclass(frozen=True, slots=True)
class Both:
    parts: tuple[Goal, ...]


@dataclass(frozen=True, slots=True)
class Either:
    parts: tuple[Goal, ...]


@dataclass(frozen=True, slots=True)
class Sometime:
    """At some instant of the window, and ``meanwhile`` from now to before it."""

    window: GoalWindow
    meanwhile: ast.Expression
    goal: Goal


@dataclass(frozen=True, slots=True)
class Throughout:
    """At every instant of the window.

    ``strict``, without an end of the window: in every state, too, in which no time passes. What is promised to come
    some time need not last.
    """

    window: GoalWindow
    condition: ast.Expression
    strict: bool = False


@dataclass(frozen=True, slots=True)
class Recurring:
    """At every instant of the window: ``condition``, or ``answer`` within ``length`` (``closed``: at its end, too)."""

    window: GoalWindow
    condition: ast.Expression
    answer: ast.Expression
    length: int
    closed: bool


@dataclass(frozen=True, slots=True)
class ResponseGoal:
    """At every instant from now on: ``condition``, or ``answer`` then or later."""

    condition: ast.Expression
    answer: ast.Expression


@dataclass(frozen=True, slots=True)
class GoalAlternative:
    """One way in which an instant can be as it should: what holds at it, and right before it."""

    condition: ast.Expression
    before: frozenset[HeldBefore]


@dataclass(frozen=True, slots=True)
class Everywhere:
    """Every instant of the window, whose lower bound is 0, is as in one of the ways ``allowed``; or else all instants
    of the window ``inner`` from it on, which begins at 0 too, are as in one of the ways ``inner_ways``.

    The instants of a window with an open lower bound are those after the present one.
    """

    window: GoalWindow
    allowed: tuple[GoalAlternative, ...]
    inner_ways: tuple[GoalAlternative, ...] = ()
    inner: GoalWindow | None = None


Goal = Holds | Preceded | Differs | Both | Either | Sometime | Throughout | Recurring | ResponseGoal | Everywhere


# ---- joining goals and looking into them ----------------------------------------------------------------------------


def both(parts: tuple[Goal, ...]) -> Goal:
    """All parts, the conditions among them joined."""
    conditions = [part.condition for part in parts if isinstance(part, Holds)]
    others = tuple(part for part in parts if not isinstance(part, Holds))
    if not others:
        return Holds(all_of(conditions, conditions[0].span))
    return Both((*((Holds(all_of(conditions, conditions[0].span)),) if conditions else ()), *others))


def either(parts: tuple[Goal, ...]) -> Goal:
    """One of the parts, the conditions among them joined."""
    conditions = [part.condition for part in parts if isinstance(part, Holds)]
    others = tuple(part for part in parts if not isinstance(part, Holds))
    if not others:
        return Holds(any_of(conditions, conditions[0].span))
    return Either((*((Holds(any_of(conditions, conditions[0].span)),) if conditions else ()), *others))


def parts_of(goal: Goal) -> Iterator[Goal]:
    """The goal and all goals inside."""
    pending = [goal]
    while pending:
        part = pending.pop()
        yield part
        match part:
            case Both(parts=parts) | Either(parts=parts):
                pending += parts
            case Sometime(goal=inner):
                pending.append(inner)
            case Holds() | Preceded() | Differs() | Throughout() | Recurring() | ResponseGoal() | Everywhere():
                pass


def saved_expressions(goal: Goal) -> tuple[ast.Expression, ...]:
    """The expressions whose changes the goal is about."""
    found: set[ast.Expression] = set()
    for part in parts_of(goal):
        match part:
            case Preceded(past=Saved(expression=expression)) | Differs(expression=expression):
                found.add(expression)
            case _:
                pass
    return tuple(sorted(found, key=repr))
