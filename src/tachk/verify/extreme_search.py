"""The least and the largest values of expressions over the reachable states that satisfy a predicate.

Integers are measured in one exploration, all together. So is a clock, with clock bounds that keep its values apart up
to a horizon (`tachk.engine.compiler.lower.MeasuredExpression`): an extreme value up to there is the true one. Where the
clock is found beyond, the horizon is doubled, unless the path that was found shows that the clock grows without limit.
What is neither a number nor a clock, and what is asked for where there is a deadlock, is found by bisection, with one
search for each question whether it can be beyond a number.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import field

from tachk.analysis.fold import fold_place, known_cell, known_values
from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass
from tachk.engine.compiler.lower import MeasuredExpression, lower, lower_measures
from tachk.engine.exact.concretise import concretise
from tachk.engine.growth import grows_without_limit
from tachk.engine.measuring import measure
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import Outcome, Statistics, Status
from tachk.engine.zone import explore
from tachk.meaning.discrete import PreparedNetwork
from tachk.model.expressions import BOOL, Binary, Constant, Expression
from tachk.model.network import Network
from tachk.model.run import RunTimeFault, Transition
from tachk.model.traversal import asks_deadlock, reads_clock
from tachk.model.types import ClockType

DOUBLINGS = 12
"""How often the horizon is doubled, from the largest constant of the model on."""

LARGEST_HORIZON = 2**29

INEXACT = "the stopwatches make the search inexact, and the value it found is not confirmed"


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
"""An expression, and whether its largest value is asked for rather than the least."""


@dataclass(slots=True)
class ExtremeSearch:
    """Attributes:
    model: is searched.
    where: the states that count.
    statistics: of all searches so far.
    exact: no search has over-approximated.
    """

    model: PreparedNetwork
    where: Expression
    options: Options
    limits: Limits
    statistics: Statistics = field(default_factory=Statistics)
    exact: bool = True

    def find(self, questions: Sequence[Question]) -> list[FoundExtreme] | None:
        """The answers; None where no state satisfies the predicate. Raises UndecidedExtremeError."""
        found: dict[Question, FoundExtreme] = {}
        numbers = [question for question in questions if self._is_number(question[0])]
        if numbers:
            values = self._numbers(numbers)
            if values is None:
                return None
            found |= zip(numbers, values, strict=True)
        for question in questions:
            if question in found:
                continue
            value = self._clock(*question) if self._is_clock(question[0]) else self._by_bisection(*question)
            if value is None:
                return None
            found[question] = value
        return [found[question] for question in questions]

    @property
    def _network(self) -> Network:
        return self.model.network

    @property
    def _asks_deadlock(self) -> bool:
        return asks_deadlock(self.where)

    def _is_number(self, expression: Expression) -> bool:
        return not reads_clock(expression) and not self._asks_deadlock

    def _is_clock(self, expression: Expression) -> bool:
        return self._is_plain(expression) and not self._asks_deadlock

    def _is_plain(self, expression: Expression) -> bool:
        """Whether it is a clock, the same one in all states."""
        if not isinstance(expression.type, ClockType):
            return False
        return known_cell(fold_place(expression, known_values(self._network, [self.where]))) is not None

    # ---- one exploration --------------------------------------------------------------------------------------------

    def _numbers(self, questions: Sequence[Question]) -> list[FoundExtreme] | None:
        measured = [MeasuredExpression(self.where, expression, largest) for expression, largest in questions]
        program, _, measures = lower_measures(self._network, measured)
        outcome, found = measure(program, (), measures, self.options, self.limits)
        self._note(outcome)
        if outcome.reason:
            raise UndecidedExtremeError(outcome.reason, outcome.fault)
        values = [FoundExtreme(each.value, False, each.path) for each in found if each is not None]
        return values if len(values) == len(questions) else None

    def _clock(self, clock: Expression, largest: bool) -> FoundExtreme | None:
        for horizon in self._horizons():
            measured = MeasuredExpression(self.where, clock, largest, horizon)
            program, goals, measures = lower_measures(self._network, [measured])
            outcome, (found,) = measure(program, goals, measures, self.options, self.limits)
            self._note(outcome)
            if largest and outcome.goals[0].status is Status.REACHED:
                path = outcome.goals[0].path or ()
                if outcome.exact and grows_without_limit(self._network, path, self.where, clock):
                    return FoundExtreme(None, False)
                continue
            if outcome.reason:
                raise UndecidedExtremeError(outcome.reason, outcome.fault)
            if found is None:
                return None
            assert found.value is not None
            if largest or found.value < horizon:
                return FoundExtreme(found.value, found.strict, found.path)
        raise UndecidedExtremeError("the value is beyond the largest horizon, and no loop that lets it grow was found")

    def _horizons(self) -> list[int]:
        program, _ = lower(self._network, [self.where])
        first = max(1, *program.maximum_constants)
        return [first << n for n in range(DOUBLINGS + 1) if first << n <= LARGEST_HORIZON]

    # ---- bisection --------------------------------------------------------------------------------------------------

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
        horizons = [2 * horizon + 1 for horizon in self._horizons()]
        met: int | None = 1
        missed: int | None = 1
        if reaches(1):
            missed = self._first_missed(expression, largest, reaches, horizons, paths)
        else:
            met = next((-threshold for threshold in horizons if reaches(-threshold)), None)
        if missed is None:
            return FoundExtreme(None, False)
        if met is None:
            raise UndecidedExtremeError("the value is beyond the largest horizon")
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
                if grows_without_limit(self._network, paths[threshold], self.where, *clocks):
                    return None
        raise UndecidedExtremeError("the value is beyond the largest horizon, and no loop that lets it grow was found")

    def _path_to(self, condition: Expression | None) -> tuple[Transition, ...] | None:
        target = self.where if condition is None else Binary(BinaryOperator.AND, self.where, condition, BOOL)
        program, goals = lower(self._network, [target])
        outcome = explore(program, goals, self.options, self.limits)
        self._note(outcome)
        (goal,) = outcome.goals
        if goal.status is Status.UNDECIDED:
            raise UndecidedExtremeError(outcome.reason, outcome.fault)
        if goal.path is not None and not outcome.exact and concretise(self.model, goal.path, target) is None:
            raise UndecidedExtremeError(INEXACT)
        return goal.path

    # ---- all searches -----------------------------------------------------------------------------------------------

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
    """What grows, and what is subtracted if anything is, where the value of a clock or of a difference of two goes to
    the asked end; no clock goes below 0."""
    match expression:
        case Binary(BinaryOperator.SUBTRACT, left, right) if isinstance(left.type, ClockType) and isinstance(
            right.type, ClockType
        ):
            return (left, right) if largest else (right, left)
        case _ if isinstance(expression.type, ClockType) and largest:
            return (expression,)
        case _:
            return None
