"""Properties that hold vacuously: their trigger never happens.

``A[] (a imply b)`` holds where ``a`` is never true, whatever ``b`` says. Whether ``a`` is ever true, the search that
decides the property sees on its way: it is one more goal that it does not go on for. Only where a formula without
deadline holds, a search of its own asks for it (`observed_liveness`). Some triggers are left out, as they would make
the search larger, or could meet an error where the property itself does not: a trigger that compares clocks or contains
`deadlock`, one that may be a run-time error, and one that the constants of the model decide.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from tachk.analysis.fold import cannot_fail, fold, known_values
from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass, replace
from tachk.base.span import Span
from tachk.base.words import QueryKind
from tachk.engine.compiler.goal import mentions_time
from tachk.engine.compiler.program import Goal
from tachk.engine.outcome import GoalOutcome, Status
from tachk.model.connectives import any_of, both
from tachk.model.expressions import BOOL, Binary, Constant, Expression, Quantifier, QuantifierKind, Variable
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.remembered import by_network
from tachk.verify.plan import Task
from tachk.verify.verdict import Answer, Verdict


@dataclass(frozen=True, slots=True)
class Trigger:
    """The trigger of a property: ``condition`` must be true somewhere, else the property says nothing.

    Attributes:
        task: the number of the task whose property it is.
        text: as the user wrote it.
    """

    task: int
    text: str
    condition: Expression


def triggers_of(tasks: Iterable[Task], network: Network) -> tuple[Trigger, ...]:
    """The left sides of the implications of properties, as far as they may be checked on the way.

    An implication under ``forall`` is one however it is held: as a quantifier, or as one copy for each value.
    """
    return _triggers_of(network, tuple(tasks))


@by_network
def _triggers_of(network: Network, tasks: tuple[Task, ...]) -> tuple[Trigger, ...]:
    copies: dict[tuple[int, Span, str], list[Expression]] = {}
    for task in tasks:
        for span, text, condition in _of_query(task.query):
            copies.setdefault((task.number, span, text), []).append(condition)
    if not copies:
        return ()
    known = known_values(network, [_predicate(task) for task in tasks])
    triggers = []
    for (number, _, text), conditions in copies.items():
        folded = [fold(condition, known) for condition in conditions]
        open_ = [condition for condition in folded if not (isinstance(condition, Constant) and condition.value == 0)]
        if open_ and all(cannot_fail(c) and not mentions_time(c) and not isinstance(c, Constant) for c in open_):
            triggers.append(Trigger(number, text, any_of(open_)))
    return tuple(triggers)


def _predicate(task: Task) -> Expression:
    if task.condition is not None:
        return task.condition
    return Constant(1, BOOL) if task.query.predicate is None else task.query.predicate


def _of_query(query: Query) -> Iterator[tuple[Span, str, Expression]]:
    """The left sides of implications, with their places and texts."""
    if query.observer is not None:
        yield from ((query.span, text, condition) for text, condition in query.observer.triggers)
        return
    if query.kind is QueryKind.INVARIANTLY and query.predicate is not None:
        for left, condition in _implications(query.predicate, None, ()):
            yield left.span, left.span.text, condition


def _implications(
    predicate: Expression, above: Expression | None, bound: tuple[Variable, ...]
) -> Iterator[tuple[Expression, Expression]]:
    """The left sides of the implications in a conjunction, as they stand there, each with what it means there.

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
            yield left, _for_some(bound, whole)
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
        number: replace(verdict, notes=tuple(dict.fromkeys((*verdict.notes, *map(never_true, never[number])))))
        if number in never and verdict.answer is Answer.HOLDS
        else verdict
        for number, verdict in verdicts.items()
    }


def never_begins(query: Query) -> tuple[str, ...]:
    """The note about a query ``p --> q`` of which no state satisfies p; none about a formula."""
    if query.observer is not None or query.predicate is None or not query.predicate.span.text:
        return ()
    return (never_true(query.predicate.span.text),)


def never_true(text: str) -> str:
    """The note about a trigger that never happens."""
    return f"holds only because `{' '.join(text.split())}` is never true"
