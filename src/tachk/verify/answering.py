"""Answers to questions about a model, compared over all the ways in which it can be read."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from tachk.base.job import unhurried
from tachk.base.records import replace
from tachk.engine.options import Limits, Options
from tachk.frontend.loaded import LoadedModel, other_interpretations_of
from tachk.frontend.priority_interpretations import FIRST
from tachk.model.query import Query
from tachk.verify.questions import Questions, checked
from tachk.verify.verdict import Answer, Verdict, all_unsupported
from tachk.verify.verify import verify


def answers(
    model: LoadedModel,
    questions: Questions,
    queries: Sequence[Query],
    options: Options,
    limits: Limits,
    trace: bool,
) -> tuple[Verdict, ...]:
    """The verdicts about the queries, each with the assumption on which it rests where interpretations differ.

    Args:
        queries: the queries about the model with its first values.

    Raises InputError and UnsupportedError as `verify` does.
    """
    if model.refusals:
        return all_unsupported(queries, model.refusals[0])
    verdicts = verify(model.network, queries, options, limits, trace)
    if all(verdict.answer is Answer.UNKNOWN for verdict in verdicts):
        return verdicts
    with unhurried():
        interpretations = [
            (at, each.network, checked(questions.about(each))) for at, each in other_interpretations_of(model)
        ]
    others = [
        (at, verify(network, formulas, options, limits, trace=False)) for at, network, formulas in interpretations
    ]
    return tuple(
        agreed(verdict, FIRST, [(place, found[number]) for place, found in others])
        for number, verdict in enumerate(verdicts)
    )


def agreed(verdict: Verdict, taken: str, others: Iterable[tuple[str, Verdict]]) -> Verdict:
    """The verdict as it is if it is unknown or all interpretations agree, else with the assumption on which it rests.

    Args:
        taken: the interpretation of the verdict, in words.
        others: the other interpretations, each with its verdict about the same query.
    """
    differing: dict[Answer, list[str]] = {}
    for interpretation, other in others:
        if other.answer is not verdict.answer:
            differing.setdefault(other.answer, []).append(interpretation)
    if verdict.answer is Answer.UNKNOWN or not differing:
        return verdict
    elsewhere = "; ".join(
        f"{'it is unknown' if answer is Answer.UNKNOWN else f'it {answer.value}'} if it is {' or '.join(places)}"
        for answer, places in differing.items()
    )
    return replace(verdict, assumption=f"`default` is taken to be {taken}; {elsewhere}")
