"""Strategies for the least and the largest values of expressions: ``sup``, ``inf`` and ``bounds``.

Values are taken over the reachable states that satisfy a restriction. Integers are measured in one exploration, all
together. So is a clock, with clock bounds that keep its values apart up to a time bound
(`tachk.engine.compiler.lower.MeasuredExpression`): an extreme value up to there is the true one. Where the clock is
found beyond, the time bound is doubled, unless the path that was found shows that the clock grows without limit. An
expression that is neither an integer nor a clock, or whose restriction contains `deadlock`, is bisected: each search
decides if the value can be beyond a number.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from tachk.analysis.fold import fold_place, known_slot, known_values
from tachk.base.job import unhurried
from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass, field, replace
from tachk.base.words import QueryKind
from tachk.engine.compiler.lower import MeasuredExpression, lower, lower_measures
from tachk.engine.exact.concretise import concretise
from tachk.engine.growth import grows_without_limit
from tachk.engine.measuring import measure
from tachk.engine.outcome import Outcome, Statistics, Status
from tachk.engine.zone import explore
from tachk.meaning.discrete import prepare
from tachk.model.expressions import BOOL, Binary, Constant, Expression
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.run import RunTimeFault, Transition
from tachk.model.traversal import asks_deadlock, reads_clock
from tachk.model.types import ClockType
from tachk.transform.transformation import Transformation
from tachk.verify.fault_explanation import explain
from tachk.verify.over_approximations import reduced_for
from tachk.verify.reachability import witness
from tachk.verify.strategy import Findings, Problem
from tachk.verify.unexamined import unexamined
from tachk.verify.verdict import Answer, Extreme, Extremes, Verdict

NEVER = "no reachable state satisfies the restriction, so that there is no value"

DOUBLINGS = 12
"""The number of times that the time bound is doubled, from the largest constant of the model on."""

LARGEST_BOUND = 2**29

INEXACT = "the stopwatches make the search inexact, and the value it found is not confirmed"


def measured(problem: Problem) -> Findings:
    """Measures integers, in one exploration."""
    return _by(ExtremeSearch.measure_numbers, problem)


def time_bound(problem: Problem) -> Findings:
    """Measures clocks, each in explorations up to a time bound."""
    return _by(ExtremeSearch.measure_clocks, problem)


def bisection(problem: Problem) -> Findings:
    """Finds values of any kind by bisection."""
    return _by(ExtremeSearch.bisect, problem)


def _by(way: Way, problem: Problem) -> Findings:
    verdicts, partial = {}, {}
    for task in problem.tasks:
        search = problem.partial.get(task.number) or begun(problem, task.query)
        verdict = _after(search, way)
        if verdict is None:
            partial[task.number] = search
        else:
            verdicts[task.number] = verdict
    return Findings(verdicts, partial=partial)


def _after(search: ExtremeSearch, way: Way) -> Verdict | None:
    """The verdict HOLDS with the values once all are known, or FAILS where there are none; None while some are open."""
    search.ways.append(way)
    verdict = Verdict(search.query, Answer.UNKNOWN, True, "", Statistics())
    try:
        way(search)
    except UndecidedExtremeError as error:
        fault = None if error.fault is None else explain(prepare(search.network), error.fault)
        with unhurried():
            fault = None if fault is None else search.reduced.lift_fault(fault)
        exact = error.reason != INEXACT
        return replace(verdict, reason=error.reason, exact=exact, fault=fault, statistics=search.statistics)
    if search.open and not search.empty:
        return None
    with unhurried():
        left_out = unexamined(search.problem.network, search.network)
    verdict = replace(verdict, statistics=search.statistics, unexamined=left_out)
    if search.empty:
        return replace(verdict, answer=Answer.FAILS, notes=(NEVER,))
    return _with_values(search, verdict)


def _with_values(search: ExtremeSearch, verdict: Verdict) -> Verdict | None:
    extremes = []
    for expression, largest in search.questions:
        value, run = search.found[expression, largest], None
        if value.value is not None and not value.strict and (search.problem.trace or not search.exact):
            target, what = _where_it_is(search.where, expression, value.value), f"the value {value.value}"
            run, possible = witness(search.reduced, value.path, target, search.exact, what)
            if not possible:
                problem = search.problem
                again = begun(replace(problem, options=problem.options.off("cone")), search.query)
                return [_after(again, way) for way in search.ways][-1]
        if not search.exact and run is None:
            return replace(verdict, reason=INEXACT, exact=False)
        extremes.append(Extreme(value.value, value.strict, run))
    shown = next((extreme.run for extreme in extremes if extreme.run is not None), None)
    return replace(verdict, answer=Answer.HOLDS, trace=shown, extremes=_by_expression(search.query, extremes))


def _directions(query: Query) -> tuple[bool, ...]:
    """The directions of a query: True for the largest values, False for the least ones; both for `bounds`."""
    if query.kind is QueryKind.BOUNDS:
        return False, True
    return (query.kind is QueryKind.SUPREMUM,)


def _by_expression(query: Query, extremes: Sequence[Extreme]) -> tuple[Extremes, ...]:
    texts = [" ".join(operand.span.text.split()) for operand in query.operands]
    count = len(_directions(query))
    found = []
    for number, text in enumerate(texts):
        sides = dict(zip(_directions(query), extremes[count * number :], strict=False))
        found.append(Extremes(text, sides.get(False), sides.get(True)))
    return tuple(found)


@dataclass(frozen=True, slots=True)
class FoundExtreme:
    """An extreme value.

    Attributes:
        value: None where there is no limit.
        strict: it is approached and not taken.
        path: to a state with this value; without it where nothing is known of one.
    """

    value: int | None
    strict: bool
    path: tuple[Transition, ...] = ()


class UndecidedExtremeError(Exception):
    """Attributes:
    reason: why the value is not known.
    fault: the run-time error that ended the search, if one did.
    """

    def __init__(self, reason: str, fault: RunTimeFault | None = None) -> None:
        self.reason = reason
        self.fault = fault
        super().__init__(reason)


Question = tuple[Expression, bool]
"""An expression, and whether the query is about its largest value rather than the least."""


Way = Callable[["ExtremeSearch"], None]
"""A method that looks for values that are open."""


@dataclass(slots=True)
class ExtremeSearch:
    """Searches for the values that a query asks for, and what they have found so far.

    Attributes:
        where: the states that count.
        reduced: the network that is searched, with the way back.
        statistics: of all searches.
        exact: no search has over-approximated.
        found: the values that are known.
        empty: no state counts.
        ways: the methods of this class that have been called.
    """

    problem: Problem
    query: Query
    where: Expression
    reduced: Transformation
    statistics: Statistics = field(default_factory=Statistics)
    exact: bool = True
    found: dict[Question, FoundExtreme] = field(default_factory=dict)
    empty: bool = False
    ways: list[Way] = field(default_factory=list)

    @property
    def network(self) -> Network:
        return self.reduced.network

    @property
    def questions(self) -> list[Question]:
        """In the order of the query."""
        return [(expression, largest) for expression in self.query.operands for largest in _directions(self.query)]

    @property
    def open(self) -> list[Question]:
        return [question for question in self.questions if question not in self.found]

    def measure_numbers(self) -> None:
        """Measures the integers, all together. Raises UndecidedExtremeError, as the other ways do."""
        numbers = [question for question in self.open if self._is_number(question[0])]
        if not numbers:
            return
        measures = [MeasuredExpression(self.where, expression, largest) for expression, largest in numbers]
        program, _, lowered = lower_measures(self.network, measures)
        outcome, found = measure(program, (), lowered, self.problem.options, self.problem.limits)
        self._note(outcome)
        if outcome.reason:
            raise UndecidedExtremeError(outcome.reason, outcome.fault)
        for question, each in zip(numbers, found, strict=True):
            self._found(question, None if each is None else FoundExtreme(each.value, False, each.path))

    def measure_clocks(self) -> None:
        for question in self.open:
            if not self.empty and self._is_clock(question[0]):
                self._found(question, self._clock(*question))

    def bisect(self) -> None:
        for question in self.open:
            if not self.empty:
                self._found(question, self._by_bisection(*question))

    def _found(self, question: Question, value: FoundExtreme | None) -> None:
        if value is None:
            self.empty = True
        else:
            self.found[question] = value

    @property
    def _asks_deadlock(self) -> bool:
        return asks_deadlock(self.where)

    def _is_number(self, expression: Expression) -> bool:
        return not reads_clock(expression) and not self._asks_deadlock

    def _is_clock(self, expression: Expression) -> bool:
        return self._is_plain(expression) and not self._asks_deadlock

    def _is_plain(self, expression: Expression) -> bool:
        """True if it is a clock, the same one in all states."""
        if not isinstance(expression.type, ClockType):
            return False
        return known_slot(fold_place(expression, known_values(self.network, [self.where]))) is not None

    def _clock(self, clock: Expression, largest: bool) -> FoundExtreme | None:
        for bound in self._time_bounds():
            measured = MeasuredExpression(self.where, clock, largest, bound)
            program, goals, measures = lower_measures(self.network, [measured])
            outcome, (found,) = measure(program, goals, measures, self.problem.options, self.problem.limits)
            self._note(outcome)
            if largest and outcome.goals[0].status is Status.REACHED:
                path = outcome.goals[0].path or ()
                if outcome.exact and grows_without_limit(self.network, path, self.where, clock):
                    return FoundExtreme(None, False)
                continue
            if outcome.reason:
                raise UndecidedExtremeError(outcome.reason, outcome.fault)
            if found is None:
                return None
            assert found.value is not None
            if largest or found.value < bound:
                return FoundExtreme(found.value, found.strict, found.path)
        raise UndecidedExtremeError(
            "the value is beyond the largest time bound, and no loop that lets it grow was found"
        )

    def _time_bounds(self) -> list[int]:
        program, _ = lower(self.network, [self.where])
        first = max(1, *program.maximum_constants)
        return [first << n for n in range(DOUBLINGS + 1) if first << n <= LARGEST_BOUND]

    def _by_bisection(self, expression: Expression, largest: bool) -> FoundExtreme | None:
        """Thresholds are numbered: 2c + 1 asks for a value of at least c, 2c + 2 for one beyond c; for the least value
        of an expression, of its negative. All constants are integers, and so is what is approached."""
        paths: dict[int, tuple[Transition, ...]] = {}

        def reaches(threshold: int) -> bool:
            if threshold not in paths:
                path = self._path_to(_beyond(expression, threshold, largest))
                if path is None:
                    return False
                paths[threshold] = path
            return True

        if self._path_to(None) is None:
            return None
        time_bounds = [2 * bound + 1 for bound in self._time_bounds()]
        met: int | None = 1
        missed: int | None = 1
        if reaches(1):
            missed = self._first_missed(expression, largest, reaches, time_bounds, paths)
        else:
            met = next((-threshold for threshold in time_bounds if reaches(-threshold)), None)
        if missed is None:
            return FoundExtreme(None, False)
        if met is None:
            raise UndecidedExtremeError("the value is beyond the largest time bound")
        while missed - met > 1:
            middle = (met + missed) // 2
            if reaches(middle):
                met = middle
            else:
                missed = middle
        sign = 1 if largest else -1
        return FoundExtreme(sign * (met // 2), met % 2 == 0, paths[met])

    def _first_missed(
        self,
        expression: Expression,
        largest: bool,
        reaches: Callable[[int], bool],
        thresholds: Sequence[int],
        paths: dict[int, tuple[Transition, ...]],
    ) -> int | None:
        """A threshold that is not reached; None if all are."""
        for threshold in thresholds:
            if not reaches(threshold):
                return threshold
            clocks = _growing(expression, largest)
            if self.exact and clocks is not None and all(map(self._is_plain, clocks)):
                if grows_without_limit(self.network, paths[threshold], self.where, *clocks):
                    return None
        raise UndecidedExtremeError(
            "the value is beyond the largest time bound, and no loop that lets it grow was found"
        )

    def _path_to(self, condition: Expression | None) -> tuple[Transition, ...] | None:
        target = self.where if condition is None else Binary(BinaryOperator.AND, self.where, condition, BOOL)
        program, goals = lower(self.network, [target])
        outcome = explore(program, goals, self.problem.options, self.problem.limits)
        self._note(outcome)
        (goal,) = outcome.goals
        if goal.status is Status.UNDECIDED:
            raise UndecidedExtremeError(outcome.reason, outcome.fault)
        if goal.path is not None and not outcome.exact and concretise(prepare(self.network), goal.path, target) is None:
            raise UndecidedExtremeError(INEXACT)
        return None if goal.path is None else tuple(goal.path)

    def _note(self, outcome: Outcome) -> None:
        self.exact = self.exact and outcome.exact
        self.statistics = self.statistics.then(outcome.statistics)


def _beyond(expression: Expression, threshold: int, largest: bool) -> Expression:
    value, beyond = divmod(threshold - 1, 2)
    if largest:
        operator = BinaryOperator.GREATER if beyond else BinaryOperator.GREATER_EQUAL
        return Binary(operator, expression, Constant(value), BOOL)
    operator = BinaryOperator.LESS if beyond else BinaryOperator.LESS_EQUAL
    return Binary(operator, expression, Constant(-value), BOOL)


def _growing(expression: Expression, largest: bool) -> tuple[Expression, ...] | None:
    """The clock that grows, and the clock that is subtracted if there is one, as the value goes to its largest or least
    end; no clock goes below 0."""
    match expression:
        case Binary(BinaryOperator.SUBTRACT, left, right) if isinstance(left.type, ClockType) and isinstance(
            right.type, ClockType
        ):
            return (left, right) if largest else (right, left)
        case _ if isinstance(expression.type, ClockType) and largest:
            return (expression,)
        case _:
            return None


def begun(problem: Problem, query: Query) -> ExtremeSearch:
    """A search in the cone of influence of all expressions of the queries."""
    where = restriction(query)
    targets = [_where_it_is(where, expression, 0) for expression in query.operands]
    return ExtremeSearch(problem, query, where, reduced_for(problem.network, targets, problem.options))


def restriction(query: Query) -> Expression:
    """The states over which the values are taken."""
    return Constant(1, BOOL) if query.predicate is None else query.predicate


def _where_it_is(where: Expression, expression: Expression, value: int) -> Expression:
    return Binary(BinaryOperator.AND, where, Binary(BinaryOperator.EQUAL, expression, Constant(value), BOOL), BOOL)
