"""The answer to one query, with its evidence; and those about queries that no search has looked into."""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum
from fractions import Fraction
from typing import TYPE_CHECKING

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.job import unhurried
from tachk.base.records import dataclass, field, replace
from tachk.base.words import QueryKind
from tachk.engine.outcome import Statistics
from tachk.model.query import Expectation, Query
from tachk.model.run import RunTimeFault, TimedTrace, Transition

if TYPE_CHECKING:
    from tachk.transform.observed import ObserverMove
    from tachk.transform.transformation import Transformation
    from tachk.verify.plan import Task


class Answer(StrEnum):
    """What a search says about a query. It is not a bool: UNKNOWN is neither."""

    HOLDS = "holds"
    FAILS = "fails"
    UNKNOWN = "unknown"

    def __bool__(self) -> bool:
        raise TypeError("an answer has three values; compare it with Answer.HOLDS, FAILS or UNKNOWN")


def answers_of(query: Query) -> tuple[Answer, Answer]:
    """The answers where what a search looks for is there and where it is not: a state of the target, or a run that
    avoids what it should meet."""
    shown = query.holds_when_reached or query.kind is QueryKind.POTENTIALLY_ALWAYS
    return (Answer.HOLDS, Answer.FAILS) if shown else (Answer.FAILS, Answer.HOLDS)


@dataclass(frozen=True, slots=True)
class Extreme:
    """The least or the largest value that an expression takes.

    Attributes:
        value: in the time unit of the model for clocks; None where there is no limit.
        strict: the value is approached and not taken.
        run: ends in a state with this value where it is taken; None where no run can.
    """

    value: int | None
    strict: bool = False
    run: TimedTrace | None = field(default=None, repr=False)


@dataclass(frozen=True, slots=True)
class Extremes:
    """``expression``: as text. An extreme that was not requested is None."""

    expression: str
    least: Extreme | None = None
    largest: Extreme | None = None

    def in_words(self, unit: str = "") -> list[str]:
        """``P.x ≥ 2 ms``, ``P.x < 9 ms``, ``P.x has no largest value``.

        Args:
            unit: of the expression, if it is a clock.
        """
        from tachk.model.quantity import duration

        both = ((self.least, "≥", ">", "least"), (self.largest, "≤", "<", "largest"))
        return [
            f"{self.expression} has no {name} value"
            if extreme.value is None
            else f"{self.expression} {strictly if extreme.strict else sign} {duration(Fraction(extreme.value), unit)}"
            for extreme, sign, strictly, name in both
            if extreme is not None
        ]


@dataclass(frozen=True, slots=True)
class Verdict:
    """The answer to one query, with what shows it.

    Attributes:
        exact: the answer is proved; False only together with UNKNOWN, where an over-approximation was not conclusive.
        reason: why the answer is UNKNOWN, else empty.
        trace: a replayed run that shows E<> true or A[] false; None where no run can.
        fault: the run-time error of the model that ended the search, if one did.
        unsupported: why this query cannot be checked at all.
        unexamined: the processes that were frozen or left out, and the variables whose updates were, because the
            answer does not depend on them, where they can meet run-time errors: these were not looked for.
        assumption: how the model was read where it does not say what it means and the answer depends on it; else empty.
        extremes: for ``sup``, ``inf`` and ``bounds`` one entry for each expression; empty where no state satisfies the
            restriction.
        notes: what the user should know beside the answer: that it holds for no reason of interest, for example.
        moves: what the observer of a temporal property did along the trace, which is that of the model alone.
        path: the transitions of the run with those of the observer, where there is a trace.
        strategy: the name of the one that decided it (`tachk.verify.strategies`); empty where none did, as for UNKNOWN.
    """

    query: Query
    answer: Answer
    exact: bool
    reason: str
    statistics: Statistics
    trace: TimedTrace | None = None
    fault: RunTimeFault | None = None
    unsupported: Diagnostic | None = None
    moves: tuple[ObserverMove, ...] = ()
    unexamined: tuple[str, ...] = ()
    assumption: str = ""
    extremes: tuple[Extremes, ...] = ()
    notes: tuple[str, ...] = ()
    path: tuple[Transition, ...] = ()
    strategy: str = ""

    @property
    def name(self) -> str:
        """The name of the query: that of the property, else ``q1``, ``q2``, ..."""
        return self.query.name

    @property
    def in_words(self) -> str:
        """The answer in a word, or the values where these are the answer: ``holds``, ``P.x ≤ 2``; with the reason."""
        values = [words for each in self.extremes for words in each.in_words()]
        return f"{', '.join(values) or self.answer.value}{f' ({self.reason})' if self.reason else ''}"

    def __repr__(self) -> str:
        return f"<Verdict {self.query.name}: {self.in_words}, {self.query.text}>"

    def _repr_html_(self) -> str:
        from tachk.base.notebook import html_table

        states, steps = self.statistics.states_stored, None if self.trace is None else len(self.trace.steps)
        row = (self.query.name, self.query.text, self.in_words, states, steps)
        return html_table(["property", "formula", "answer", "states", "steps of the run"], [row])

    def noted(self, note: str) -> Verdict:
        """The verdict with a note more."""
        return replace(self, notes=(*self.notes, note))

    @property
    def met(self) -> bool | None:
        """True if the answer is the expected one (without ``expect``: HOLDS); None for UNKNOWN."""
        if self.answer is Answer.UNKNOWN:
            return None
        expected = self.query.expectation or Expectation.HOLDS
        return self.answer.value == expected.value


@unhurried()
def lifted(verdict: Verdict, transformation: Transformation) -> Verdict:
    """A verdict about a transformed network, with its run and its run-time error as those of the original."""
    fault = None if verdict.fault is None else transformation.lift_fault(verdict.fault)
    trace = None if verdict.trace is None else transformation.lift(verdict.trace)
    return replace(verdict, fault=fault, trace=trace)


def not_begun(query: Query, reason: str) -> Verdict:
    return Verdict(query, Answer.UNKNOWN, True, reason, Statistics())


def none_begun(tasks: Iterable[Task], reason: str) -> dict[int, Verdict]:
    return {task.number: not_begun(task.query, reason) for task in tasks}


def all_unsupported(queries: Iterable[Query], reason: Diagnostic) -> tuple[Verdict, ...]:
    """The verdicts about a model that has something tachk does not check, so that no query can be decided."""
    return tuple(unsupported(query, reason) for query in queries)


def unsupported(query: Query, diagnostic: Diagnostic) -> Verdict:
    return Verdict(query, Answer.UNKNOWN, True, diagnostic.message, Statistics(), unsupported=diagnostic)
