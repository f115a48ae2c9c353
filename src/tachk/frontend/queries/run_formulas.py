"""Formulas in ``Pr(...)`` with more than one temporal operator: what UPPAAL calls MITL, and STL as monitors read it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, InternalError, UnsupportedError
from tachk.base.span import Span
from tachk.frontend.context import Context
from tachk.frontend.queries.formula_durations import resolve_durations
from tachk.frontend.scope import Scope
from tachk.logic.horizon import horizon
from tachk.model.connectives import as_number
from tachk.model.expressions import BOOL, Constant, Expression
from tachk.model.run_formulas import RunFormula, RunOperator, RunWindow
from tachk.model.traversal import reads_clock, reads_hybrid
from tachk.syntax import formula as syntax
from tachk.syntax.formulas.parser import parse_formula
from tachk.syntax.formulas.tokens import TEMPORAL, resolve_formula
from tachk.syntax.parsing.tables import lexer
from tachk.syntax.rewrite import rewrite
from tachk.syntax.walk import nodes_of_kind

_AHEAD = (syntax.Eventually, syntax.Always, syntax.Until, syntax.WeakUntil)
_BEHIND = (syntax.Once, syntax.Historically, syntax.Since)
_EXAMPLE = "for example Pr(<>[0,5] ([][0,2] P.idle)) or Pr[<=100]([] (p -> <>[0,5] q))"
_FOREIGN = {
    "X": "a next step has no meaning where time is dense; give an interval: <>[0,1] p",
    "R": "write !(!p U[a,b] !q) for p R[a,b] q",
}
"""UPPAAL's other operators, each with a substitute."""


_OPERATORS: Mapping[type[syntax.Formula], RunOperator] = {
    syntax.Not: RunOperator.NOT,
    syntax.And: RunOperator.AND,
    syntax.Or: RunOperator.OR,
    syntax.Rise: RunOperator.RISE,
    syntax.Fall: RunOperator.FALL,
    syntax.Eventually: RunOperator.EVENTUALLY,
    syntax.Always: RunOperator.ALWAYS,
    syntax.Once: RunOperator.ONCE,
    syntax.Historically: RunOperator.HISTORICALLY,
    syntax.Until: RunOperator.UNTIL,
    syntax.Since: RunOperator.SINCE,
}


@dataclass(frozen=True, slots=True)
class ReadFormula:
    """Attributes:
    reach: the time after which the formula is decided whatever the run does.
    """

    formula: RunFormula
    reach: Fraction


@dataclass(frozen=True, slots=True)
class OperandReader:
    """The readers of the parts of a formula.

    Attributes:
        condition: the typed condition in a text. Raises the errors of the reader of the query.
        value: the same of a number.
    """

    condition: Callable[[Span], Expression]
    value: Callable[[Span], Expression]
    scope: Scope
    context: Context


def operators_in(span: Span) -> tuple[str, ...]:
    """The temporal operators of a text from left to right, as letters; none where it is not a formula."""
    lexed = lexer().cut(span.source, span.start, span.end)
    marked = resolve_formula(list(lexed.tokens[:-1]))
    return tuple(token.text for token in marked if token.type in TEMPORAL)


def read_run_formula(span: Span, limit: Fraction | None, operands: OperandReader) -> ReadFormula:
    """The formula in a text.

    Args:
        limit: the bound of the query, which is the interval of outermost operators that have none.

    Raises:
        InputError: it is wrong.
        UnsupportedError: it is of a form that is not estimated.
    """
    formula, found = parse_formula(span)
    if formula is None:
        raise InputError(found)
    resolved = resolve_durations(formula, operands.scope, operands.context)
    if resolved is None:
        raise InputError(operands.context.findings.sorted())
    bounded = _bounded(resolved, limit)
    reach = horizon(bounded)
    assert reach is not None
    return ReadFormula(_as_formula(_converted(bounded, operands)), reach)


def refuse_foreign(span: Span, scope: Scope) -> None:
    """Raises UnsupportedError for an operator of UPPAAL that is not estimated."""
    tokens = lexer().cut(span.source, span.start, span.end).tokens
    for token, following in pairwise(tokens):
        is_release = token.text == "R" and following.text in ("[", "(")
        is_next = token.text == "X" and (following.text in ("(", "<", "[", "!") or following.type == "NAME")
        if (is_release or is_next) and scope.lookup(token.text) is None:
            raise _unsupported(f"the operator {token.text} is not estimated", token.span, _FOREIGN[token.text])


