"""The states of an observer: what has yet to be shown for a violation.

A state is a set of *items*: tasks that look ahead, conditions that were asserted of the present instant and have to
last for some time (`Settling`), and pasts that were seen so far.

Clocks are handed out to the items of a state; those that begin at the same instant share one.
"""

from __future__ import annotations

from collections.abc import Iterator

from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass, replace
from tachk.logic.observer.conditions import Conjunction, truth
from tachk.logic.observer.goals import (
    Everywhere,
    GoalWindow,
    HeldBefore,
    HeldFor,
    Past,
    Recurring,
    ResponseGoal,
    Sometime,
    Throughout,
    Was,
)

FRESH = -1
"""The clock that a step sets to 0, before it has a number."""

Lasting = Sometime | Throughout | Recurring | ResponseGoal | Everywhere


@dataclass(frozen=True, slots=True)
class TableauTask:
    """Something to be shown from now on.

    Attributes:
        phase: ``ahead`` of the window; ``on`` inside it; ``gap``: an answer is awaited; ``met``: one is there, and has
            to last for some time; for `Everywhere` those that `everywhere` names.
        clocks: the time since the task began; in a gap also the time since the gap began.
        before: for `Everywhere`, what the conditions were right before the present instant.
    """

    goal: Lasting
    phase: str
    clocks: tuple[int, ...] = ()
    before: tuple[bool, ...] = ()


@dataclass(frozen=True, slots=True)
class Settling:
    """Conditions asserted of an instant: they have to hold until the clock, 0 then, is positive."""

    conditions: Conjunction
    clock: int


@dataclass(frozen=True, slots=True)
class Seen:
    """A past that is being watched.

    Attributes:
        phase: ``initial``: since the run began; ``on``; ``since``: what had to be there is over.
    """

    past: Past
    phase: str
    clocks: tuple[int, ...] = ()


Item = TableauTask | Settling | Seen
State = frozenset[Item]

SHOWN: State = frozenset()
"""Nothing is left to be shown: the formula is violated."""


@dataclass(frozen=True, slots=True)
class ClockGuard:
    """``clock operator value``"""

    clock: int
    operator: BinaryOperator
    value: int


def at_most(clock: int, value: int, closed: bool) -> ClockGuard:
    return ClockGuard(clock, BinaryOperator.LESS_EQUAL if closed else BinaryOperator.LESS, value)


def at_least(clock: int, value: int, closed: bool) -> ClockGuard:
    return ClockGuard(clock, BinaryOperator.GREATER_EQUAL if closed else BinaryOperator.GREATER, value)


def positive(clock: int) -> ClockGuard:
    """Time has passed since the clock was reset."""
    return at_least(clock, 0, False)


# ---- small questions about states -----------------------------------------------------------------------------------


def timed_tasks(state: State) -> int:
    """The number of tasks with clocks."""
    return sum(isinstance(item, TableauTask) and bool(item.clocks) for item in state)


def may_pass(task: TableauTask) -> bool:
    """True if the task may be exchanged for others at the instant at which it begins, whatever it requires."""
    return isinstance(task.goal, Sometime) or (isinstance(task.goal, Recurring) and task.phase == "on")


def is_there_initially(past: Past) -> bool:
    """True if the past is there when the run begins. Values are not saved by then: `branches_of` sees to that."""
    return isinstance(past, HeldFor) or (isinstance(past, HeldBefore) and past.initially)


def lasts_for_ever(task: TableauTask) -> bool:
    """True if the task is never done, and only a run without end fulfils it."""
    match task:
        case TableauTask(goal=Sometime()) | TableauTask(phase="ahead"):
            return False
        case TableauTask(goal=Everywhere(inner=GoalWindow(high=None)), phase="last" | "past closed" | "past open"):
            return True
        case TableauTask(goal=ResponseGoal()):
            return True
        case TableauTask(goal=Throughout() | Recurring() | Everywhere() as goal):
            return goal.window.high is None
        case _:
            return False


