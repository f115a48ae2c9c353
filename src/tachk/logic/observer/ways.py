"""The ways to reach a goal at one instant."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import product
from math import prod

from tachk.base.operators import BinaryOperator
from tachk.logic.observer import everywhere
from tachk.logic.observer.conditions import Conjunction, conjunction, is_false, truth
from tachk.logic.observer.goals import (
    Both,
    Differs,
    Either,
    Everywhere,
    Goal,
    GoalAlternative,
    GoalWindow,
    Holds,
    Past,
    Preceded,
    Recurring,
    ResponseGoal,
    Saved,
    Sometime,
    Throughout,
    Was,
    both,
    parts_of,
    saved_expressions,
)
from tachk.logic.observer.states import FRESH, Item, TableauTask, lasts_for_ever
from tachk.syntax import ast

SavedNames = Mapping[ast.Expression, str]
"""A variable for each expression whose changes matter."""


@dataclass(frozen=True, slots=True)
class GoalBranch:
    """One way to reach a goal at an instant: what holds there, what was before, what is to follow."""

    now: Conjunction = frozenset()
    pasts: frozenset[Past] = frozenset()
    tasks: frozenset[TableauTask] = frozenset()


def branches_of(goal: Goal, saved: SavedNames, at_start: bool = False) -> list[GoalBranch]:
    """The ways to reach a goal at an instant, or when the run begins."""
    branches = [branch for branch in _expanded(goal, saved, at_start) if not is_false(branch.now)]
    return [branch for branch in branches if not _is_excluded(branch)]


def most_branches(goal: Goal) -> int:
    """The largest number of ways that are looked at to reach a goal, or one that is awaited in it, at an instant."""
    return max(
        _branches(part) for part in (goal, *(each.goal for each in parts_of(goal) if isinstance(each, Sometime)))
    )


def _branches(goal: Goal) -> int:
    match goal:
        case Either(parts=parts):
            return sum(map(_branches, parts))
        case Both(parts=parts):
            return prod(map(_branches, parts))
        case _:
            return 1


def pasts_wanted(items: Iterable[Item], saved: SavedNames) -> frozenset[Past]:
    """The pasts that some goal ahead asks for."""
    found: set[Past] = set()
    pending = [item for item in items if isinstance(item, TableauTask)]
    while pending:
        task = pending.pop()
        if isinstance(task.goal, Sometime):
            for branch in branches_of(task.goal.goal, saved):
                found |= branch.pasts
                pending += branch.tasks
    return frozenset(found)


def _expanded(goal: Goal, saved: SavedNames, at_start: bool) -> list[GoalBranch]:
    match goal:
        case Holds(condition=condition):
            return [GoalBranch(conjunction((condition,)))]
        case Preceded(past=Saved(initially=initially)) if at_start:
            return [GoalBranch()] if initially else []
        case Preceded(past=past):
            return [GoalBranch(pasts=frozenset((past,)))]
        case Differs(equal=equal) if at_start:
            return [GoalBranch()] if equal else []
        case Differs(expression=expression, equal=equal):
            return [GoalBranch(frozenset((comparison(expression, equal, saved),)))]
        case Either(parts=parts):
            return [branch for part in parts for branch in _expanded(part, saved, at_start)]
        case Both(parts=parts):
            return [_joined(chosen) for chosen in product(*(_expanded(part, saved, at_start) for part in parts))]
        case Sometime(window=window):
            later = GoalBranch(tasks=frozenset((TableauTask(goal, "on", () if window.is_ever else (FRESH,)),)))
            if at_start and window.low == 0 and window.low_closed and saved_expressions(goal.goal):
                return [later, *_expanded(goal.goal, saved, at_start)]
            return [later]
        case Throughout(window=window) | Recurring(window=window):
            clocks = () if window.high is None and window.low == 0 else (FRESH,)
            return [GoalBranch(tasks=frozenset((TableauTask(goal, "ahead" if window.low else "on", clocks),)))]
        case ResponseGoal(condition=condition):
            # The observer guesses whether an answer is awaited from the beginning on.
            phases = ("gap",) if is_false(conjunction((condition,))) else ("on", "gap")
            return [GoalBranch(tasks=frozenset((TableauTask(goal, phase),))) for phase in phases]
        case Everywhere():
            return [
                GoalBranch(one.now, frozenset(one.pasts), frozenset((one.task,))) for one in everywhere.beginnings(goal)
            ]


def comparison(expression: ast.Expression, equal: bool, saved: SavedNames) -> ast.Expression:
    """The condition that the expression has the value that was saved, or another one."""
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


def _joined(branches: Iterable[GoalBranch]) -> GoalBranch:
    parts = list(branches)
    return GoalBranch(
        conjunction(part for branch in parts for part in branch.now),
        frozenset(past for branch in parts for past in branch.pasts),
        frozenset(task for branch in parts for task in branch.tasks),
    )


def _is_excluded(branch: GoalBranch) -> bool:
    """True if something is awaited that is impossible because of what has to last for ever."""
    lasting = [task for task in branch.tasks if lasts_for_ever(task)]
    awaited = [task.goal.goal for task in branch.tasks if isinstance(task.goal, Sometime)]
    return any(_excludes(task, goal) for task in lasting for goal in awaited)


def _excludes(task: TableauTask, goal: Goal) -> bool:
    """True if the goal is never reached while the task lasts."""
    ways = everywhere.ways_of(goal)
    if ways is None:
        return False
    match task.goal:
        case Throughout(condition=condition):
            ways_held: tuple[GoalAlternative, ...] = (GoalAlternative(condition, frozenset()),)
        case Everywhere(window=GoalWindow(low_closed=True), allowed=ways_held, inner_ways=()):
            pass
        case _:
            return False
    return not any(everywhere.is_possible(everywhere.joined((one, other))) for one in ways for other in ways_held)
