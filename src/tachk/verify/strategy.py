"""Strategies: the ways to decide queries, and the loop that tries those of a table in their order.

A portfolio, as in Huberman, Lukose, Hogg (An economics approach to hard computational problems, Science 275, 1997), run
one after the other: cheap ways first, each with a budget, and last the one that always answers. The loop
believes a verdict only as far as the strategy can prove it: an over-approximation that does not reach a target proves
that nothing does; a search of some states that reaches none proves nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import Any, assert_never

from tachk.base.diagnostics.diagnostic import InternalError
from tachk.base.job import StoppedError, current_job, limited
from tachk.base.records import dataclass, field, replace
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import INTERRUPTED, STATE_LIMIT, Statistics
from tachk.meaning.discrete import PreparedNetwork
from tachk.model.expressions import Expression, Variable
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.run import Transition
from tachk.transform.observed import ObservedNetwork
from tachk.transform.transformation import Exactness
from tachk.verify.plan import Analysis, Task, analysis_of
from tachk.verify.verdict import Answer, Verdict, answers_of, none_begun

NO_STRATEGY = "none of the strategies that are left decides it"


class DisagreementError(InternalError):
    """Two strategies have contradicted each other: one of them is wrong.

    Attributes:
        options: with which they were run.
        one, other: their verdicts about the same query.
    """

    def __init__(self, options: Options, one: Verdict, other: Verdict) -> None:
        self.options = options
        self.one = one
        self.other = other
        super().__init__(
            f"the strategies contradict each other about {one.query.text!r}: "
            f"{one.strategy} says {one.answer.value}, {other.strategy} says {other.answer.value}"
        )

    @property
    def query(self) -> Query:
        return self.one.query


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
        partial: what decides nothing yet and helps later strategies of the table, by the numbers of the tasks.
    """

    verdicts: Mapping[int, Verdict]
    reached: Mapping[int, ReachedInAbstraction] = field(default_factory=dict)
    partial: Mapping[int, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Problem:
    """Queries that one exploration of a network decides, and what is known about them.

    Attributes:
        model: the network with the observer, if there is one. It is held here, so that it is prepared once.
        observed: how it was made from the network without.
        limits: of each search. The time is that of the job.
        trace: whether runs are to be shown.
        reached, partial: as strategies before have found them, see `Findings`.
    """

    model: PreparedNetwork
    observed: ObservedNetwork
    tasks: tuple[Task, ...]
    options: Options
    limits: Limits
    trace: bool
    reached: Mapping[int, ReachedInAbstraction] = field(default_factory=dict)
    partial: Mapping[int, Any] = field(default_factory=dict)

    @property
    def network(self) -> Network:
        """With the observer."""
        return self.model.network

    @property
    def targets(self) -> list[Expression]:
        return [task.target for task in self.tasks]

    def knowing(self, found: Findings) -> Problem:
        """The problem, with the findings of a strategy."""
        if not found.reached and not found.partial:
            return self
        return replace(self, reached={**self.reached, **found.reached}, partial={**self.partial, **found.partial})

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
        exactness: which of its verdicts can be believed.
        states: how many states each of its searches may store; None: as many as the limits allow.
        share: of the time that is left, so much at most.
        preliminary: a search for few states, which is of no use where the limits allow no more.
        plain: it searches as one expects, so that reports for people do not name it.
        parts: the problem in parts that are searched one after the other.
    """

    name: str
    meaning: str
    run: Callable[[Problem], Findings]
    exactness: Exactness = Exactness.EVERYTHING
    states: int | None = None
    share: float = 1.0
    preliminary: bool = False
    plain: bool = False
    parts: Callable[[Problem], Iterable[Problem]] = as_a_whole


def decided(problem: Problem, strategies: Iterable[Strategy]) -> dict[int, Verdict]:
    """The verdicts about the tasks of a problem, by number: each by the first strategy that decides it.

    Raises DisagreementError where a strategy contradicts one before: what is proved stays proved, whatever is found.
    """
    settled: dict[int, Verdict] = {}
    open_: dict[int, Verdict] = {}
    for strategy in strategies:
        if strategy.name in problem.options.without or not problem.tasks:
            continue
        for part in strategy.parts(problem):
            found = _found(strategy, part)
            problem = problem.knowing(found)
            for number, verdict in found.verdicts.items():
                if _is_final(strategy, verdict):
                    settled[number] = agreed(problem.options, settled.get(number, verdict), verdict)
                elif verdict.answer is Answer.UNKNOWN:
                    open_[number] = verdict
            if any(verdict.reason == INTERRUPTED for verdict in found.verdicts.values()):
                return none_begun(problem.tasks, INTERRUPTED) | settled
        if settled:
            problem = problem.without(settled)
    return none_begun(problem.tasks, NO_STRATEGY) | open_ | settled


def agreed(options: Options, one: Verdict, other: Verdict) -> Verdict:
    """The first of two verdicts about a query that is known. Raises DisagreementError if both are, and differ."""
    if one.answer is Answer.UNKNOWN:
        return other
    if other.answer not in (one.answer, Answer.UNKNOWN):
        raise DisagreementError(options, one, other)
    return one


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
    named = {
        number: verdict
        if verdict.answer is Answer.UNKNOWN
        else replace(verdict, strategy=verdict.strategy or strategy.name)
        for number, verdict in found.verdicts.items()
    }
    return replace(found, verdicts=named)


def _is_final(strategy: Strategy, verdict: Verdict) -> bool:
    """True if nothing else has to be tried for a query."""
    if verdict.reason == INTERRUPTED:
        return True
    if verdict.reason == STATE_LIMIT and strategy.states is not None:
        return False
    return _exactness_needed(verdict) in strategy.exactness


def _exactness_needed(verdict: Verdict) -> Exactness:
    """The exactness that a strategy needs for its verdict to be right."""
    if verdict.answer is Answer.UNKNOWN:
        return Exactness.ERRORS
    found = verdict.answer is answers_of(verdict.query)[0]
    match analysis_of(verdict.query):
        case Analysis.REACHABILITY:
            return Exactness.REACHABLE if found else Exactness.UNREACHABLE
        case Analysis.LIVENESS:
            return Exactness.RUN if found else Exactness.NO_RUN
        case Analysis.EXTREMES:
            # Some state has the value, and none has one beyond; or no state counts.
            return Exactness.SAME_STATES if verdict.answer is Answer.HOLDS else Exactness.UNREACHABLE
        case never:
            assert_never(never)
