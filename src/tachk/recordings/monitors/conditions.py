"""Columns that are conditions by themselves: ``ok`` in ``G ok``. They hold truth values, 0 and 1, and nothing else."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from tachk.base.diagnostics.diagnostic import Diagnostic, UsageError
from tachk.base.operators import BinaryOperator
from tachk.base.span import Span
from tachk.recordings.monitors.compiler import COLUMN_NAMES, column_name, is_condition
from tachk.recordings.traces.monitor_program import AtomRelation, MonitorProgram, NodeKind, ValueOperator
from tachk.recordings.traces.trace import Trace
from tachk.syntax import ast
from tachk.syntax.formula import Atom, Formula
from tachk.syntax.formulas.printer import print_number
from tachk.syntax.rewrite import rewrite
from tachk.syntax.walk import nodes_of_kind


def condition_columns(program: MonitorProgram) -> tuple[str, ...]:
    """The columns that a program uses as conditions."""
    atoms = [program.atoms[node.atom] for node in program.nodes if node.kind is NodeKind.ATOM]
    found = [atom.left[0] for atom in atoms if atom.relation is AtomRelation.TRUTH and len(atom.left) == 1]
    return tuple(program.columns[int(each.operand)] for each in found if each.operator is ValueOperator.COLUMN)


def condition_findings(formula: Formula, program: MonitorProgram, trace: Trace) -> Iterator[Diagnostic]:
    """A finding for each column that a formula uses as a condition, and that holds another number than 0 and 1."""
    for column in condition_columns(program):
        values = trace.columns[column]
        if values.dtype.kind == "u":
            continue
        wrong = (values != 0) & (values != 1)
        if not wrong.any():
            continue
        row = int(wrong.argmax())
        at = print_number(trace.clock(int(trace.times[row])))
        message = f"`{column}` is not a condition: it is {values[row]:g} at {at} {trace.unit}".rstrip()
        yield Diagnostic("E0902", message, _place(formula, column), _compare(column))


def no_condition(place: str, column: str, value: object) -> UsageError:
    """The error of a row that gives a column which is a condition another number than 0 and 1."""
    return UsageError(f"{place}: the value {value} of column {column!r} is not a truth value", _compare(column))


def with_numbers_as_conditions(formula: Formula) -> Formula:
    """The formula with ``n != 0`` in place of ``n``, as in models, in which a number is a condition."""

    def change(node: Any) -> Any:
        match node:
            case Atom(span=span, expression=expression) if not is_condition(expression):
                zero = ast.IntegerLiteral(span, 0)
                return Atom(span, ast.BinaryExpression(span, BinaryOperator.NOT_EQUAL, expression, zero))
            case _:
                return node

    return rewrite(formula, change)


def _compare(column: str) -> str:
    return f"compare it, as in `{column} > 0`: conditions are columns of 0 and 1"


def _place(formula: Formula, column: str) -> Span:
    atoms = [atom.expression for atom in nodes_of_kind(formula, Atom)]
    names: Sequence[Any] = list(nodes_of_kind(formula, *COLUMN_NAMES))
    expressions: list[Any] = [*atoms, *names]
    return next(
        (each.span for each in expressions if isinstance(each, COLUMN_NAMES) and column_name(each) == column),
        formula.span,
    )
