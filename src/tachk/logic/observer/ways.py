"""The ways to reach a goal at one instant."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import product

from tachk.logic.observer.conditions import Conjunction, conjunction, is_false, negated, truth
from tachk.logic.observer.goals import (
    Before,
    Both,
    Differs,
    Either,
    Forever,
    Goal,
    Holds,
    NeverRising,
    NoObserver,
    Past,
    Preceded,
    Recurring,
    Saved,
    Sometime,
    Throughout,
    Was,
    both,
    saved_expressions,
)
from tachk.logic.observer.states import FRESH, Task
from tachk.operators import BinaryOperator
from tachk.syntax import ast

SavedNames = Mapping[ast.Expression, str]
"""A variable for each expression whose changes matter."""


@dataclass(frozen=True, slots=True)
class Branch:
    """One way to reach a goal at an instant: what holds there, what was before, what is to follow."""

    now: Conjunction = frozenset()
    pasts: frozenset[Past] = frozenset()
    tasks: frozenset[Task] = frozenset()
    forever: tuple[Forever, ...] = ()


def branches_of(goal: Goal, saved: SavedNames, at_start: bool = False) -> list[Branch]:
    """The ways to reach a goal at an instant, or when the run begins. Raises NoObserver if one never ends."""
    branches = []
    for branch in _expanded(goal, saved, at_start):
        if is_false(branch.now) or any(_excludes(branch, forever) for forever in branch.forever):
            continue
        if branch.forever:
            raise NoObserver(
                branch.forever[0].span,
                "only a run without end shows that this is violated: it sets no deadline",
                "give the operator a window, as in `F[0,10]`",
            )
        branches.append(branch)
    return branches


def _expanded(goal: Goal, saved: SavedNames, at_start: bool) -> list[Branch]:
    match goal:
        case Holds(condition=condition):
            return [Branch(conjunction((condition,)))]
        case Preceded(past=Saved(initially=initially)) if at_start:
            return [Branch()] if initially else []
        case Preceded(past=past):
            return [Branch(pasts=frozenset((past,)))]
        case Differs(equal=equal) if at_start:
            return [Branch()] if equal else []
        case Differs(expression=expression, equal=equal):
            return [Branch(frozenset((comparison(expression, equal, saved),)))]
        case Either(parts=parts):
            return [branch for part in parts for branch in _expanded(part, saved, at_start)]
        case Both(parts=parts):
            return [_joined(chosen) for chosen in product(*(_expanded(part, saved, at_start) for part in parts))]
        case Forever():
            return [Branch(forever=(goal,))]
        case Sometime(window=window):
            later = Branch(tasks=frozenset((Task(goal, "on", () if window.is_ever else (FRESH,)),)))
            if at_start and window.low == 0 and window.low_closed and saved_expressions(goal.goal):
                return [later, *_expanded(goal.goal, saved, at_start)]
            return [later]
        case Throughout(window=window) | Recurring(window=window):
            return [Branch(tasks=frozenset((Task(goal, "ahead" if window.low else "on", (FRESH,)),)))]
        case NeverRising(window=window, condition=condition, initially=initially):
            high = Branch(pasts=frozenset((Before(condition, initially),)) if window.low_closed else frozenset())
            return [
                Branch(tasks=frozenset((Task(goal, "low", (FRESH,)),))),
                replace(high, tasks=frozenset((Task(goal, "on", (FRESH,)),))),
            ]


def comparison(expression: ast.Expression, equal: bool, saved: SavedNames) -> ast.Expression:
    """Whether the expression has the value that was saved, or another one."""
    span = expression.span
    name = ast.NameExpression(span, saved[expression])
    return ast.BinaryExpression(span, BinaryOperator.EQUAL if equal else BinaryOperator.NOT_EQUAL, expression, name)


def looking_back(goal: Goal) -> Goal:
    """``F(p && F[0,b] g)`` says the same as ``F(g && O[0,b] p)``, whose observer has nothing to guess."""
    match goal:
        case Sometime(window=window, meanwhile=meanwhile, goal=Both(parts=(Holds(condition=condition), later))) if (
            window.is_ever
            and isinstance(later, Sometime)
            and later.window.low == 0
            and later.window.low_closed
            and later.meanwhile == meanwhile == truth(True, meanwhile.span)
        ):
            first = both((Holds(condition), later.goal))
            return replace(
                goal,
                goal=Either((first, Both((later.goal, Preceded(Was(meanwhile, condition, later.window.high)))))),
            )
        case _:
            return goal


def _joined(branches: Iterable[Branch]) -> Branch:
    parts = list(branches)
    return Branch(
        conjunction(part for branch in parts for part in branch.now),
        frozenset(past for branch in parts for past in branch.pasts),
        frozenset(task for branch in parts for task in branch.tasks),
        tuple(forever for branch in parts for forever in branch.forever),
    )


def _excludes(branch: Branch, forever: Forever) -> bool:
    """Whether something else in the branch is impossible if the condition holds for ever."""
    opposite = conjunction((negated(forever.condition),))
    awaited = [task.goal.goal for task in branch.tasks if isinstance(task.goal, Sometime)]
    return any(isinstance(goal, Holds) and opposite <= conjunction((goal.condition,)) for goal in awaited)