def _bounded(formula: syntax.Formula, limit: Fraction | None) -> syntax.Formula:
    """The formula in which every operator that looks ahead has an interval with an end."""
    inner = {
        id(node)
        for outer in nodes_of_kind(formula, *_AHEAD, *_BEHIND)
        for part in syntax.operands(outer)
        for node in nodes_of_kind(part, *_AHEAD)
    }
    for node in nodes_of_kind(formula, *_AHEAD):
        if isinstance(node, syntax.WeakUntil) or node.interval.upper is None:
            if limit is None or id(node) in inner:
                raise _unsupported("this operator needs an interval with an end", node.span, _EXAMPLE)

    def change(node: Any) -> Any:
        if isinstance(node, syntax.WeakUntil):
            place, left, right = node.span, node.left, node.right
            whole = _until(syntax.all_time(place), limit)
            return syntax.Or(place, (syntax.Until(place, whole, left, right), syntax.Always(place, whole, left)))
        if isinstance(node, (syntax.Eventually, syntax.Always, syntax.Until)) and node.interval.upper is None:
            return replace(node, interval=_until(node.interval, limit))
        return node

    result: syntax.Formula = rewrite(formula, change)
    return result


def _until(interval: syntax.Interval, limit: Fraction | None) -> syntax.Interval:
    assert limit is not None
    lower = interval.lower.value
    if isinstance(lower, Fraction) and lower > limit:
        message = "this interval begins after the bound of the query"
        raise InputError([Diagnostic("E0147", message, interval.span, "make the bound larger")])
    return replace(interval, upper=syntax.Duration(interval.span, limit), upper_closed=True)


def _as_formula(part: RunFormula | Expression) -> RunFormula:
    return part if isinstance(part, RunFormula) else RunFormula(RunOperator.AND, (part, part))


def _converted(formula: syntax.Formula, operands: OperandReader) -> RunFormula | Expression:
    """The formula with its names resolved; a condition without connectives is an expression."""
    match formula:
        case syntax.TruthConstant(value=value):
            return Constant(int(value), BOOL)
        case syntax.Atom(expression=expression):
            return as_number(_state(operands.condition(expression.span), expression.span))
        case syntax.Change(expression=expression):
            return RunFormula(RunOperator.CHANGE, (_state(operands.value(expression.span), expression.span),))
        case syntax.Implies(left=left, right=right):
            inverse = RunFormula(RunOperator.NOT, (_converted(left, operands),))
            return RunFormula(RunOperator.OR, (inverse, _converted(right, operands)))
        case syntax.Not() | syntax.And() | syntax.Or() | syntax.Rise() | syntax.Fall():
            return RunFormula(_OPERATORS[type(formula)], _operands(formula, operands))
        case syntax.WeakUntil():
            raise InternalError("W has been written out")
        case (
            syntax.Eventually(interval=interval)
            | syntax.Always(interval=interval)
            | syntax.Once(interval=interval)
            | syntax.Historically(interval=interval)
            | syntax.Until(interval=interval)
            | syntax.Since(interval=interval)
        ):
            return RunFormula(_OPERATORS[type(formula)], _operands(formula, operands), _window(interval))


def _operands(formula: syntax.Formula, operands: OperandReader) -> tuple[RunFormula | Expression, ...]:
    return tuple(_converted(operand, operands) for operand in syntax.operands(formula))


def _window(interval: syntax.Interval) -> RunWindow:
    lower, upper = interval.lower.value, None if interval.upper is None else interval.upper.value
    assert isinstance(lower, Fraction) and (upper is None or isinstance(upper, Fraction))
    return RunWindow(lower, upper, interval.lower_closed, interval.upper_closed)


def _state(value: Expression, span: Span) -> Expression:
    """An expression whose value changes only when something happens."""
    if reads_clock(value) or reads_hybrid(value):
        help_ = "compare clocks in <>[a,b] p, [][a,b] p or p U[a,b] q alone, or keep what is meant in a variable"
        raise _unsupported("a formula with several operators does not read clocks", span, help_)
    return value


def _unsupported(message: str, span: Span, help_: str) -> UnsupportedError:
    return UnsupportedError(Diagnostic("E0728", message, span, help_))
