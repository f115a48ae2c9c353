"""The states of an observer: what has yet to be shown for a violation, found by expanding its goal.

A state is a set of *items*: tasks that look ahead, conditions that were claimed of the present instant and have to
last for some time (`Settling`), and pasts that were seen so far. Time passes in a state only while its requirement
holds. What holds at an instant is what lasts for some time from then on; values that are overwritten in the same
instant are nobody's business. A step happens at one instant, several steps may happen at the same one.

Clocks are handed out to the items of a state; those that begin at the same instant share one.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import product

from tachk.diagnostics.span import Span
from tachk.logic.observer_conditions import Conjunction, all_of, conjunction, is_false, negated, truth
from tachk.logic.observer_violation import (
    Before,
    Both,
    Differs,
    Either,
    Forever,
    Goal,
    HeldFor,
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
    Window,
    saved_expressions,
)
from tachk.syntax import ast

FRESH = -1
"""The clock that a step sets to 0, before it has a number."""

Lasting = Sometime | Throughout | Recurring | NeverRising


@dataclass(frozen=True, slots=True)
class Task:
    """Something to be shown from now on.

    Attributes:
        phase: ``ahead`` of the window; ``on`` inside it; ``gap``: an answer is awaited; ``low``: what must not become
            true is false.
        clocks: the time since the task began; in a gap also the time since the gap began.
    """

    goal: Lasting
    phase: str
    clocks: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Settling:
    """Conditions claimed of an instant: they have to hold until the clock, 0 then, is positive."""

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


Item = Task | Settling | Seen
State = frozenset[Item]

SHOWN: State = frozenset()
"""Nothing is left to be shown: the formula is violated."""


@dataclass(frozen=True, slots=True)
class ClockGuard:
    """``clock operator value``"""

    clock: int
    operator: str
    value: int


@dataclass(frozen=True, slots=True)
class Step:
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


@dataclass(frozen=True, slots=True)
class Branch:
    """One way to reach a goal at an instant: what holds there, what was before, what is to follow."""

    now: Conjunction = frozenset()
    pasts: frozenset[Past] = frozenset()
    tasks: frozenset[Task] = frozenset()
    forever: tuple[Forever, ...] = ()


class Tableau:
    """The steps of an observer.

    Args:
        saved: a variable for each expression whose changes matter.
    """

    def __init__(self, goal: Goal, span: Span, saved: dict[ast.Expression, str]) -> None:
        self.span = span
        self.saved = saved
        goal = _looking_back(goal)
        self.branches = self.expand(goal)
        first = [branch for branch in self.expand(goal, at_start=True) if all(map(_initially, branch.pasts))]
        self.initial = [self._begun(branch) for branch in first]
        """The states that the run may begin in, each with the condition that has to hold then."""
        ever = [state for state, _ in self.initial if _waits_for_ever(state)]
        self.idle: State | None = None
        """Where the observer goes when what it was following comes to nothing; None: there it gives up."""
        if ever:
            self.idle = frozenset(item for item in ever[0] if isinstance(item, Task))

    def _begun(self, branch: Branch) -> tuple[State, Conjunction]:
        wanted = _wanted(branch.tasks)
        pasts = [Seen(past, "initial") for past in wanted if _initially(past)]
        claims = self._settling(branch.now, FRESH)
        if not branch.tasks and not claims:
            return SHOWN, frozenset()
        return _numbered(frozenset((*branch.tasks, *claims, *pasts)))[0], branch.now

    # ---- goals at an instant ----------------------------------------------------------------------------------------

    def expand(self, goal: Goal, at_start: bool = False) -> list[Branch]:
        """The ways to reach a goal at an instant, or when the run begins. Raises NoObserver if one never ends."""
        branches = []
        for branch in self._expand(goal, at_start):
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

    def _expand(self, goal: Goal, at_start: bool) -> list[Branch]:
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
                return [Branch(frozenset((self.comparison(expression, equal),)))]
            case Either(parts=parts):
                return [branch for part in parts for branch in self._expand(part, at_start)]
            case Both(parts=parts):
                return [_joined(chosen) for chosen in product(*(self._expand(part, at_start) for part in parts))]
            case Forever():
                return [Branch(forever=(goal,))]
            case Sometime(window=window):
                later = Branch(tasks=frozenset((Task(goal, "on", () if window.is_ever else (FRESH,)),)))
                if at_start and window.low == 0 and window.low_closed and saved_expressions(goal.goal):
                    return [later, *self._expand(goal.goal, at_start)]
                return [later]
            case Throughout(window=window) | Recurring(window=window):
                return [Branch(tasks=frozenset((Task(goal, "ahead" if window.low else "on", (FRESH,)),)))]
            case NeverRising(condition=condition, initially=initially):
                high = Branch(pasts=frozenset((Before(condition, initially),)))
                return [
                    Branch(tasks=frozenset((Task(goal, "low", (FRESH,)),))),
                    replace(high, tasks=frozenset((Task(goal, "on", (FRESH,)),))),
                ]

    def comparison(self, expression: ast.Expression, equal: bool) -> ast.Expression:
        span = expression.span
        name = ast.NameExpression(span, self.saved[expression])
        return ast.BinaryExpression(span, "==" if equal else "!=", expression, name)

    # ---- what a state requires --------------------------------------------------------------------------------------

    def requirement(self, state: State) -> Conjunction:
        """What must hold while time passes."""
        return conjunction(part for item in state for part in self._requirement(item))

    def _requirement(self, item: Item) -> Iterator[ast.Expression]:
        match item:
            case Settling(conditions=conditions):
                yield from conditions
            case Task(goal=Sometime(meanwhile=meanwhile)):
                yield meanwhile
            case Task(phase="ahead" | "gap"):
                pass
            case Task(goal=Throughout(condition=condition)):
                yield condition
            case Task(goal=Recurring(condition=condition, answer=answer)):
                yield _or(condition, answer)
            case Task(goal=NeverRising(condition=condition), phase=phase):
                yield condition if phase == "on" else negated(condition)
            case Seen(past=Before(condition=condition) | HeldFor(condition=condition)):
                yield condition
            case Seen(past=Was(since=since, there=there), phase=phase):
                yield there if phase == "on" else since
            case Seen(past=Saved(expression=expression)):
                yield self.comparison(expression, True)

    def deadlines(self, state: State) -> dict[tuple[int, int], State | None]:
        """Pairs (clock, value): when a clock has reached its value, the state is of no more use than the one that the
        pair leads to; None: than giving up."""
        found: dict[tuple[int, int], State | None] = {}
        for item in state:
            match item:
                case Task(goal=Sometime(window=Window(high=int(high))), clocks=(clock,)):
                    found[clock, high] = None
                case Task(goal=goal, phase="ahead", clocks=(clock, *_)):
                    found[clock, goal.window.low] = None
                case Task(goal=Recurring(length=length), phase="gap", clocks=(_, clock)):
                    found[clock, length] = None
                case Seen(past=Was(length=int(length)), phase="since", clocks=(clock,)):
                    found.setdefault((clock, length), state - {item})
                case _:
                    pass
        return found

    # ---- steps ------------------------------------------------------------------------------------------------------

    def steps(self, state: State) -> Iterator[Step]:
        """The steps that lead on from a state."""
        for item in _ordered(state):
            if isinstance(item, Task):
                yield from self._task_steps(state, item)
        yield from self._settled(state)
        yield from self._past_steps(state)

    def _task_steps(self, state: State, task: Task) -> Iterator[Step]:
        match task:
            case Task(goal=Sometime(window=window, goal=goal)):
                guards = _inside(window, task.clocks)
                for branch in self.expand(goal):
                    for ready in self._ready(state, branch.pasts):
                        yield from self._step(state, task, branch.tasks, branch.now, (*guards, *ready))
            case Task(goal=goal, phase="ahead", clocks=(clock, *_)):
                on = replace(task, phase="on")
                yield from self._step(state, task, (on,), frozenset(), (ClockGuard(clock, "==", goal.window.low),))
            case Task(goal=Recurring(window=window, answer=answer, length=length, closed=closed), phase="gap"):
                window_clock, gap = task.clocks
                in_time = ClockGuard(gap, "<=" if closed else "<", length)
                on = Task(task.goal, "on", (window_clock,))
                now = conjunction((answer,))
                yield from self._step(state, task, (on,), now, (in_time, _still(window, window_clock)))
                yield from self._step(state, task, (), now, (in_time, _over(window, window_clock)))
            case Task(goal=Throughout() | Recurring() | NeverRising() as goal, clocks=(clock, *_)):
                yield from self._step(state, task, (), frozenset(), (_over(goal.window, clock),))
                if isinstance(goal, Recurring):
                    open_ = conjunction((negated(_or(goal.condition, goal.answer)),))
                    gap_task = Task(goal, "gap", (clock, FRESH))
                    yield from self._step(
                        state, task, (gap_task,), frozenset(), (_still(goal.window, clock),), guard=open_
                    )
                if isinstance(goal, NeverRising) and task.phase == "on":
                    low = replace(task, phase="low")
                    yield from self._step(
                        state, task, (low,), frozenset(), (), guard=conjunction((negated(goal.condition),))
                    )

    def _ready(self, state: State, pasts: Iterable[Past]) -> Iterator[tuple[ClockGuard, ...]]:
        """What clocks must say for all pasts to be there; nothing if one is not being watched."""
        seen = {item.past: item for item in state if isinstance(item, Seen)}
        if all(past in seen for past in pasts):
            guards = [_readiness(seen[past]) for past in pasts]
            if None not in guards:
                yield tuple(guard for found in guards for guard in found or ())

    def _step(
        self,
        state: State,
        done: Task,
        tasks: Collection[Task],
        now: Conjunction,
        clocks: tuple[ClockGuard, ...],
        guard: Conjunction = frozenset(),
    ) -> Iterator[Step]:
        """A step with a task exchanged for others. Claims of the same instant stay open, older ones are settled."""
        others = [item for item in state if isinstance(item, Task) and item != done]
        after = frozenset((*others, *tasks))
        pasts = [item for item in state if isinstance(item, Seen) and item.past in _wanted(after)]
        new = [part for task in tasks if not _may_pass(task) for part in self._requirement(task)]
        condition = conjunction((*guard, *now, *new))
        open_ = next((item for item in state if isinstance(item, Settling)), None)
        stuck = is_false(self.requirement(state))
        if open_ is None or not stuck:
            yield from self._made(state, (*after, *pasts, *self._settling(now, FRESH)), clocks, condition, open_)
        # A window that is over stays over, so that what is claimed may be settled first.
        ends = not tasks and not now
        if open_ is not None and not ends and not any(_implies_positive(clock, open_.clock) for clock in clocks):
            kept = self._settling(open_.conditions | now, FRESH if now else open_.clock)
            condition = conjunction((*condition, *open_.conditions))
            yield from self._made(state, (*after, *pasts, *kept), clocks, condition, None)

    def _made(
        self,
        state: State,
        items: Iterable[Item],
        clocks: tuple[ClockGuard, ...],
        condition: Conjunction,
        settled: Settling | None,
    ) -> Iterator[Step]:
        if is_false(condition):
            return
        if settled is not None and not any(_implies_positive(clock, settled.clock) for clock in clocks):
            clocks = (*clocks, ClockGuard(settled.clock, ">", 0))
        target, reset = _numbered(frozenset(items))
        if not any(isinstance(item, Task | Settling) for item in target):
            target = SHOWN
        yield Step(state, target, clocks, condition, reset, forced=self._may_force(state, target, clocks))

    def _may_force(self, state: State, target: State, clocks: tuple[ClockGuard, ...]) -> bool:
        """Whether nothing is lost if this step is taken as soon as it can be: idle, the observer waits for conditions
        that then have to last for a given time, and has no other choice."""
        return (
            state == self.idle
            and not clocks
            and len(self.branches) == 1
            and len(_first_goals(self, state)) == 1
            and all(
                isinstance(item, Settling) or (isinstance(item, Task) and isinstance(item.goal, Throughout))
                for item in target
            )
            and not any(isinstance(item, Task) and item.phase == "ahead" for item in target)
        )

    def _settling(self, conditions: Conjunction, clock: int) -> tuple[Settling, ...]:
        return (Settling(conditions, clock),) if conditions else ()

    def _settled(self, state: State) -> Iterator[Step]:
        """What was claimed of an instant has lasted; a step that waits until it fails, unless nothing else is left."""
        claim = next((item for item in state if isinstance(item, Settling)), None)
        if claim is None or is_false(self.requirement(state)):
            return
        rest = state - {claim}
        if not any(isinstance(item, Task) for item in rest):
            yield Step(state, SHOWN, (ClockGuard(claim.clock, ">", 0),))
        elif not claim.conditions <= self.requirement(rest):
            ending = conjunction((negated(all_of(claim.conditions, self.span)),))
            if not self._is_goal(rest, ending):
                yield from self._made(state, rest, (), ending, claim)

    def _is_goal(self, state: State, condition: Conjunction) -> bool:
        """Whether all that is left is to see the condition once from now on: then there is no better moment."""
        match [item for item in state if isinstance(item, Task)]:
            case [Task(goal=Sometime(window=window, goal=Holds() as goal))]:
                return window.low == 0 and window.low_closed and conjunction((goal.condition,)) <= condition
            case _:
                return False

    def _past_steps(self, state: State) -> Iterator[Step]:
        """Pasts begin to be watched as soon as they can be, for an earlier beginning is never worse; and are given up
        when what has to last does not."""
        watched = {item.past: item for item in state if isinstance(item, Seen)}
        claim = next((item for item in state if isinstance(item, Settling)), None)
        for past in sorted(_wanted(item for item in state if isinstance(item, Task)), key=repr):
            item = watched.get(past)
            if item is None:
                yield from self._begin(state, past, claim)
                continue
            without = state - {item}
            required = self._requirement(item)
            fails = conjunction((negated(all_of(required, self.span)),))
            if isinstance(past, Was) and item.phase == "on":
                follow = Seen(past, "since", (FRESH,) if past.length is not None else ())
                over = conjunction((past.since, negated(past.there)))
                yield from self._past_step(state, without | {follow}, over, (ClockGuard(item.clocks[0], ">", 0),))
            if isinstance(past, Was) and item.phase == "since":
                again = Seen(past, "on", (FRESH,))
                found = conjunction((past.there,))
                yield from self._past_step(state, without | {again}, found, (), forced=True)
            if not is_false(fails):
                yield from self._past_step(state, without, fails, ())

    def _begin(self, state: State, past: Past, claim: Settling | None) -> Iterator[Step]:
        if isinstance(past, HeldFor) and past.length is None:
            return
        item = Seen(past, "on", (FRESH,))
        if not isinstance(past, Saved):
            condition = conjunction(self._requirement(item))
            yield from self._past_step(state, state | {item}, condition, (), forced=True)
            return
        clocks: tuple[ClockGuard, ...] = ()
        if claim is not None:
            state_after, clocks = state - {claim} | {item}, (ClockGuard(claim.clock, ">", 0),)
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
    ) -> Iterator[Step]:
        if is_false(condition):
            return
        target, reset = _numbered(items)
        yield Step(state, target, clocks, condition, reset, forced)


# ---- small questions ------------------------------------------------------------------------------------------------


def _looking_back(goal: Goal) -> Goal:
    """``F(p && F[0,b] g)`` says the same as ``F(g && O[0,b] p)``, whose observer has nothing to guess."""
    match goal:
        case Sometime(window=window, meanwhile=meanwhile, goal=Both(parts=(Holds(condition=condition), later))) if (
            window.is_ever
            and isinstance(later, Sometime)
            and later.window.low == 0
            and later.window.low_closed
            and later.meanwhile == meanwhile == truth(True, meanwhile.span)
        ):
            first = _and(Holds(condition), later.goal)
            return replace(
                goal,
                goal=Either((first, Both((later.goal, Preceded(Was(meanwhile, condition, later.window.high)))))),
            )
        case _:
            return goal


def _and(one: Holds, other: Goal) -> Goal:
    if isinstance(other, Holds):
        return Holds(all_of((one.condition, other.condition), one.condition.span))
    return Both((one, other))


def _or(one: ast.Expression, other: ast.Expression) -> ast.Expression:
    if isinstance(one, ast.BooleanLiteral):
        return one if one.value else other
    return ast.BinaryExpression(one.span, "||", one, other)


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
    return any(
        isinstance(task.goal, Sometime) and isinstance(task.goal.goal, Holds) and opposite <= _now(task.goal.goal)
        for task in branch.tasks
    )


def _now(goal: Holds) -> Conjunction:
    return conjunction((goal.condition,))


def _may_pass(task: Task) -> bool:
    """Whether the task may be exchanged for others at the instant at which it begins, whatever it requires."""
    return isinstance(task.goal, Sometime) or (isinstance(task.goal, Recurring) and task.phase == "on")


def _initially(past: Past) -> bool:
    """Whether the past is there when the run begins. Values are not saved by then; `Tableau.expand` sees to them."""
    return isinstance(past, HeldFor) or (isinstance(past, Before) and past.initially)


def _waits_for_ever(state: State) -> bool:
    tasks = [item for item in state if isinstance(item, Task)]
    return (
        len(tasks) == 1
        and not any(isinstance(item, Settling) for item in state)
        and isinstance(tasks[0].goal, Sometime)
        and tasks[0].goal.window.is_ever
        and tasks[0].goal.meanwhile == truth(True, tasks[0].goal.meanwhile.span)
    )


def _first_goals(tableau: Tableau, state: State) -> list[Branch]:
    goals = [item.goal.goal for item in state if isinstance(item, Task) and isinstance(item.goal, Sometime)]
    return [branch for goal in goals for branch in tableau.expand(goal)]


def _wanted(tasks: Iterable[Item]) -> frozenset[Past]:
    """The pasts that some goal ahead asks for."""
    found: set[Past] = set()
    pending: list[Goal] = [
        task.goal.goal for task in tasks if isinstance(task, Task) and isinstance(task.goal, Sometime)
    ]
    while pending:
        goal = pending.pop()
        match goal:
            case Preceded(past=past):
                found.add(past)
            case NeverRising(condition=condition, initially=initially):
                found.add(Before(condition, initially))
            case Both(parts=parts) | Either(parts=parts):
                pending += parts
            case Sometime(goal=inner):
                pending.append(inner)
            case _:
                pass
    return frozenset(found)


def _readiness(item: Seen) -> tuple[ClockGuard, ...] | None:
    """What the clock must say for the past to count."""
    match item:
        case Seen(phase="initial"):
            return ()
        case Seen(past=HeldFor(length=int(length)), clocks=(clock,)):
            return (ClockGuard(clock, ">=", length),)
        case Seen(past=Was(length=int(length)), phase="since", clocks=(clock,)):
            return (ClockGuard(clock, "<", length),)
        case Seen(past=Was(), phase="since"):
            return ()
        case Seen(clocks=(clock,)):
            return (ClockGuard(clock, ">", 0),)
        case _:
            return None


def _inside(window: Window, clocks: tuple[int, ...]) -> tuple[ClockGuard, ...]:
    if not clocks:
        return ()
    found = []
    if window.low > 0 or not window.low_closed:
        found.append(ClockGuard(clocks[0], ">=" if window.low_closed else ">", window.low))
    if window.high is not None:
        found.append(ClockGuard(clocks[0], "<=" if window.high_closed else "<", window.high))
    return tuple(found)


def _still(window: Window, clock: int) -> ClockGuard:
    """The window is not over: another instant of it is to come or is now."""
    assert window.high is not None
    return ClockGuard(clock, "<=" if window.high_closed else "<", window.high)


def _over(window: Window, clock: int) -> ClockGuard:
    assert window.high is not None
    return ClockGuard(clock, ">" if window.high_closed else ">=", window.high)


def _implies_positive(guard: ClockGuard, clock: int) -> bool:
    return guard.clock == clock and (guard.operator == ">" or (guard.operator in (">=", "==") and guard.value > 0))


def _numbered(items: frozenset[Item]) -> tuple[State, int | None]:
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


def _ordered(state: State) -> list[Item]:
    return sorted(state, key=repr)
