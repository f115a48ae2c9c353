"""Comparisons of formulas with columns that hold texts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.operators import BinaryOperator
from tachk.recordings.traces.logs.labels import Labels
from tachk.recordings.traces.trace import Trace
from tachk.recordings.traces.trace_arrays import is_missing
from tachk.syntax import ast
from tachk.syntax.formula import Formula
from tachk.syntax.printing.expression_printer import print_expression
from tachk.syntax.walk import nodes_of_kind

_TEXTS_LISTED = 8
_NAMES = (ast.NameExpression, ast.MemberExpression, ast.IndexExpression)


@dataclass(frozen=True, slots=True)
class Texts:
    """Attributes:
    columns: that hold texts, as the places of these in ``labels``.
    """

    columns: frozenset[str]
    labels: tuple[str, ...]


def text_columns(formula: Formula, known: frozenset[str] = frozenset()) -> frozenset[str]:
    """The columns that a formula compares with texts, or with such columns.

    Args:
        known: columns that hold texts in any case.
    """
    pairs = [
        (comparison.left, comparison.right)
        for comparison in nodes_of_kind(formula, ast.BinaryExpression)
        if comparison.operator in (BinaryOperator.EQUAL, BinaryOperator.NOT_EQUAL)
    ]
    found: set[str] = set()
    while True:
        more = {
            _name(side)
            for pair in pairs
            for side, other in (pair, pair[::-1])
            if isinstance(side, _NAMES)
            and (
                isinstance(other, ast.StringLiteral)
                or (isinstance(other, _NAMES) and (_name(other) in found or _name(other) in known))
            )
        }
        if more <= found:
            return frozenset(found)
        found |= more


def unmet_texts(formula: Formula, trace: Trace) -> Iterator[str]:
    """A warning for each text that a formula compares with a column which has it in no row."""
    for comparison in nodes_of_kind(formula, ast.BinaryExpression):
        for side, other in ((comparison.left, comparison.right), (comparison.right, comparison.left)):
            if not (isinstance(side, _NAMES) and isinstance(other, ast.StringLiteral)):
                continue
            column = _name(side)
            if column not in trace.texts:
                continue
            met = [trace.labels[int(number)] for number in np.unique(trace.columns[column])]
            if other.value not in met:
                more = "" if len(met) <= _TEXTS_LISTED else f" and {len(met) - _TEXTS_LISTED} others"
                known = ", ".join(f'"{each}"' for each in met[:_TEXTS_LISTED])
                yield f'{trace.name}: no row of `{column}` has the text "{other.value}"; it has {known}{more}'


def texts_of(formula: Formula) -> tuple[str, ...]:
    """The texts that stand in a formula."""
    return tuple(dict.fromkeys(literal.value for literal in nodes_of_kind(formula, ast.StringLiteral)))


def _name(expression: ast.Expression) -> str:
    return expression.name if isinstance(expression, ast.NameExpression) else print_expression(expression)


class TextNumbers:
    """The texts on a trace that grows: numbered when they are met, those of the formulas first.

    Attributes:
        columns: that hold texts, because a formula compares them with one.
    """

    def __init__(self, formulas: Sequence[Formula]) -> None:
        self.columns = frozenset(name for formula in formulas for name in text_columns(formula))
        self._labels = Labels()
        for formula in formulas:
            for text in texts_of(formula):
                self._labels.number(text)
        self.known = Texts(self.columns, self._labels.known)

    def in_row(self, values: Mapping[str, Any], row: int) -> dict[str, Any]:
        """The values of a row with numbers in place of texts. Raises UsageError for a value that is not a text."""
        numbered = dict(values)
        for name in self.columns & numbered.keys():
            value = numbered[name]
            if isinstance(value, str):
                numbered[name] = self._labels.number(value)
            elif not (value is None or value != value):
                raise UsageError(
                    f"row {row}: the value {value!r} of column {name!r} is not a text", "a formula says it is"
                )
        return numbered

    def in_rows(self, columns: Mapping[str, Any], name: str) -> dict[str, Any]:
        """The same of columns."""
        numbered = dict(columns)
        for column in self.columns & numbered.keys():
            words = numbered[column]
            cells = words.to_numpy() if hasattr(words, "to_numpy") else np.asarray(words)
            numbered[column] = np.array([self._number(word, column, name) for word in cells.tolist()], dtype=np.float64)
        return numbered

    def _number(self, word: Any, column: str, name: str) -> float:
        """The number of a text, not a number where a text stays. Raises UsageError for what is not a text."""
        if isinstance(word, str):
            return self._labels.number(word)
        if is_missing(word):
            return math.nan
        raise UsageError(f"{name}: column {column!r} holds no texts, but {word!r}", "a formula says it does")

    def on(self, trace: Trace) -> Trace:
        """A trace with numbers in place of texts that knows these."""
        return replace(trace, texts=self.columns, labels=self._labels.known) if self.columns else trace
