"""Answers about a model that can be read in several ways."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from tachk.properties.verdict import Answer, Verdict


def agreed(verdict: Verdict, taken: str, others: Iterable[tuple[str, Verdict]]) -> Verdict:
    """The verdict as it is if it is unknown or all readings agree, else with the assumption on which it rests.

    Args:
        taken: the reading of the verdict, in words.
        others: the other readings, each with its verdict about the same query.
    """
    differing: dict[Answer, list[str]] = {}
    for reading, other in others:
        if other.answer is not verdict.answer:
            differing.setdefault(other.answer, []).append(reading)
    if verdict.answer is Answer.UNKNOWN or not differing:
        return verdict
    elsewhere = "; ".join(
        f"{'it is unknown' if answer is Answer.UNKNOWN else f'it {answer.value}'} if it is {' or '.join(readings)}"
        for answer, readings in differing.items()
    )
    return replace(verdict, assumption=f"`default` is taken to be {taken}; {elsewhere}")
