"""The steps of an observer: its states (`observer_states`) unfolded from its goal (`observer_expansion`).

Time passes in a state only while its requirement holds. What holds at an instant is what lasts for some time from then
on; values that are overwritten in the same instant do not count. A step happens at one instant, several steps
may happen at the same one.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, replace

from tachk.base.operators import BinaryOperator
from tachk.base.span import Span
from tachk.logic.observer import everywhere
from tachk.logic.observer.conditions import Conjunction, all_of, conjunction, is_false, negated, truth
from tachk.logic.observer.goals import (
    Everywhere,
    Goal,
    GoalWindow,
    HeldBefore,
    HeldFor,
    Holds,
    Past,
    Recurring,
    ResponseGoal,
    Saved,
    Sometime,
    Throughout,
    Was,
)
from tachk.logic.observer.states import (
    FRESH,
    SHOWN,
    ClockGuard,
    Item,
    Lasting,
    Seen,
    Settling,
    State,
    TableauTask,
    answered_in,
    at_most,
    implies_positive,
    inside,
    is_endless,
    is_strict,
    is_there_initially,
    may_pass,
    numbered,
    ordered,
    over,
    positive,
    readiness,
    still,
    waits_for_ever,
)
from tachk.logic.observer.ways import GoalBranch, SavedNames, branches_of, comparison, looking_back, pasts_wanted
from tachk.syntax import ast


@dataclass(frozen=True, slots=True)
class TableauStep:
    """Attributes:
    reset: the clock that is set to 0, if one is.
    forced: time does not pass while the condition of the step holds.
    saved: the expression whose value is saved.
    """

    source: State
    target: State
    clocks: tuple[ClockGuard, ...] = ()
    condition: Conjunction = frozenset()
    reset: int | None = None
    forced: bool = False
    saved: ast.Expression | None = None


class Tableau:
    """The steps of an observer.

    Args:
        saved: a variable for each expression whose changes matter.
    """

    def __init__(self, goal: Goal, span: Span, saved: SavedNames) -> None:
        self.span = span
        self.saved = saved
        goal = looking_back(goal)
        self.branches = branches_of(goal, self.saved)
        first = [
            branch for branch in branches_of(goal, saved, at_start=True) if all(map(is_there_initially, branch.pasts))
        ]
        self.initial = [self._begun(branch) for branch in first]
        """The states that the run may begin in, each with the condition that has to hold then."""
        ever = [state for state, _ in self.initial if waits_for_ever(state)]
        self.idle: State | None = None
        """The state to which the observer goes when its guess was wrong; None: it gives up there."""
        if ever:
            self.idle = frozenset(item for item in ever[0] if isinstance(item, TableauTask))
        self.idle_has_one_goal = self.idle is not None and len(_first_goals(self, self.idle)) == 1

    def _begun(self, branch: GoalBranch) -> tuple[State, Conjunction]:
        wanted = pasts_wanted(branch.tasks, self.saved)
        pasts = [Seen(past, "initial") for past in wanted if is_there_initially(past)]
        settling = self._settling(branch.now, FRESH)
        if not branch.tasks and not settling:
            return SHOWN, frozenset()
        return numbered(frozenset((*branch.tasks, *settling, *pasts)))[0], branch.now

    # ---- requirements -----------------------------------------------------------------------------------------------

    def requirement(self, state: State) -> Conjunction:
        """The condition while time passes."""
        return conjunction(part for item in state for part in self._requirement(item))

    def lasting(self, state: State) -> Conjunction:
        """The condition at every moment in a state that is never left, whether time passes or not."""
        return conjunction(part for item in state if is_strict(item) for part in self._requirement(item))

    def settled(self, state: State) -> Conjunction:
        """The other conditions that must hold where a run ends in a state that is never left, and again and again if it
        takes steps for ever at one instant."""
        others = (item for item in state - frozenset(answered_in(state)) if not is_strict(item))
        return conjunction(part for item in others for part in self._requirement(item))

    def meets(self, state: State, goal: Lasting) -> ast.Expression | None:
        """Under which condition a state is one of those that are met again and again where answers are; None: never."""
        task = next((task for task in answered_in(state) if task.goal == goal), None)
        if task is None:
            return truth(True, self.span)
        return None if task.phase == "gap" else all_of(self._requirement(task), self.span)

    def _requirement(self, item: Item) -> Iterator[ast.Expression]:
        match item:
            case Settling(conditions=conditions):
                yield from conditions
            case TableauTask(goal=Sometime(meanwhile=meanwhile)):
                yield meanwhile
            case TableauTask(phase="ahead" | "gap"):
                pass
            case TableauTask(goal=ResponseGoal(answer=answer), phase="met"):
                yield answer
            case TableauTask(goal=ResponseGoal(condition=condition, answer=answer)):
                yield _or(condition, answer)
            case TableauTask(goal=Throughout(condition=condition)):
                yield condition
            case TableauTask(goal=Recurring(condition=condition, answer=answer)):
                yield _or(condition, answer)
            case TableauTask(goal=Everywhere()):
                yield from everywhere.requirement(item)
            case Seen(past=HeldBefore(condition=condition) | HeldFor(condition=condition)):
                yield condition
            case Seen(past=Was(since=since, there=there), phase=phase):
                yield there if phase == "on" else since
            case Seen(past=Saved(expression=expression)):
                yield comparison(expression, True, self.saved)
            case _:
                raise TypeError(f"{item} requires nothing that is known")

    def deadlines(self, state: State) -> dict[tuple[int, int], State | None]:
        """Pairs (clock, value): when a clock has reached its value, the state is of no more use than the one that the
        pair leads to; None: than giving up."""
        found: dict[tuple[int, int], State | None] = {}
        for item in state:
            match item:
                case TableauTask(goal=Sometime(window=GoalWindow(high=int(high))), clocks=(clock,)):
                    found[clock, high] = None
                case TableauTask(
                    goal=Throughout() | Recurring() | Everywhere() as goal, phase="ahead", clocks=(clock, *_)
                ):
                    found[clock, goal.window.low] = None
                case TableauTask(goal=Recurring(length=length), phase="gap", clocks=(*_, clock)):
                    found[clock, length] = None
                case Seen(past=Was(length=int(length)), phase="since", clocks=(clock,)):
                    found.setdefault((clock, length), state - {item})
                case _:
                    pass
        return found

    # ---- steps ------------------------------------------------------------------------------------------------------

    def steps(self, state: State) -> Iterator[TableauStep]:
        """The steps that lead on from a state."""
        for item in ordered(state):
            if isinstance(item, TableauTask):
                yield from self._task_steps(state, item)
        yield from self._settled(state)
        yield from self._past_steps(state)

    def _task_steps(self, state: State, task: TableauTask) -> Iterator[TableauStep]:
        match task:
            case TableauTask(goal=Sometime(window=window, goal=goal)):
                guards = inside(window, task.clocks)
                for branch in branches_of(goal, self.saved):
                    for ready in self._ready(state, branch.pasts):
                        yield from self._step(state, task, branch.tasks, branch.now, (*guards, *ready))
            case TableauTask(goal=Throughout() | Recurring() | Everywhere() as goal, phase="ahead", clocks=(clock, *_)):
                on = replace(task, phase="on", clocks=() if goal.window.high is None else (clock,))
                begins = ClockGuard(clock, BinaryOperator.EQUAL, goal.window.low)
                yield from self._step(state, task, (on,), frozenset(), (begins,))
            case TableauTask(goal=Recurring(window=window, answer=answer, length=length, closed=closed), phase="gap"):
                *ends, gap = task.clocks
                in_time = at_most(gap, length, closed)
                on = TableauTask(task.goal, "on", tuple(ends))
                now = conjunction((answer,))
                yield from self._step(state, task, (on,), now, (in_time, *(still(window, clock) for clock in ends)))
                for clock in ends:
                    yield from self._step(state, task, (), now, (in_time, over(window, clock)))
            case TableauTask(goal=ResponseGoal()):
                yield from self._answered_steps(state, task)
            case TableauTask(goal=Everywhere()):
                for move in everywhere.moves(task):
                    tasks = () if move.task is None else (move.task,)
                    yield from self._step(state, task, tasks, move.now, move.clocks, move.guard)
            case TableauTask(goal=Throughout() | Recurring() as goal, clocks=ends):
                for clock in ends:
                    yield from self._step(state, task, (), frozenset(), (over(goal.window, clock),))
                if isinstance(goal, Recurring):
                    open_ = conjunction((negated(_or(goal.condition, goal.answer)),))
                    gap_task = TableauTask(goal, "gap", (*ends, FRESH))
                    begun = tuple(still(goal.window, clock) for clock in ends)
                    yield from self._step(state, task, (gap_task,), frozenset(), begun, guard=open_)
            case _:
                raise TypeError(f"{task} leads nowhere that is known")

    def _answered_steps(self, state: State, task: TableauTask) -> Iterator[TableauStep]:
        goal = task.goal
        assert isinstance(goal, ResponseGoal)
        match task.phase:
            case "on":
                open_ = conjunction((negated(_or(goal.condition, goal.answer)),))
                yield from self._step(state, task, (TableauTask(goal, "gap"),), frozenset(), (), guard=open_)
            case "gap":
                yield from self._step(state, task, (TableauTask(goal, "met", (FRESH,)),), frozenset(), ())
            case _:
                lasted = positive(task.clocks[0])
                yield from self._step(state, task, (TableauTask(goal, "on"),), frozenset(), (lasted,))

    def _ready(self, state: State, pasts: Iterable[Past]) -> Iterator[tuple[ClockGuard, ...]]:
        """The clock constraints under which all pasts are there; none if one is not being watched."""
        seen = {item.past: item for item in state if isinstance(item, Seen)}
        if all(past in seen for past in pasts):
            guards = [readiness(seen[past]) for past in pasts]
            if None not in guards:
                yield tuple(guard for found in guards for guard in found or ())

    def _step(
        self,
        state: State,
        done: TableauTask,
        tasks: Collection[TableauTask],
        now: Conjunction,
        clocks: tuple[ClockGuard, ...],
        guard: Conjunction = frozenset(),
    ) -> Iterator[TableauStep]:
        """A step with other tasks for one. Assertions about the same instant stay open, older ones are settled."""
        others = [item for item in state if isinstance(item, TableauTask) and item != done]
        after = frozenset((*others, *tasks))
        wanted = pasts_wanted(after, self.saved)
        pasts = [item for item in state if isinstance(item, Seen) and item.past in wanted]
        new = [part for task in tasks if not may_pass(task) for part in self._requirement(task)]
        condition = conjunction((*guard, *now, *new))
        open_ = next((item for item in state if isinstance(item, Settling)), None)
        stuck = is_false(self.requirement(state))
        if open_ is None or not stuck:
            yield from self._made(state, (*after, *pasts, *self._settling(now, FRESH)), clocks, condition, open_)
        # A window that is over stays over, so that assertions may be settled first.
        ends = not tasks and not now
        if open_ is not None and not ends and not any(implies_positive(clock, open_.clock) for clock in clocks):
            settling = self._settling(open_.conditions | now, FRESH if now else open_.clock)
            target: State = frozenset((*after, *pasts, *settling))
            if not is_endless(target):  # else both may be met again and again at one instant, in turn
                condition = conjunction((*condition, *open_.conditions))
            yield from self._made(state, target, clocks, condition, None)

    def _made(
        self,
        state: State,
        items: Iterable[Item],
        clocks: tuple[ClockGuard, ...],
        condition: Conjunction,
        settled: Settling | None,
    ) -> Iterator[TableauStep]:
        if is_false(condition):
            return
        if settled is not None and not any(implies_positive(clock, settled.clock) for clock in clocks):
            clocks = (*clocks, positive(settled.clock))
        target, reset = numbered(frozenset(items))
        if not any(isinstance(item, TableauTask | Settling) for item in target):
            target = SHOWN
        yield TableauStep(state, target, clocks, condition, reset, forced=self._may_force(state, target, clocks))

    def _may_force(self, state: State, target: State, clocks: tuple[ClockGuard, ...]) -> bool:
        """True if nothing is lost if this step is taken as soon as it can be: idle, the observer waits for conditions
        that then have to last for a given time, and has no other choice."""
        return (
            state == self.idle
            and not clocks
            and len(self.branches) == 1
            and self.idle_has_one_goal
            and all(
                isinstance(item, Settling) or (isinstance(item, TableauTask) and isinstance(item.goal, Throughout))
                for item in target
            )
            and not any(isinstance(item, TableauTask) and item.phase == "ahead" for item in target)
        )

    def _settling(self, conditions: Conjunction, clock: int) -> tuple[Settling, ...]:
        return (Settling(conditions, clock),) if conditions else ()

    def _settled(self, state: State) -> Iterator[TableauStep]:
        """The assertion about an instant has lasted; a step that waits until it fails, unless nothing else is left."""
        settling = next((item for item in state if isinstance(item, Settling)), None)
        if settling is None or is_false(self.requirement(state)):
            return
        rest = state - {settling}
        if not any(isinstance(item, TableauTask) for item in rest):
            yield TableauStep(state, SHOWN, (positive(settling.clock),))
        elif not settling.conditions <= self.requirement(rest):
            ending = conjunction((negated(all_of(settling.conditions, self.span)),))
            if not self._is_goal(rest, ending):
                yield from self._made(state, rest, (), ending, settling)

    def _is_goal(self, state: State, condition: Conjunction) -> bool:
        """True if all that is left is to see the condition once from now on: then there is no better moment."""
        match [item for item in state if isinstance(item, TableauTask)]:
            case [TableauTask(goal=Sometime(window=window, goal=Holds() as goal))]:
                return window.low == 0 and window.low_closed and conjunction((goal.condition,)) <= condition
            case _:
                return False

    def _past_steps(self, state: State) -> Iterator[TableauStep]:
        """Pasts begin to be watched as soon as they can be, for an earlier beginning is never worse; and are given up
        when what has to last does not."""
        watched = {item.past: item for item in state if isinstance(item, Seen)}
        settling = next((item for item in state if isinstance(item, Settling)), None)
        for past in sorted(pasts_wanted(state, self.saved), key=repr):
            item = watched.get(past)
            if item is None:
                yield from self._begin(state, past, settling)
                continue
            without = state - {item}
            required = self._requirement(item)
            fails = conjunction((negated(all_of(required, self.span)),))
            if isinstance(past, Was) and item.phase == "on":
                follow = Seen(past, "since", (FRESH,) if past.length is not None else ())
                over = conjunction((past.since, negated(past.there)))
                yield from self._past_step(state, without | {follow}, over, (positive(item.clocks[0]),))
            if isinstance(past, Was) and item.phase == "since":
                again = Seen(past, "on", (FRESH,))
                found = conjunction((past.there,))
                yield from self._past_step(state, without | {again}, found, (), forced=True)
            if not is_false(fails):
                yield from self._past_step(state, without, fails, ())

    def _begin(self, state: State, past: Past, settling: Settling | None) -> Iterator[TableauStep]:
        if isinstance(past, HeldFor) and past.length is None:
            return
        item = Seen(past, "on", (FRESH,))
        if not isinstance(past, Saved):
            condition = conjunction(self._requirement(item))
            others = _remembered(state, past) if isinstance(past, HeldBefore) else state
            yield from self._past_step(state, others | {item}, condition, (), forced=True)
            return
        clocks: tuple[ClockGuard, ...] = ()
        if settling is not None:
            state_after, clocks = state - {settling} | {item}, (positive(settling.clock),)
        else:
            state_after = state | {item}
        for step in self._past_step(state, state_after, frozenset(), clocks, forced=not clocks):
            yield replace(step, saved=past.expression)

    def _past_step(
        self,
        state: State,
        items: State,
        condition: Conjunction,
        clocks: tuple[ClockGuard, ...],
        forced: bool = False,
    ) -> Iterator[TableauStep]:
        if is_false(condition):
            return
        target, reset = numbered(items)
        yield TableauStep(state, target, clocks, condition, reset, forced)


# ---- small questions ------------------------------------------------------------------------------------------------


def _remembered(state: State, begun: HeldBefore) -> State:
    """The state when something begins to be watched that has to have been there right before an instant.

    One clock gives for all such pasts: what begins now is of no use now, so that those which are needed can be used
    first. One that contradicts what begins is over."""
    items: set[Item] = set()
    for item in state:
        match item:
            case Seen(past=HeldBefore(condition=condition), phase="on"):
                if not is_false(conjunction((condition, begun.condition))):
                    items.add(replace(item, clocks=(FRESH,)))
            case _:
                items.add(item)
    return frozenset(items)


def _or(one: ast.Expression, other: ast.Expression) -> ast.Expression:
    if isinstance(one, ast.BooleanLiteral):
        return one if one.value else other
    return ast.BinaryExpression(one.span, BinaryOperator.OR, one, other)


def _first_goals(tableau: Tableau, state: State) -> list[GoalBranch]:
    goals = [item.goal.goal for item in state if isinstance(item, TableauTask) and isinstance(item.goal, Sometime)]
    return [branch for goal in goals for branch in branches_of(goal, tableau.saved)]
