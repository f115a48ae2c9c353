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

from tachk.base.operators import BinaryOperator
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

_IN_WINDOW = (FREE, DURING, CLOSED, OPEN)


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
        if not goal.window.low_closed:
            tasks = (_task(goal, FREE, valuation), *_obliged(goal, valuation, instant=False))
            found += [Beginning(task, frozenset(), frozenset()) for task in tasks]
            continue
        for way in goal.allowed:
            found.append(_begun(_task(goal, FREE, valuation), (way.condition,), way.before))
        for way in _demanded_at_once(goal):
            tasks = _obliged(goal, valuation, instant=True)
            found += [_begun(task, (way.condition,), way.before) for task in tasks]
    possible = [
        one for one in found if not is_false(one.now) and not is_false(conjunction((*one.now, *requirement(one.task))))
    ]
    return [one for one in possible if not any(_is_better(other, one) for other in possible)]


def _begun(task: TableauTask, conditions: Iterable[ast.Expression], pasts: frozenset[HeldBefore]) -> Beginning:
    return Beginning(task, _assertion(task, conjunction(conditions)), pasts)


def _is_better(one: Beginning, other: Beginning) -> bool:
    return one != other and one.task == other.task and one.now <= other.now and one.pasts <= other.pasts


def moves(task: TableauTask) -> Iterator[ObserverMoveTask]:
    """The steps that lead on from a task."""
    goal = _goal(task)
    allowed = _at(goal, goal.allowed, task.before)
    for guard in _over_window(task):
        yield ObserverMoveTask(_behind_window(task), clocks=(guard,))
    match task.phase:
        case "free":
            if goal.inner_ways:
                yield ObserverMoveTask(_next(task, DURING), guard=conjunction((negated(allowed),)))
        case "during":
            yield ObserverMoveTask(_next(task, OPEN), guard=conjunction((allowed,)))
        case "closed" | "open":
            for guard in _ended(task):
                yield ObserverMoveTask(_next(task, FREE), clocks=(guard,))
            yield ObserverMoveTask(_next(task, DURING), guard=conjunction((negated(allowed),)))
        case _:
            for guard in _ended(task):
                yield ObserverMoveTask(None, clocks=(guard,))
    for phase, conditions, renewed in _changes(task):
        for valuation in _others(task):
            yield from _change(task, phase, valuation, conjunction(conditions), renewed)


def _changes(task: TableauTask) -> list[tuple[str, list[ast.Expression], bool]]:
    """The phases that may follow when an edge happens, what is asserted of the instant, and whether an obligation
    begins."""
    goal = _goal(task)
    allowed, inner_ways = _at(goal, goal.allowed, task.before), _at(goal, goal.inner_ways, task.before)
    match task.phase:
        case "free" if goal.inner_ways:
            at_once = [inner_ways] if goal.inner is not None and goal.inner.low_closed else []
            return [(FREE, [allowed], True), (CLOSED, at_once, True), (DURING, at_once, True)]
        case "free":
            return [(FREE, [allowed], True)]
        case "during":
            return [
                (DURING, [inner_ways], True),
                (OPEN, [allowed, inner_ways], True),
                (CLOSED, [inner_ways], True),
            ]
        case "closed" | "open":
            return [
                (task.phase, [allowed, inner_ways], False),
                (CLOSED, [inner_ways], True),
                (DURING, [inner_ways], True),
            ]
        case _:
            return [(task.phase, [inner_ways], False)]


def _change(
    task: TableauTask, phase: str, valuation: Valuation, conditions: Conjunction, renewed: bool
) -> Iterator[ObserverMoveTask]:
    """The steps when edges lead to a valuation; also at the last instant of the window, or of an obligation, behind
    which it need not be as it should."""
    goal = _goal(task)
    after = _next(task, phase, valuation, renewed)
    required = conjunction((*conditions, *_values(goal, valuation)))
    if is_false(required):
        return
    if not is_false(conjunction((*required, *requirement(after)))) and (
        phase != DURING or _may_stay_undecided(goal, valuation)
    ):
        yield ObserverMoveTask(after, _assertion(after, conditions))
    if phase == DURING or conjunction(requirement(after)) <= required:
        return
    last_of_window = _last_instant(_over_window(task))
    last_of_obligation = () if renewed else _last_instant(_ended(task))
    if last_of_window:
        yield from _finished(_behind_window(after), required, last_of_window)
    if last_of_obligation:
        yield from _finished(_next(after, FREE) if task.phase in _IN_WINDOW else None, required, last_of_obligation)
    if last_of_window and last_of_obligation:
        yield from _finished(None, required, (*last_of_window, *last_of_obligation))


def _finished(
    rest: TableauTask | None, required: Conjunction, clocks: tuple[ClockGuard, ...]
) -> Iterator[ObserverMoveTask]:
    if rest is None or not is_false(conjunction((*required, *requirement(rest)))):
        yield ObserverMoveTask(rest, required, clocks)


def _over_window(task: TableauTask) -> tuple[ClockGuard, ...]:
    """The guard that the window is over, if it is not yet and ends some time."""
    window = _goal(task).window
    return (over(window, task.clocks[0]),) if task.phase in _IN_WINDOW and window.high is not None else ()


def _behind_window(task: TableauTask) -> TableauTask | None:
    """What is left of a task when the window is over."""
    match task.phase:
        case "free":
            return None
        case "during":
            return _next(task, "last")
        case phase:
            return _next(task, f"past {phase}")


def _last_instant(ends: tuple[ClockGuard, ...]) -> tuple[ClockGuard, ...]:
    """The guard of the last instant that counts, before the guard of an end; none if there is no last one."""
    return tuple(
        ClockGuard(end.clock, BinaryOperator.EQUAL, end.value) for end in ends if end.operator is BinaryOperator.GREATER
    )


def _assertion(task: TableauTask, allowed: Conjunction) -> Conjunction:
    """What is asserted of the instant at which the task begins with this memory: what is allowed there, and the memory.

    Nothing, if the task requires as much, and what it remembers of the instant is of no use at it: a step with
    another memory at the same instant would need no less than what is allowed anyway."""
    goal = _goal(task)
    asserted = conjunction((*allowed, *_values(goal, task.before)))
    if goal.inner_ways or not asserted <= conjunction(requirement(task)):
        return asserted
    behind = _at(goal, goal.allowed, task.before)
    others = (conjunction((behind, *_values(goal, other))) for other in _others(task))
    return frozenset() if all(is_false(other) or allowed <= other for other in others) else asserted


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
