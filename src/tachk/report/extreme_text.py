"""The values that ``sup``, ``inf`` and ``bounds`` have found, as people and verifyta write them."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from tachk.model.quantity import duration
from tachk.model.types import ClockType
from tachk.verify.verdict import Extreme, Extremes, Verdict


def value_lines(verdict: Verdict, time_unit: str) -> Iterator[str]:
    """For each expression what was found: ``P.x ≥ 2 ms, P.x < 9 ms``, ``P.x has no largest value``."""
    for operand, found in zip(verdict.query.operands, verdict.extremes, strict=False):
        unit = time_unit if isinstance(operand.type, ClockType) else ""
        yield ", ".join(found.in_words(unit))


def answer_text(verdict: Verdict, time_unit: str) -> str:
    """The answer in a word, or the values where these are the answer: ``holds``, ``P.x ≤ 2 ms``."""
    return "; ".join(value_lines(verdict, time_unit)) or verdict.answer.value


def value_shown(verdict: Verdict, time_unit: str) -> str:
    """The text of the extreme in the trace of a verdict: ``P.x is 15 ms``."""
    for operand, found in zip(verdict.query.operands, verdict.extremes, strict=True):
        for extreme, _ in requested(found):
            if extreme.run is verdict.trace and extreme.value is not None:
                unit = time_unit if isinstance(operand.type, ClockType) else ""
                return f"{found.expression} is {duration(Fraction(extreme.value), unit)}"
    raise ValueError(f"the trace of {verdict.query.name} shows no value")


def verifyta_values(verdict: Verdict) -> Iterator[str]:
    """``P.x <= 15``; what has no limit is below infinity."""
    for found in verdict.extremes:
        for extreme, largest in requested(found):
            sign = ("<" if largest else ">") + ("" if extreme.strict or extreme.value is None else "=")
            value = str(extreme.value) if extreme.value is not None else "infinity" if largest else "-infinity"
            yield f"{found.expression} {sign} {value}"


def requested(found: Extremes) -> list[tuple[Extreme, bool]]:
    """The extremes that were requested, each with True if it is the largest value."""
    both = ((found.least, False), (found.largest, True))
    return [(extreme, largest) for extreme, largest in both if extreme is not None]
