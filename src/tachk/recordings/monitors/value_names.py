"""Names of values in formulas and in findings: constants of messages, values of enumerations."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.base.operators import BinaryOperator
from tachk.base.records import replace
from tachk.base.span import Span
from tachk.recordings.monitors.compiler import COLUMN_NAMES, column_name, columns_read
from tachk.recordings.monitors.formulas import NamedFormula, literal
from tachk.recordings.traces.logs.named_values import Value, enumerations, named_values
from tachk.recordings.traces.trace import TraceSource
from tachk.syntax import ast
from tachk.syntax.formula import Formula
from tachk.syntax.printing.expression_printer import print_expression
from tachk.syntax.rewrite import rewrite
from tachk.syntax.walk import nodes_of_kind


def with_named_values(formulas: Sequence[NamedFormula], recording: TraceSource) -> list[NamedFormula]:
    """Formulas with values in place of the names that the recording has for them; columns and constants come first.

    Texts that name values of an enumeration, ``mode == "FAST"``, are these values. Raises InputError for others.
    """
    values = _values_named(formulas, recording)
    listed = enumerations(recording, _compared_with_texts(formulas, recording.columns))
    if not values and not listed:
        return list(formulas)

    def change(node: Any) -> Any:
        if isinstance(node, COLUMN_NAMES):
            value = values.get(column_name(node))
            if isinstance(value, str):
                return ast.StringLiteral(node.span, value)
            if value is not None:
                return _named(node.span, value, column_name(node))
        if isinstance(node, ast.BinaryExpression):
            left, right = node.left, node.right
            return replace(node, left=_number(left, right, listed), right=_number(right, left, listed))
        return node

    def changed(formula: Formula) -> Formula:
        return rewrite(formula, change)

    return [
        replace(
            named,
            formula=changed(named.formula),
            siblings={name: changed(each) for name, each in (named.siblings or {}).items()} or None,
            written=named.text,
        )
        for named in formulas
    ]


def names_of_values(formulas: Sequence[NamedFormula], recording: TraceSource) -> dict[str, dict[int, str]]:
    """The names in the recording for the values of the columns that formulas read, where a value has one name only.

    A column to which no names are known to belong has those that the formulas compare it with.
    """
    columns = {name for each in _all(formulas) for name in columns_read(each)}.intersection(recording.columns)
    found = {column: set(names.items()) for column, names in enumerations(recording, columns).items()}
    values = _values_named(formulas, recording)
    compared: dict[str, set[tuple[str, int]]] = {}
    for column, other in (pair for formula in _all(formulas) for pair in _compared(formula)):
        if column in columns - found.keys() and isinstance(other, COLUMN_NAMES):
            value = values.get(column_name(other))
            if isinstance(value, int):
                compared.setdefault(column, set()).add((column_name(other).rpartition(".")[2], value))
    return {column: _unique(names) for column, names in (found | compared).items()}


def _unique(names: Collection[tuple[str, int]]) -> dict[int, str]:
    count = Counter(value for _, value in names)
    return {value: name for name, value in names if count[value] == 1}


def _values_named(formulas: Sequence[NamedFormula], recording: TraceSource) -> dict[str, Value]:
    """The names that mean values of the recording, for they are no columns, constants or formulas."""
    names = {
        name
        for named in formulas
        for each in _all([named])
        for name in columns_read(each) - named.constant_names - (named.siblings or {}).keys()
    }.difference(recording.columns)
    return {name: value for name, value in named_values(recording).items() if name in names} if names else {}


def _all(formulas: Sequence[NamedFormula]) -> Iterator[Formula]:
    for named in formulas:
        yield named.formula
        yield from (named.siblings or {}).values()


def _compared(formula: Formula) -> Iterator[tuple[str, ast.Expression]]:
    """The columns that are compared for equality, and with what."""
    for node in nodes_of_kind(formula, ast.BinaryExpression):
        if node.operator in (BinaryOperator.EQUAL, BinaryOperator.NOT_EQUAL):
            for side, other in ((node.left, node.right), (node.right, node.left)):
                if isinstance(side, COLUMN_NAMES):
                    yield column_name(side), other


def _compared_with_texts(formulas: Sequence[NamedFormula], columns: Collection[str]) -> set[str]:
    pairs = (pair for formula in _all(formulas) for pair in _compared(formula))
    return {column for column, other in pairs if isinstance(other, ast.StringLiteral) and column in columns}


def _number(side: ast.Expression, other: ast.Expression, listed: Mapping[str, Mapping[str, int]]) -> ast.Expression:
    """The number in place of a text that names a value of the other side of a comparison. Raises InputError."""
    if not (isinstance(side, ast.StringLiteral) and isinstance(other, COLUMN_NAMES)):
        return side
    names = listed.get(column_name(other))
    if names is None:
        return side
    if side.value not in names:
        message = f'`{column_name(other)}` has no value that is called "{side.value}"'
        help_ = did_you_mean(side.value, names) or f"its values are {', '.join(names)}"
        raise InputError([Diagnostic("E0902", message, side.span, help_)])
    return _named(side.span, names[side.value], print_expression(side))


def _named(span: Span, value: int | float, name: str) -> ast.Expression:
    return ast.IntegerLiteral(span, value, name) if isinstance(value, int) else literal(span, Fraction(value))
