"""Answers to statistical queries beside the verdicts of a verification."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from tachk.report.statistics.text import answer_lines, interval_text
from tachk.simulation.statistics.answers import StatisticalAnswer


def answered_lines(answer: StatisticalAnswer) -> Iterator[str]:
    """The answer as `tachk estimate` prints it, and what was expected where it is another."""
    query = answer.query
    if answer.found is None:
        yield f"{query.name}: {' '.join(query.text.split())}: unknown ({answer.reason})"
        return
    first, *others = answer_lines(answer.found, answer.settings)
    expected = "" if query.expectation is None else f", expected {query.expectation.value}"
    yield first + expected
    yield from others


def short_answer(found: Mapping[str, Any] | None) -> str:
    """An answer in a few words, from what `answered_document` has as ``found``."""
    if found is None:
        return "unknown"
    match found["kind"]:
        case "probability" | "splitting":
            return interval_text(found["low"], found["high"])
        case "unknown":
            return "unknown"
        case "test":
            return str(found["answer"])
        case "mean":
            return mean_text(found)
        case _:
            count = len(found["runs"])
            return "1 run" if count == 1 else f"{count} runs"


def mean_text(found: Mapping[str, Any]) -> str:
    """The answer to E[...](...) of a document in a few words; any of its numbers may be null."""
    mean, sure, ends = found["mean"], (found["low"], found["high"]), found["asymptotic"]
    if None not in sure:
        return interval_text(*sure) if mean is None else f"{mean:.4g}; {interval_text(*sure)}"
    return "unknown" if None in ends else f"asymptotically {interval_text(*ends)}"
