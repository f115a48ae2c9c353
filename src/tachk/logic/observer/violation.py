"""From formulas to the goals of a run that violates them.

Sources: the expansion of timed until of Alur, Feder and Henzinger (1996); the past as deterministic phases of Maler,
Nickovic and Pnueli (2005).
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

from tachk.base.records import replace
from tachk.base.span import Span
from tachk.logic.observer.conditions import all_of, any_of, negated, truth
from tachk.logic.observer.everywhere import is_possible, ways_of
from tachk.logic.observer.goals import (
    Both,
    Differs,
    Either,
    Everywhere,
    Goal,
    GoalAlternative,
    GoalWindow,
    HeldBefore,
    HeldFor,
    Holds,
    NoObserver,
    Preceded,
    Recurring,
    ResponseGoal,
    Saved,
    Sometime,
    Throughout,
    Was,
    both,
    either,
)
from tachk.syntax import ast, formula
from tachk.syntax.chains import LONGEST_FROM_LEFT
from tachk.syntax.formula import Formula
from tachk.syntax.formulas.printer import print_number

LARGEST = 2**31 - 2
"""The largest duration, in time units; one less than the largest constant that clocks are compared with."""


def violation(node: Formula) -> Goal:
    """The condition of an instant at which the formula is false. Raises NoObserver."""
    return _goal(node, False)


def condition_of(node: Formula) -> ast.Expression | None:
    """The formula as a condition on one state, if it is one."""
    span = node.span
    match node:
        case formula.TruthConstant(value=value):
            return truth(value, span)
        case formula.Atom(expression=expression):
            return expression
        case formula.Not(operand=operand):
            inner = condition_of(operand)
            return None if inner is None else negated(inner)
        case formula.And(operands=operands) | formula.Or(operands=operands):
            parts = [condition_of(part) for part in operands]
            if any(part is None for part in parts):
                return None
            join = all_of if isinstance(node, formula.And) else any_of
            return join([part for part in parts if part is not None], span)
        case formula.Implies(left=left, right=right):
            return condition_of(formula.Or(span, (formula.Not(left.span, left), right)))
        case formula.Rise(operand=operand) | formula.Fall(operand=operand):
            inner = condition_of(operand)
            never = isinstance(inner, ast.BooleanLiteral) and not (isinstance(node, formula.Rise) and inner.value)
            return truth(False, span) if never else None
        case (
            formula.Change()
            | formula.Eventually()
            | formula.Always()
            | formula.Once()
            | formula.Historically()
            | formula.Until()
            | formula.WeakUntil()
            | formula.Since()
        ):
            return None


def _goal(node: Formula, positive: bool) -> Goal:
    condition = condition_of(node)
    if condition is not None:
        return Holds(condition if positive else negated(condition))
    match node:
        case formula.Not(operand=operand):
            return _goal(operand, not positive)
        case formula.And(operands=operands) if not positive and len(operands) > LONGEST_FROM_LEFT:
            return either(tuple(_goal(part, False) for part in _together(operands)))
        case formula.And(operands=operands):
            return (both if positive else either)(tuple(_goal(part, positive) for part in operands))
        case formula.Or(operands=operands):
            return (either if positive else both)(tuple(_goal(part, positive) for part in operands))
        case formula.Implies(left=left, right=right):
            return (either if positive else both)((_goal(left, not positive), _goal(right, positive)))
        case formula.Eventually(interval=interval, operand=operand):
            return _ahead(node, interval, operand, positive, sometime=positive)
        case formula.Always(interval=interval, operand=operand):
            return _ahead(node, interval, operand, positive, sometime=not positive)
        case formula.Until(interval=interval, left=left, right=right):
            window = window_of(interval)
            return _until(window, left, right) if positive else _not_until(node, window, left, right)
        case formula.WeakUntil(left=left, right=right):
            ever = GoalWindow(0, None)
            if positive:
                return either((_until(ever, left, right), _always(node, ever, Holds(_condition(left)))))
            return _without(node, ever, right, both((_goal(left, False), _goal(right, False))))
        case formula.Rise(operand=operand):
            return _edge(_condition(operand), True, positive)
        case formula.Fall(operand=operand):
            return _edge(_condition(operand), False, positive)
        case formula.Change(expression=expression):
            return Both((Preceded(Saved(expression, not positive)), Differs(expression, equal=not positive)))
        case formula.Once(interval=interval, operand=operand):
            return _past_window(interval, _condition(operand), positive, once=positive)
        case formula.Historically(interval=interval, operand=operand):
            return _past_window(interval, _condition(operand), positive, once=not positive)
        case formula.Since(interval=interval, left=left, right=right):
            return _since(interval, _condition(left), _condition(right), positive)
        case _:
            raise AssertionError(node)


def _together(operands: Iterable[Formula]) -> list[Formula]:
    """The operands of a conjunction, with ``G (p && q)`` in place of ``G p`` and ``G q``."""
    inside: dict[formula.Interval, list[Formula]] = {}
    others: list[Formula] = []
    for part in operands:
        if isinstance(part, formula.Always):
            inside.setdefault(part.interval, []).append(part.operand)
        else:
            others.append(part)
    whole = [
        formula.Always(
            parts[0].span, interval, parts[0] if len(parts) == 1 else formula.And(parts[0].span, tuple(parts))
        )
        for interval, parts in inside.items()
    ]
    return [*whole, *others]


def window_of(interval: formula.Interval) -> GoalWindow:
    """The bounds as whole time units. Raises NoObserver for others."""
    high = None if interval.upper is None else _units(interval.upper)
    return GoalWindow(_units(interval.lower), high, interval.lower_closed, interval.upper_closed)


def _units(duration: formula.Duration) -> int:
    value = duration.value
    if not isinstance(value, Fraction):
        raise TypeError("durations have to be numbers")
    if value.denominator != 1:
        raise NoObserver(
            duration.span,
            f"the bound is {print_number(value)} time units, and clocks are compared with whole numbers",
            "choose a smaller `time_unit` for the model",
        )
    if value > LARGEST:
        raise NoObserver(duration.span, f"clocks are compared with at most {LARGEST} time units")
    return int(value)


def _condition(node: Formula) -> ast.Expression:
    found = condition_of(node)
    if found is None:
        raise NoObserver(
            node.span,
            "a temporal formula cannot stand here: in this place an observer needs a condition on one state",
            "split the requirement, or name a state of the model that stands for this part",
        )
    return found


def _neither(one: ast.Expression, other: ast.Expression) -> ast.Expression:
    return all_of((negated(one), negated(other)), one.span)


# ---- ahead ----------------------------------------------------------------------------------------------------------


def _ahead(
    node: formula.Eventually | formula.Always,
    interval: formula.Interval,
    operand: Formula,
    positive: bool,
    sometime: bool,
) -> Goal:
    window = window_of(interval)
    if window.is_empty:
        return Holds(truth(not sometime, node.span))
    goal = _goal(operand, positive)
    if window.is_now:
        return goal
    return _sometime(window, truth(True, node.span), goal) if sometime else _always(node, window, goal)


def _sometime(window: GoalWindow, meanwhile: ast.Expression, goal: Goal) -> Goal:
    free = truth(True, meanwhile.span)
    match goal:
        case Sometime(window=inner, meanwhile=before, goal=last) if meanwhile == free and before == free:
            return Sometime(window.then(inner), meanwhile, last)
        case _:
            return Sometime(window, meanwhile, goal)


def _until(window: GoalWindow, left: Formula, right: Formula) -> Goal:
    if window.is_empty:
        return Holds(truth(False, right.span))
    if window.is_now:
        return _goal(right, True)
    return _sometime(window, _condition(left), _goal(right, True))


def _not_until(node: Formula, window: GoalWindow, left: Formula, right: Formula) -> Goal:
    """The goal that every instant of the window without ``left`` before it lacks ``right``: until ``left`` fails or the
    window is over, ``right`` is false."""
    if window.is_empty:
        return Holds(truth(True, right.span))
    if window.is_now:
        return _goal(right, False)
    failing, absent = _goal(left, False), _goal(right, False)
    if window.low > 0 or not window.low_closed:
        if not window.low_closed:
            raise NoObserver(
                right.span,
                "tachk has no observer for an until with an open lower bound on the side that must not be reached",
                "close the bound",
            )
        rest = GoalWindow(0, None if window.high is None else window.high - window.low, True, window.high_closed)
        free = truth(True, right.span)
        found: list[Goal] = [
            _sometime(GoalWindow(0, window.low, True, False), free, failing),
            _always(node, window, absent),
        ]
        if not _is_impossible(both((failing, absent))):
            later = both((failing, absent)) if rest.is_now else _without(node, rest, right, both((failing, absent)))
            found.append(_sometime(GoalWindow(window.low, window.low), free, later))
        return either(tuple(found))
    return either((_always(node, window, absent), _without(node, window, right, both((failing, absent)))))


def _without(node: Formula, window: GoalWindow, right: Formula, goal: Goal) -> Goal:
    """``goal`` at some instant of the window, and ``right`` at none before it."""
    reached = condition_of(right)
    if reached is not None:
        return _sometime(window, negated(reached), goal)
    match right:
        case formula.Rise(operand=operand) | formula.Fall(operand=operand) if window.is_ever:
            high = _condition(operand) if isinstance(right, formula.Rise) else negated(_condition(operand))
            fallen = _sometime(window, negated(high), goal)
            # A condition that does not rise is true for a while, then false.
            unrisen = both((_goal(right, False), _sometime(window, high, either((goal, fallen)))))
            return goal if _is_impossible(unrisen) else either((goal, unrisen))
        case _:
            raise NoObserver(
                right.span,
                "a temporal formula cannot stand here: in this place an observer needs a condition on one state, or "
                "such a condition becoming true or false in an until without bounds",
                "split the requirement, or name a state of the model that stands for this part",
            )


def _is_impossible(goal: Goal) -> bool:
    ways = ways_of(goal)
    return ways is not None and not any(map(is_possible, ways))


def _always(node: Formula, window: GoalWindow, goal: Goal) -> Goal:
    """``goal`` at every instant of a window that is neither empty nor only the present; ``node`` asks for it."""
    span = node.span
    match goal:
        case Holds(condition=condition):
            if condition == truth(True, span) and window.high is not None:
                return goal
            promised = isinstance(node, formula.Eventually | formula.Until)
            return Throughout(window, condition, strict=promised and window.high is None)
        case Both(parts=parts):
            return both(tuple(_always(node, window, part) for part in parts))
        case Throughout(window=inner, condition=condition):
            return _always(node, window.then(inner), Holds(condition))
        case Sometime(window=inner, meanwhile=meanwhile) if inner.high is None and meanwhile == truth(True, span):
            return _again(span, window, inner, goal)
        case Sometime():
            return _recurring(span, window, truth(False, span), goal)
        case Either(parts=(Holds(condition=condition), Sometime() as answer)):
            return _recurring(span, window, condition, answer)
        case Either() | Preceded() if (found := _everywhere(node, window, goal)) is not None:
            return found
        case _:
            raise NoObserver(
                span,
                "to violate this, something temporal would have to hold at every instant of a window; to see that, "
                "an observer would need more clocks than it has",
                "name a bounded number of instants: use `rise(...)` in a trigger, or split the requirement",
            )


def _again(span: Span, window: GoalWindow, inner: GoalWindow, goal: Sometime) -> Goal:
    """From every instant of the window on, some time later: that is, at some time after the last instant."""
    if window.high is None:
        if isinstance(goal.goal, Holds):
            return ResponseGoal(truth(False, span), goal.goal.condition)
        raise NoObserver(
            span,
            "to violate this, something temporal would have to be seen again and again",
            "say it of a condition, as in `F G q`, or let a location of the model stand for it",
        )
    if window.high_closed:
        return replace(goal, window=GoalWindow(window.high + inner.low, None, inner.low_closed))
    raise NoObserver(span, "the window has no last instant, from which on it would have to be so", "close the bound")


def _everywhere(node: Formula, window: GoalWindow, goal: Either | Preceded) -> Goal | None:
    """``goal`` at every instant of the window where it is about the instant, of what was right before, and of at most
    one thing that lasts from then on."""
    parts = goal.parts if isinstance(goal, Either) else (goal,)
    now = [part for part in parts if ways_of(part) is not None]
    later = [part for part in parts if ways_of(part) is None]
    allowed = ways_of(Either(tuple(now)))
    if len(later) > 1 or not allowed:
        return None
    inner_ways: tuple[GoalAlternative, ...] = ()
    inner: GoalWindow | None = None
    match later:
        case []:
            pass
        case [Both(parts=each)]:
            return both(tuple(_always(node, window, either((*now, part))) for part in each))
        case [Throughout(window=inner, condition=condition)]:
            inner_ways = (GoalAlternative(condition, frozenset()),)
        case [Everywhere(window=inner, allowed=inner_ways, inner_ways=())]:
            pass
        case _:
            return None
    if inner is not None and inner.low > 0:
        return None
    high = None if window.high is None else window.high - window.low
    rest = GoalWindow(0, high, window.low_closed, window.high_closed)
    found = goal if rest.is_now else Everywhere(rest, allowed, inner_ways, inner)
    return found if window.low == 0 else Sometime(GoalWindow(window.low, window.low), truth(True, node.span), found)


def _recurring(span: Span, window: GoalWindow, condition: ast.Expression, goal: Sometime) -> Goal:
    inner = goal.window
    if (
        isinstance(goal.goal, Holds)
        and goal.meanwhile == truth(True, span)
        and inner.low == 0
        and inner.low_closed
        and window.low_closed
    ):
        if inner.high is None and window.is_ever:
            return ResponseGoal(condition, goal.goal.condition)
        if inner.high is None:
            raise NoObserver(
                span,
                "to violate this, each instant of a window would need an answer, however late",
                "let the window of the outer operator begin at 0 and have no end, or give the inner one an end",
            )
        return Recurring(window, condition, goal.goal.condition, inner.high, inner.high_closed)
    raise NoObserver(
        span,
        "at every instant of a window another window begins, and an observer can follow these only if the inner one "
        "begins at once and asks for a plain condition",
        "let the inner window begin at 0",
    )


# ---- edges and the past ---------------------------------------------------------------------------------------------


def _edge(condition: ast.Expression, rises: bool, positive: bool) -> Goal:
    """``condition`` becomes true or false at an instant, or does not. Before the run everything is false."""
    now = condition if rises else negated(condition)
    if positive:
        return Both((Holds(now), Preceded(HeldBefore(negated(now), rises))))
    return Either((Holds(negated(now)), Preceded(HeldBefore(now, not rises))))


def _past_window(interval: formula.Interval, condition: ast.Expression, positive: bool, once: bool) -> Goal:
    wanted = condition if positive else negated(condition)
    window = _behind(interval)
    if window.is_empty:
        return Holds(truth(not once, condition.span))
    if window.is_now:
        return Holds(wanted)
    if once:
        return Either((Holds(wanted), Preceded(Was(truth(True, condition.span), wanted, window.high))))
    return Both((Holds(wanted), Preceded(HeldFor(wanted, window.high))))


def _since(interval: formula.Interval, left: ast.Expression, right: ast.Expression, positive: bool) -> Goal:
    window = _behind(interval)
    if window.is_empty:
        return Holds(truth(not positive, right.span))
    if window.is_now:
        return Holds(right if positive else negated(right))
    if positive:
        there = all_of((left, right), right.span)
        return Either((Holds(right), Both((Holds(left), Preceded(Was(left, there, window.high))))))
    # Either the window lacks `right`, or it does so from the end of a time without `left` on, the last instant of which
    # need not exist; `right` before that end is of no use, as `left` is false between.
    absent = negated(right)
    return Either(
        (
            Holds(_neither(left, right)),
            Both((Holds(absent), Preceded(HeldFor(absent, window.high)))),
            Both((Holds(absent), Preceded(Was(absent, negated(left), None)))),
        )
    )


def _behind(interval: formula.Interval) -> GoalWindow:
    window = window_of(interval)
    if not window.is_empty and not (window.low == 0 and window.low_closed):
        raise NoObserver(
            interval.span,
            "an operator about the past whose window does not reach up to the present needs a clock for each time "
            "the condition changes inside it",
            "let the window begin at 0",
        )
    return window
