"""Strategies: the ways to decide queries, and the loop that tries those of a table in their order.

A portfolio, as in Huberman, Lukose, Hogg (An economics approach to hard computational problems, Science 275, 1997), run
one after the other: cheap ways first, each with a budget, and last the one that always answers. The loop
believes a verdict only as far as the strategy can prove it: an over-approximation that does not reach a target proves
that nothing does; a search of some states that reaches none proves nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import field, replace
from enum import Flag, auto
from typing import Any

from tachk.base.job import StoppedError, current_job, limited
from tachk.base.records import dataclass
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import INTERRUPTED, STATE_LIMIT, Statistics
from tachk.meaning.discrete import PreparedNetwork
from tachk.model.expressions import Expression, Variable
from tachk.model.network import Network
from tachk.model.run import Transition
from tachk.transform.observed import ObservedNetwork
from tachk.verify.plan import Task
from tachk.verify.unanswered import none_begun
from tachk.verify.verdict import Answer, Verdict, answers_of

NO_STRATEGY = "none of the strategies that are left decides it"


class Decides(Flag):
    """The verdicts of a strategy that can be believed."""

    REACHED = auto()
    """A target that it reaches is reachable."""
    UNREACHABLE = auto()
    """A target that it does not reach is unreachable."""
    ERRORS = auto()
    """A run-time error or a limit other than its own budget would end every further search, too."""
    ALL = REACHED | UNREACHABLE | ERRORS


@dataclass(frozen=True, slots=True)
class OverApproximation:
    """A network that can do all that another one can, and targets that are true wherever those about it are.

    Attributes:
        targets, conditions: in their order.
        unexamined: what is left out in it and may meet a run-time error.
        less_known: the variables of which it keeps less.
        spared: monotone counters that need not be followed in it.
        symmetrised: whether the targets are those of all interchangeable processes.
    """

    network: Network
    targets: Sequence[Expression]
    conditions: Sequence[Expression]
    unexamined: tuple[str, ...] = ()
    less_known: tuple[str, ...] = ()
    spared: frozenset[Variable] = frozenset()
    symmetrised: bool = False


@dataclass(frozen=True, slots=True)
class ReachedInAbstraction:
    """A target that is reached in an over-approximation.

    Attributes:
        path: the transitions that lead to it there.
    """

    within: OverApproximation
    path: tuple[Transition, ...]
    statistics: Statistics


@dataclass(frozen=True, slots=True)
class Findings:
    """The result of one strategy for a problem.

    Attributes:
        verdicts: by the numbers of the tasks.
        reached: targets that are reached in an over-approximation, by the numbers of the tasks.
        runs: what `tachk.verify.liveness` has found that decides nothing yet, by the numbers of the tasks.
    """

    verdicts: Mapping[int, Verdict]
    reached: Mapping[int, ReachedInAbstraction] = field(default_factory=dict)
    runs: Mapping[int, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Problem:
    """Queries that one exploration of a network decides, and what is known about them.

    Attributes:
        model: the network with the observer, if there is one. It is held here, so that it is prepared once.
        observed: how it was made from the network without.
        limits: of each search. The time is that of the job.
        trace: whether runs are to be shown.
        reached, runs: as strategies before have found them, see `Findings`.
    """

    model: PreparedNetwork
    observed: ObservedNetwork
    tasks: tuple[Task, ...]
    options: Options
    limits: Limits
    trace: bool
    reached: Mapping[int, ReachedInAbstraction] = field(default_factory=dict)
    runs: Mapping[int, Any] = field(default_factory=dict)

    @property
    def network(self) -> Network:
        """With the observer."""
        return self.model.network

    @property
    def targets(self) -> list[Expression]:
        return [task.target for task in self.tasks]

    def about(self, numbers: Collection[int]) -> Problem:
        """The problem with the tasks of these numbers."""
        return replace(self, tasks=tuple(task for task in self.tasks if task.number in numbers))

    def without(self, numbers: Collection[int]) -> Problem:
        """The problem with the tasks of other numbers."""
        return replace(self, tasks=tuple(task for task in self.tasks if task.number not in numbers))


def as_a_whole(problem: Problem) -> Iterable[Problem]:
    return (problem,)


@dataclass(frozen=True, slots=True)
class Strategy:
    """A row of a table: one way to decide some queries.

    Attributes:
        name: one word, for reports and for `--without`.
        meaning: what it does, in a sentence.
        run: looks for the verdicts about the tasks of a problem; it may leave out some or all of them.
        decides: what its verdicts are worth.
        states: how many states each of its searches may store; None: as many as the limits allow.
        share: of the time that is left, so much at most.
        preliminary: a search for few states, which is of no use where the limits allow no more.
        plain: it searches as one expects, so that reports for people do not name it.
        parts: the problem in parts that are searched one after the other.
    """

    name: str
    meaning: str
    run: Callable[[Problem], Findings]
    decides: Decides = Decides.ALL
    states: int | None = None
    share: float = 1.0
    preliminary: bool = False
    plain: bool = False
    parts: Callable[[Problem], Iterable[Problem]] = as_a_whole


def decided(problem: Problem, strategies: Iterable[Strategy]) -> dict[int, Verdict]:
    """The verdicts about the tasks of a problem, by number: each by the first strategy that decides it."""
    settled: dict[int, Verdict] = {}
    open_: dict[int, Verdict] = {}
    for strategy in strategies:
        if strategy.name in problem.options.without or not problem.tasks:
            continue
        for part in strategy.parts(problem):
            found = _found(strategy, part)
            problem = replace(
                problem, reached={**problem.reached, **found.reached}, runs={**problem.runs, **found.runs}
            )
            open_ |= {number: v for number, v in found.verdicts.items() if v.answer is Answer.UNKNOWN}
            settled |= {number: verdict for number, verdict in found.verdicts.items() if _counts(strategy, verdict)}
            if any(verdict.reason == INTERRUPTED for verdict in found.verdicts.values()):
                return none_begun(problem.tasks, INTERRUPTED) | settled
        problem = problem.without(settled)
    return none_begun(problem.tasks, NO_STRATEGY) | open_ | settled


def _found(strategy: Strategy, problem: Problem) -> Findings:
    """The result of the strategy, with its budget."""
    limits = problem.limits
    if strategy.states is not None:
        if strategy.preliminary and limits.states is not None and limits.states <= strategy.states:
            return Findings({})
        problem = replace(problem, limits=limits.of_states(strategy.states))
    left = current_job().seconds_left
    try:
        with limited(None if left is None or strategy.share == 1.0 else left * strategy.share):
            found = strategy.run(problem)
    except StoppedError as stopped:
        found = Findings(none_begun(problem.tasks, stopped.reason))
    named = {number: replace(verdict, strategy=strategy.name) for number, verdict in found.verdicts.items()}
    return replace(found, verdicts=named)


def _counts(strategy: Strategy, verdict: Verdict) -> bool:
    """Whether the verdict is final."""
    if verdict.reason == INTERRUPTED:
        return True
    if verdict.answer is Answer.UNKNOWN:
        return Decides.ERRORS in strategy.decides and (strategy.states is None or verdict.reason != STATE_LIMIT)
    reached, _ = answers_of(verdict.query)
    return (Decides.REACHED if verdict.answer is reached else Decides.UNREACHABLE) in strategy.decides
