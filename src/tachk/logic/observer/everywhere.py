"""Conditions at every instant of a window, edges and answers that last included, followed without guessing.

Between two instants at which one of the conditions changes whose edges matter, nothing rises or falls. So it is
enough to know what these conditions were right before an instant: a task remembers them, and a step from one
valuation to another one asserts for its instant what is allowed there. Where an instant that is not allowed requires
a condition that then has to last, the latest such instant requires it longest, and one clock is enough.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import product

from tachk.base.span import Span
from tachk.logic.observer.conditions import Conjunction, all_of, any_of, conjunction, is_false, negated, truth
from tachk.logic.observer.goals import (
    Both,
    Differs,
    Either,
    Everywhere,
    Goal,
    GoalAlternative,
    HeldBefore,
    Holds,
    Preceded,
    Recurring,
    ResponseGoal,
    Sometime,
    Throughout,
)
from tachk.logic.observer.states import FRESH, ClockGuard, TableauTask, at_least, over
from tachk.syntax import ast

Valuation = tuple[bool, ...]
"""The truth of the conditions whose edges matter."""

FREE, DURING, CLOSED, OPEN = "free", "during", "closed", "open"
"""The states of a task: there is no obligation; an interval makes one; an instant did, the last one that counts
included; an interval did. After the window, ``last`` and the last two with ``past`` in front."""


@dataclass(frozen=True, slots=True)
class ObserverMoveTask:
    """``task``: what is left to be shown, if anything; ``now``: the assertion about the instant."""

    task: TableauTask | None
    now: Conjunction = frozenset()
    clocks: tuple[ClockGuard, ...] = ()
    guard: Conjunction = frozenset()


@dataclass(frozen=True, slots=True)
class Beginning:
    """A task that begins at an instant, given what was right before it."""

    task: TableauTask
    now: Conjunction
    pasts: frozenset[HeldBefore]


def ways_of(goal: Goal) -> tuple[GoalAlternative, ...] | None:
    """The goal as a condition on an instant and what was right before; None where it is about more."""
    match goal:
        case Holds(condition=condition):
            return (GoalAlternative(condition, frozenset()),)
        case Preceded(past=HeldBefore() as before):
            return (GoalAlternative(truth(True, before.condition.span), frozenset((before,))),)
        case Either(parts=parts):
            found = [ways_of(part) for part in parts]
            return None if None in found else tuple(way for ways in found for way in ways or ())
        case Both(parts=parts):
            each = [ways_of(part) for part in parts]
            if None in each:
                return None
            return tuple(joined(chosen) for chosen in product(*(ways or () for ways in each)))
        case Preceded() | Differs() | Sometime() | Throughout() | Recurring() | ResponseGoal() | Everywhere():
            return None


def joined(ways: Iterable[GoalAlternative]) -> GoalAlternative:
    """The condition that holds in all the ways."""
    chosen = list(ways)
    parts = conjunction(way.condition for way in chosen)
    span = chosen[0].condition.span
    before = frozenset(past for way in chosen for past in way.before)
    return GoalAlternative(truth(False, span) if is_false(parts) else all_of(parts, span), before)


def is_possible(way: GoalAlternative) -> bool:
    """False only for a way in which no instant can be."""
    values = [_literal(before) for before in way.before]
    return not is_false(conjunction((way.condition,))) and len({edge for edge, _ in values}) == len(set(values))


def requirement(task: TableauTask) -> Iterator[ast.Expression]:
    """The condition while time passes."""
    goal = _goal(task)
    yield from _values(goal, task.before)
    if task.phase in (FREE, CLOSED, OPEN):
        yield _at(goal, goal.allowed, task.before)
    if task.phase != FREE:
        yield _at(goal, goal.inner_ways, task.before)


def beginnings(goal: Everywhere) -> list[Beginning]:
    """The ways to begin at an instant."""
    found: list[Beginning] = []
    for valuation in _valuations(goal):
        values = _values(goal, valuation)
        if not goal.window.low_closed:
            tasks = (_task(goal, FREE, valuation), *_obliged(goal, valuation, instant=False))
            found += [Beginning(task, frozenset(), frozenset()) for task in tasks]
            continue
        for way in goal.allowed:
            found.append(_begun(_task(goal, FREE, valuation), (way.condition, *values), way.before))
        for way in _demanded_at_once(goal):
            tasks = _obliged(goal, valuation, instant=True)
            found += [_begun(task, (way.condition, *values), way.before) for task in tasks]
    possible = [
        one for one in found if not is_false(one.now) and not is_false(conjunction((*one.now, *requirement(one.task))))
    ]
    return [one for one in possible if not any(_is_better(other, one) for other in possible)]


def _begun(task: TableauTask, conditions: Iterable[ast.Expression], pasts: frozenset[HeldBefore]) -> Beginning:
    return Beginning(task, _conditions_to_require(task, conjunction(conditions)), pasts)


def _is_better(one: Beginning, other: Beginning) -> bool:
    return one != other and one.task == other.task and one.now <= other.now and one.pasts <= other.pasts


def moves(task: TableauTask) -> Iterator[ObserverMoveTask]:
    """The steps that lead on from a task."""
    goal = _goal(task)
    allowed, inner_ways = _at(goal, goal.allowed, task.before), _at(goal, goal.inner_ways, task.before)
    if task.phase in (FREE, DURING, CLOSED, OPEN) and goal.window.high is not None:
        after = {FREE: None, DURING: _next(task, "last")}.get(task.phase, _next(task, f"past {task.phase}"))
        yield ObserverMoveTask(after, clocks=(over(goal.window, task.clocks[0]),))
    match task.phase:
        case "free":
            if goal.inner_ways:
                yield ObserverMoveTask(_next(task, DURING), guard=conjunction((negated(allowed),)))
            at_once = [inner_ways] if goal.inner is not None and goal.inner.low_closed else []
            for valuation in _others(task):
                yield from _change(task, FREE, valuation, (allowed,))
                if goal.inner_ways:
                    yield from _change(task, CLOSED, valuation, at_once)
                    yield from _change(task, DURING, valuation, at_once)
        case "during":
            yield ObserverMoveTask(_next(task, OPEN), guard=conjunction((allowed,)))
            for valuation in _others(task):
                yield from _change(task, DURING, valuation, (inner_ways,))
                yield from _change(task, OPEN, valuation, (allowed, inner_ways))
                yield from _change(task, CLOSED, valuation, (inner_ways,))
        case "closed" | "open":
            for guard in _ended(task):
                yield ObserverMoveTask(_next(task, FREE), clocks=(guard,))
            yield ObserverMoveTask(_next(task, DURING), guard=conjunction((negated(allowed),)))
            for valuation in _others(task):
                yield from _change(task, task.phase, valuation, (allowed, inner_ways), renewed=False)
                yield from _change(task, CLOSED, valuation, (inner_ways,))
                yield from _change(task, DURING, valuation, (inner_ways,))
        case _:
            for guard in _ended(task):
                yield ObserverMoveTask(None, clocks=(guard,))
            for valuation in _others(task):
                yield from _change(task, task.phase, valuation, (inner_ways,))


def _change(
    task: TableauTask, phase: str, valuation: Valuation, conditions: Iterable[ast.Expression], renewed: bool = True
) -> Iterator[ObserverMoveTask]:
    goal = _goal(task)
    after = _next(task, phase, valuation, renewed)
    required = conjunction((*conditions, *_values(goal, valuation)))
    if phase == DURING and not _may_stay_undecided(goal, valuation):
        return
    if not is_false(required) and not is_false(conjunction((*required, *requirement(after)))):
        yield ObserverMoveTask(after, _conditions_to_require(after, required))


def _conditions_to_require(task: TableauTask, conditions: Conjunction) -> Conjunction:
    """The conditions to assert at an instant; none if the task requires as much, and its memory of the instant cannot
    allow more than is allowed."""
    goal = _goal(task)
    required = conjunction(requirement(task))
    if goal.inner_ways or not conditions <= required:
        return conditions
    allowed = _at(goal, goal.allowed, task.before)
    if allowed == truth(True, allowed.span):
        return frozenset()
    stays = all(is_false(conjunction((allowed, *_values(goal, other)))) for other in _others(task))
    return frozenset() if stays else conditions


# ---- tasks ----------------------------------------------------------------------------------------------------------


def _task(goal: Everywhere, phase: str, valuation: Valuation) -> TableauTask:
    return TableauTask(goal, phase, (FRESH, FRESH) if phase in (CLOSED, OPEN) else (FRESH,), valuation)


def _obliged(goal: Everywhere, valuation: Valuation, instant: bool) -> tuple[TableauTask, ...]:
    """The tasks that begin with something to last, which the instant itself, or only a later one, requires."""
    if not goal.inner_ways:
        return ()
    during = _task(goal, DURING, valuation)
    lasting = (during,) if _may_stay_undecided(goal, valuation) else ()
    return (_task(goal, CLOSED, valuation), *lasting) if instant else lasting


def _may_stay_undecided(goal: Everywhere, valuation: Valuation) -> bool:
    """True if an interval, and not only an instant, can ask for something that lasts."""
    undecided = negated(_at(goal, goal.allowed, valuation))
    return not is_false(conjunction((undecided, *_values(goal, valuation))))


def _next(task: TableauTask, phase: str, valuation: Valuation | None = None, renewed: bool = True) -> TableauTask:
    before = task.before if valuation is None else valuation
    clocks: tuple[int, ...] = task.clocks[:1]
    if phase in (CLOSED, OPEN):
        clocks = (task.clocks[0], FRESH) if renewed else task.clocks
    elif phase.startswith("past"):
        clocks = task.clocks[-1:]
    return TableauTask(task.goal, phase, clocks, before)


def _ended(task: TableauTask) -> tuple[ClockGuard, ...]:
    """The guard that nothing has to last any longer, if there is such a moment."""
    goal = _goal(task)
    assert goal.inner is not None
    if goal.inner.high is None:
        return ()
    closed = goal.inner.high_closed
    if task.phase == "last":
        assert goal.window.high is not None
        sum_ = goal.window.high + goal.inner.high
        return (at_least(task.clocks[0], sum_, not (closed and goal.window.high_closed)),)
    return (at_least(task.clocks[-1], goal.inner.high, not (closed and task.phase.endswith(CLOSED))),)


def _goal(task: TableauTask) -> Everywhere:
    assert isinstance(task.goal, Everywhere)
    return task.goal


# ---- valuations -----------------------------------------------------------------------------------------------------


def _literal(before: HeldBefore) -> tuple[ast.Expression, bool]:
    opposite = negated(before.condition)
    if repr(opposite) < repr(before.condition):
        return opposite, False
    return before.condition, True


def _edges(goal: Everywhere) -> list[ast.Expression]:
    found = {_literal(before)[0] for way in (*goal.allowed, *goal.inner_ways) for before in way.before}
    return sorted(found, key=repr)


def _valuations(goal: Everywhere) -> Iterator[Valuation]:
    return product((False, True), repeat=len(_edges(goal)))


def _others(task: TableauTask) -> Iterator[Valuation]:
    return (valuation for valuation in _valuations(_goal(task)) if valuation != task.before)


def _values(goal: Everywhere, valuation: Valuation) -> list[ast.Expression]:
    return [edge if value else negated(edge) for edge, value in zip(_edges(goal), valuation, strict=True)]


def _at(goal: Everywhere, ways: tuple[GoalAlternative, ...], valuation: Valuation) -> ast.Expression:
    """The demands of the ways on an instant if the conditions had these values right before it."""
    known = dict(zip(_edges(goal), valuation, strict=True))
    possible = [
        way.condition
        for way in ways
        if all(known[edge] == value for edge, value in (_literal(before) for before in way.before))
    ]
    return any_of(possible, _span(goal))


def _demanded_at_once(goal: Everywhere) -> tuple[GoalAlternative, ...]:
    if goal.inner is None or goal.inner.low_closed:
        return goal.inner_ways
    return (GoalAlternative(truth(True, _span(goal)), frozenset()),)


def _span(goal: Everywhere) -> Span:
    return goal.allowed[0].condition.span