def answered_in(state: State) -> Iterator[TableauTask]:
    """The tasks that are about answers again and again."""
    return (item for item in state if isinstance(item, TableauTask) and isinstance(item.goal, ResponseGoal))


def is_strict(item: Item) -> bool:
    """True if what the item requires must hold in every state, too, in which no time passes."""
    return (
        isinstance(item, TableauTask) and isinstance(item.goal, Throughout) and item.goal.strict and item.phase == "on"
    )


def is_endless(state: State) -> bool:
    """True if a run that never leaves the state violates the formula."""
    tasks = [item for item in state if isinstance(item, TableauTask)]
    return bool(tasks) and all(map(lasts_for_ever, tasks))


def binds(state: State) -> bool:
    """True if it matters in every state of a run from here on what holds."""
    return is_endless(state) or any(map(is_strict, state))


def waits_for_ever(state: State) -> bool:
    tasks = [item for item in state if isinstance(item, TableauTask)]
    return (
        len(tasks) == 1
        and not any(isinstance(item, Settling) for item in state)
        and isinstance(tasks[0].goal, Sometime)
        and tasks[0].goal.window.is_ever
        and tasks[0].goal.meanwhile == truth(True, tasks[0].goal.meanwhile.span)
    )


def numbered(items: frozenset[Item]) -> tuple[State, int | None]:
    """The items with the fresh clock replaced by the first one that is free."""
    clocks = {clock for item in items for clock in _clocks(item)}
    if FRESH not in clocks:
        return items, None
    free = next(number for number in range(len(clocks)) if number not in clocks)
    return frozenset(_with_clock(item, free) for item in items), free


def _clocks(item: Item) -> tuple[int, ...]:
    return (item.clock,) if isinstance(item, Settling) else item.clocks


def _with_clock(item: Item, number: int) -> Item:
    if isinstance(item, Settling):
        return replace(item, clock=number) if item.clock == FRESH else item
    if FRESH not in item.clocks:
        return item
    return replace(item, clocks=tuple(number if clock == FRESH else clock for clock in item.clocks))


def ordered(state: State) -> list[Item]:
    return sorted(state, key=repr)


# ---- conditions on clocks -------------------------------------------------------------------------------------------


def readiness(item: Seen) -> tuple[ClockGuard, ...] | None:
    """The constraint on the clock for the past to count."""
    match item:
        case Seen(phase="initial"):
            return ()
        case Seen(past=HeldFor(length=int(length)), clocks=(clock,)):
            return (at_least(clock, length, True),)
        case Seen(past=Was(length=int(length)), phase="since", clocks=(clock,)):
            return (at_most(clock, length, False),)
        case Seen(past=Was(), phase="since"):
            return ()
        case Seen(clocks=(clock,)):
            return (positive(clock),)
        case _:
            return None


def inside(window: GoalWindow, clocks: tuple[int, ...]) -> tuple[ClockGuard, ...]:
    if not clocks:
        return ()
    found = []
    if window.low > 0 or not window.low_closed:
        found.append(at_least(clocks[0], window.low, window.low_closed))
    if window.high is not None:
        found.append(at_most(clocks[0], window.high, window.high_closed))
    return tuple(found)


def still(window: GoalWindow, clock: int) -> ClockGuard:
    """The window is not over: another instant of it is to come or is now."""
    assert window.high is not None
    return at_most(clock, window.high, window.high_closed)


def over(window: GoalWindow, clock: int) -> ClockGuard:
    assert window.high is not None
    return at_least(clock, window.high, not window.high_closed)


def implies_positive(guard: ClockGuard, clock: int) -> bool:
    return guard.clock == clock and (
        guard.operator == BinaryOperator.GREATER
        or (guard.operator in (BinaryOperator.GREATER_EQUAL, BinaryOperator.EQUAL) and guard.value > 0)
    )
