"""Answers that hold for no reason of interest: what a property is about never happens.

``A[] (a imply b)`` holds where ``a`` is never true, whatever ``b`` says. Whether ``a`` is ever true, the search that
decides the property sees on its way: it is one more goal that it does not go on for. What would make the search larger,
or could go wrong where the property itself does not, is not asked: a trigger that compares clocks or asks for deadlock,
one that may be a run-time error, and one that the constants of the model decide.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from tachk.compiler.conditions import both
from tachk.compiler.fold import cannot_fail, fold, known_values
from tachk.compiler.goal import mentions_time
from tachk.compiler.program import Goal
from tachk.engines.outcome import GoalOutcome, Status
from tachk.model.expressions import BOOL, Binary, Constant, Expression, Quantifier, QuantifierKind, Variable
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.operators import BinaryOperator
from tachk.properties.plan import Task
from tachk.properties.verdict import Answer, Verdict
from tachk.records import dataclass
from tachk.words import QueryKind


@dataclass(frozen=True, slots=True)
class Trigger:
    """What a property is about: ``condition`` must be true somewhere, else the property says nothing.

    Attributes:
        task: the number of the task whose property it is.
        text: as the user wrote it.
    """

    task: int
    text: str
    condition: Expression


def triggers_of(tasks: Iterable[Task], network: Network) -> tuple[Trigger, ...]:
    """The left sides of the implications that properties consist of, as far as they may be asked for on the way."""
    tasks = list(tasks)
    implications = [(task.number, found) for task in tasks for found in _of_query(task.query)]
    if not implications:
        return ()
    known = known_values(network, [task.query.predicate for task in tasks if task.query.predicate is not None])
    return tuple(
        Trigger(number, text, condition)
        for number, (text, condition) in implications
        if not mentions_time(condition)
        and cannot_fail(folded := fold(condition, known))
        and not isinstance(folded, Constant)
    )


def _of_query(query: Query) -> Iterator[tuple[str, Expression]]:
    if query.kind is QueryKind.INVARIANTLY and query.observer is None and query.predicate is not None:
        yield from _implications(query.predicate, None, ())


def _implications(
    predicate: Expression, above: Expression | None, bound: tuple[Variable, ...]
) -> Iterator[tuple[str, Expression]]:
    """The left sides of the implications in a conjunction, with the text of each.

    Args:
        above: the left sides of the implications that the predicate is in.
        bound: the variables of the quantifiers around it.
    """
    match predicate:
        case Binary(BinaryOperator.AND, left, right):
            yield from _implications(left, above, bound)
            yield from _implications(right, above, bound)
        case Quantifier(QuantifierKind.FORALL, variable, body):
            yield from _implications(body, above, (*bound, variable))
        case Binary(BinaryOperator.IMPLY, left, right):
            whole = both(above, left)
            yield left.span.text, _for_some(bound, whole)
            yield from _implications(right, whole, bound)
        case _:
            return


def _for_some(bound: Sequence[Variable], condition: Expression) -> Expression:
    for variable in reversed(bound):
        condition = Quantifier(QuantifierKind.EXISTS, variable, condition, BOOL, condition.span)
    return condition


def noted(goals: Iterable[Goal]) -> tuple[Goal, ...]:
    """The goals as ones that the search does not go on for."""
    return tuple(replace(goal, decides=False) for goal in goals)


def with_notes(
    verdicts: dict[int, Verdict], triggers: Sequence[Trigger], outcomes: Sequence[GoalOutcome]
) -> dict[int, Verdict]:
    """The verdicts, those that hold although nothing that they are about happens with a note that says so."""
    never: dict[int, list[str]] = {}
    for trigger, outcome in zip(triggers, outcomes, strict=True):
        if outcome.status is Status.UNREACHABLE:
            never.setdefault(trigger.task, []).append(trigger.text)
    return {
        number: replace(verdict, notes=tuple(dict.fromkeys((*verdict.notes, *map(_note, never[number])))))
        if number in never and verdict.answer is Answer.HOLDS
        else verdict
        for number, verdict in verdicts.items()
    }


def _note(text: str) -> str:
    return f"holds only because `{' '.join(text.split())}` is never true"
