"""Makes a failing case of a monitor smaller, so that a person can see what is wrong."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from fractions import Fraction
from typing import Any

from tachk.base.span import NOWHERE
from tachk.syntax import formula as syntax
from tests.support.exact_trace import ExactTrace
from tests.support.formulas import MonitoringCase


def reduced(case: MonitoringCase, fails: Callable[[MonitoringCase], object]) -> MonitoringCase:
    """A case that fails too and of which no part can be left out."""
    smaller = next((candidate for candidate in _candidates(case) if fails(candidate)), None)
    while smaller is not None:
        case = smaller
        smaller = next((candidate for candidate in _candidates(case) if fails(candidate)), None)
    return case


def describe(trace: ExactTrace) -> str:
    """A trace on one line: its rows and its end."""
    rows = []
    for row, time in enumerate(trace.times):
        values = ", ".join(f"{name}={float(column[row]):g}" for name, column in trace.columns.items())
        rows.append(f"{time}: {values}")
    return f"{'; '.join(rows)}; end {trace.end}"


def _candidates(case: MonitoringCase) -> Iterator[MonitoringCase]:
    for formula in _smaller_formulas(case.formula):
        yield MonitoringCase(formula, case.trace)
    for trace in _smaller_traces(case.trace):
        yield MonitoringCase(case.formula, trace)


def _smaller_formulas(formula: syntax.Formula) -> Iterator[syntax.Formula]:
    parts = syntax.operands(formula)
    yield from parts
    if not isinstance(formula, syntax.TruthConstant):
        yield syntax.TruthConstant(NOWHERE, False)
        yield syntax.TruthConstant(NOWHERE, True)
    if isinstance(formula, syntax.And | syntax.Or) and len(parts) > 2:
        for left_out in range(len(parts)):
            yield replace(formula, operands=parts[:left_out] + parts[left_out + 1 :])
    for field in fields(formula):
        value = getattr(formula, field.name)
        if field.name == "operands":
            for number, part in enumerate(value):
                for smaller in _smaller_formulas(part):
                    yield _with(formula, field.name, (*value[:number], smaller, *value[number + 1 :]))
        elif field.name in {"operand", "left", "right"}:
            for smaller in _smaller_formulas(value):
                yield _with(formula, field.name, smaller)
        elif field.name == "interval":
            for simpler in _simpler_intervals(value):
                yield _with(formula, field.name, simpler)


def _with(formula: Any, field: str, value: object) -> Any:
    return replace(formula, **{field: value})


def _simpler_intervals(interval: syntax.Interval) -> Iterator[syntax.Interval]:
    if not interval.lower_closed:
        yield replace(interval, lower_closed=True)
    if not interval.upper_closed:
        yield replace(interval, upper_closed=True)
    lower, upper = interval.lower.value, None if interval.upper is None else interval.upper.value
    assert isinstance(lower, Fraction)
    zero = syntax.Duration(NOWHERE, Fraction(0))
    if lower > 0:
        yield replace(interval, lower=zero)
    if isinstance(upper, Fraction) and upper > lower:
        yield replace(interval, upper=syntax.Duration(NOWHERE, max(lower, Fraction((lower + upper) // 2))))


def _smaller_traces(trace: ExactTrace) -> Iterator[ExactTrace]:
    rows = len(trace.times)
    for left_out in range(1, rows):
        kept = [row for row in range(rows) if row != left_out]
        columns = {name: tuple(values[row] for row in kept) for name, values in trace.columns.items()}
        yield ExactTrace(tuple(trace.times[row] for row in kept), columns, trace.end)
    if trace.end > trace.times[-1]:
        yield replace(trace, end=trace.times[-1])
    if len(trace.columns) > 1:
        for name, values in trace.columns.items():
            if any(value != 0 for value in values):
                plain = tuple(False if isinstance(value, bool) else Fraction(0) for value in values)
                yield replace(trace, columns={**trace.columns, name: plain})
