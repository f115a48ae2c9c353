"""From parse trees to temporal formulas.

The grammar has one kind of operand, so that the parser need not decide between ``(a)`` and ``(a U b)`` before the end.
So temporal operators are read as `TemporalExpression` among expressions; when the formula is complete `as_formula`
makes the tree of it and reports operators that stand where only the value of one instant can stand.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.operators import BinaryOperator, PrefixOperator
from tachk.base.records import dataclass
from tachk.base.span import Span
from tachk.syntax import ast
from tachk.syntax.building.build_expressions import Children, span_of
from tachk.syntax.chains import LONGEST_FROM_LEFT
from tachk.syntax.formula import (
    Always,
    And,
    Atom,
    Change,
    Duration,
    Eventually,
    Fall,
    Formula,
    Historically,
    Implies,
    Interval,
    Not,
    Once,
    Or,
    Rise,
    Since,
    TruthConstant,
    Until,
    WeakUntil,
    all_time,
)
from tachk.syntax.parsing.depth import measured
from tachk.syntax.parsing.misplaced import Misplaced
from tachk.syntax.parsing.tokens import Token
from tachk.syntax.walk import nodes_of_kind

_Prefix = type[Eventually] | type[Always] | type[Once] | type[Historically]
_PREFIX: dict[str, _Prefix] = {"F": Eventually, "G": Always, "O": Once, "H": Historically}


@dataclass(frozen=True, slots=True)
class TemporalExpression(ast.Node):
    """``operator`` is the letter or word of an operator; ``interval`` is None where there are no brackets."""

    operator: str
    interval: Interval | None
    operands: tuple[Any, ...]


@dataclass(frozen=True, slots=True)
class MalformedPart(ast.Node):
    """In place of an interval that is wrong. It is reported when the whole formula is read, for there reading can go on
    behind it."""

    diagnostic: Diagnostic


@dataclass(frozen=True, slots=True)
class WholeFormula(ast.Node):
    """A value in place of a formula, before `as_formula`."""

    expression: Any


class FormulaBuilder:
    """The callbacks of the rules of stl.lark."""

    def temporal(self, children: Children) -> TemporalExpression:
        letter, interval, operand = children
        return TemporalExpression(span_of(children), letter.text, interval, (operand,))

    def edge_operator(self, children: Children) -> TemporalExpression:
        word, _, operand, _ = children
        return TemporalExpression(span_of(children), word.text, None, (operand,))

    def until(self, children: Children) -> TemporalExpression:
        left, letter, interval, right = children
        return TemporalExpression(span_of(children), letter.text, interval, (left, right))

    def implies(self, children: Children) -> ast.BinaryExpression:
        return ast.BinaryExpression(span_of(children), BinaryOperator.IMPLY, children[0], children[2])

    def interval(self, children: Children) -> Interval | MalformedPart:
        opening, lower, _, upper, closing = children
        bound = None if isinstance(upper, Token) else upper
        for part in (lower, bound):
            if isinstance(part, MalformedPart):
                return part
        for one, other in () if bound is None else ((lower, bound), (bound, lower)):
            found = missing_unit(one, other)
            if found is not None:
                return MalformedPart(one.span, found)
        closed = bound is None or closing.text == "]"
        return Interval(span_of(children), lower, bound, opening.text == "[", closed)

    def half_interval(self, children: Children) -> MalformedPart:
        opening, *inside, closing = children
        span = span_of(children)
        if not inside:
            message, help_ = "there are no bounds in these brackets", "leave the brackets out, or write [0, 5]"
        elif len(inside) == 1:
            bound = inside[0].span.text
            message = "an interval has two bounds"
            help_ = f"write [0, {bound}] for 'within {bound}', [{bound}, {bound}] for 'after exactly {bound}'"
        else:
            message = "the bounds of an interval are separated by a comma"
            help_ = f"write {opening.text}{inside[0].span.text}, {inside[2].span.text}{closing.text}"
        return MalformedPart(span, Diagnostic("E0130", message, span, help_))

    def duration(self, children: Children) -> Duration | MalformedPart:
        from tachk.base.time_units import UNITS

        expression, unit = children
        if unit is not None and unit.text not in UNITS:
            return MalformedPart(unit.span, unknown_unit(unit.text, unit.span))
        return Duration(span_of(children), _number(expression), unit.text if unit is not None else "")

    def temporal_formula(self, children: Children) -> WholeFormula:
        return WholeFormula(children[1].span, children[1])

    def formula_fragment(self, children: Children) -> Formula:
        return as_formula(children[0])


def unknown_unit(unit: str, span: Span) -> Diagnostic:
    """The diagnostic for a word that is not a unit of time."""
    from tachk.base.time_units import SPELLINGS, UNITS

    meant = SPELLINGS.get(unit.lower()) or ("min" if unit == "m" else None)
    help_ = f"did you mean '{meant}'?" if meant else f"the units are {', '.join(UNITS)}"
    return Diagnostic("E0135", f"'{unit}' is not a unit of time", span, help_)


def missing_unit(bound: Duration, other: Duration) -> Diagnostic | None:
    """The error of a bound that is a number other than 0 without a unit, where the other bound has a unit.

    A constant of the model is in the model's unit.
    """
    if bound.unit or not other.unit or not isinstance(bound.value, Fraction) or bound.value == 0:
        return None
    help_ = f"write {bound.span.text} {other.unit}"
    return Diagnostic("E0134", "this bound has no unit, the other has one", bound.span, help_)


def _number(expression: ast.Expression) -> Fraction | ast.Expression:
    """The value of a literal; other expressions as they are."""
    match expression:
        case ast.IntegerLiteral(value=value):
            return Fraction(value)
        case ast.FloatLiteral(text=text):
            return Fraction(text)
        case ast.UnaryExpression(
            operator=PrefixOperator.MINUS, operand=ast.IntegerLiteral() | ast.FloatLiteral() as operand
        ):
            number = _number(operand)
            return -number if isinstance(number, Fraction) else expression
        case _:
            return expression


def as_formula(expression: Any) -> Formula:
    """The formula that an expression with temporal operators stands for.

    Raises:
        Misplaced: something in it cannot be part of a formula, or it is nested too deeply.
    """
    for found in measured(expression)[0]:
        raise Misplaced(found)
    for part in nodes_of_kind(expression, MalformedPart):
        raise Misplaced(part.diagnostic)
    return _formula(expression)


def _formula(node: Any) -> Formula:
    span = node.span
    match node:
        case TemporalExpression(operator="rise", operands=(operand,)):
            return Rise(span, _formula(operand))
        case TemporalExpression(operator="fall", operands=(operand,)):
            return Fall(span, _formula(operand))
        case TemporalExpression(operator="change", operands=(operand,)):
            return Change(span, _state_expression(operand, "'change' watches the value of an expression"))
        case TemporalExpression(operator="W", interval=Interval(span=place)):
            help_ = "write (p U[a, b] q) || G[0, b] p for a bounded one"
            raise Misplaced(Diagnostic("E0130", "'W' has no interval", place, help_))
        case TemporalExpression(operator="W", operands=(left, right)):
            return WeakUntil(span, _formula(left), _formula(right))
        case TemporalExpression(operator=letter, interval=interval, operands=operands):
            given = interval or all_time(span)
            if letter in _PREFIX:
                return _PREFIX[letter](span, given, _formula(operands[0]))
            kind = Until if letter == "U" else Since
            return kind(span, given, _formula(operands[0]), _formula(operands[1]))
        case ast.BooleanLiteral(value=value):
            return TruthConstant(span, value)
        case ast.UnaryExpression(operator=PrefixOperator.NOT):
            return _negation(node)
        case ast.BinaryExpression(operator=BinaryOperator.AND):
            return And(span, tuple(_conjuncts(node)))
        case ast.BinaryExpression(operator=BinaryOperator.OR | BinaryOperator.IMPLY):
            return _from_left(node)
        case ast.BinaryExpression(operator=BinaryOperator.XOR):
            return _exclusive(node)
        case _:
            return Atom(span, _state_expression(node, _why(node)))


def _conjuncts(node: Any) -> Iterator[Formula]:
    """The operands of a chain of ``&&``; parentheses within it mean nothing."""
    pending: list[Any] = [node]
    while pending:
        inner = pending.pop()
        if isinstance(inner, ast.BinaryExpression) and inner.operator is BinaryOperator.AND:
            pending += [inner.right, inner.left]
        else:
            yield _formula(inner)


def _from_left(node: Any) -> Formula:
    """A chain of ``||`` and ``imply``, which bind equally; parentheses among operands of ``||`` mean nothing."""
    links: list[ast.BinaryExpression] = []
    first: Any = node
    while isinstance(first, ast.BinaryExpression) and first.operator in (BinaryOperator.OR, BinaryOperator.IMPLY):
        links.append(first)
        first = first.left
    implications = sum(link.operator is BinaryOperator.IMPLY for link in links)
    if implications > LONGEST_FROM_LEFT and _is_state_expression(node):
        return Atom(node.span, _state_expression(node, _why(node)))
    formula = _formula(first)
    for link in reversed(links):
        if link.operator is BinaryOperator.OR:
            formula = Or(link.span, (*_operands(formula, Or), *_operands(_formula(link.right), Or)))
        else:
            formula = _implication(link, formula)
    return formula


def _operands(formula: Formula, kind: type[And] | type[Or]) -> tuple[Formula, ...]:
    return formula.operands if isinstance(formula, kind) else (formula,)


def _negation(node: ast.UnaryExpression) -> Formula:
    """A negation with one or two signs in place of many in a row, with the same meaning on every trace."""
    signs: list[Span] = []
    inner: Any = node
    while isinstance(inner, ast.UnaryExpression) and inner.operator is PrefixOperator.NOT:
        signs.append(inner.span)
        inner = inner.operand
    if len(signs) > LONGEST_FROM_LEFT:
        signs = signs[: 2 - len(signs) % 2]
    formula = _formula(inner)
    for span in reversed(signs):
        formula = Not(span, formula)
    return formula


def _implication(node: ast.BinaryExpression, left: Formula) -> Formula:
    """``a -> b -> c``: of many links as ``a && b -> c``, which means the same on every trace."""
    conditions = [(node.span, left)]
    last: Any = node.right
    while isinstance(last, ast.BinaryExpression) and last.operator is BinaryOperator.IMPLY:
        conditions.append((last.span, _formula(last.left)))
        last = last.right
    formula = _formula(last)
    if len(conditions) > LONGEST_FROM_LEFT:
        parts = [part for _, each in conditions for part in _operands(each, And)]
        span = Span(left.span.source, left.span.start, parts[-1].span.end)
        return Implies(node.span, And(span, tuple(parts)), formula)
    for span, each in reversed(conditions):
        formula = Implies(span, each, formula)
    return formula


def _exclusive(node: ast.BinaryExpression) -> Formula:
    """``a xor b`` as ``a && !b || !a && b``; chains of it would double at each step."""
    for operand in (node.left, node.right):
        inner = next(
            (n for n in nodes_of_kind(operand, ast.BinaryExpression) if n.operator == BinaryOperator.XOR), None
        )
        if inner is not None:
            if _is_state_expression(node):
                return Atom(node.span, _state_expression(node, _why(node)))
            message = "xor joins only two conditions where one of them is temporal"
            raise Misplaced(Diagnostic("E0132", message, inner.span, "name the inner one with a signal"))
    one, other = _formula(node.left), _formula(node.right)
    return Or(
        node.span,
        (
            And(node.span, (one, Not(one.span, other))),
            And(node.span, (Not(one.span, one), other)),
        ),
    )


def _is_state_expression(node: Any) -> bool:
    return next(nodes_of_kind(node, TemporalExpression), None) is None


def _why(node: ast.Expression) -> str:
    match node:
        case ast.QuantifierExpression(kind=kind):
            return f"the body of '{kind}' is a condition on one instant"
        case ast.CallExpression():
            return "the arguments of a call are values of one instant"
        case ast.BinaryExpression(operator=operator):
            return f"the operands of '{operator}' are values of one instant"
        case ast.ConditionalExpression():
            return "the parts of '? :' are values of one instant"
        case _:
            return "this is a value of one instant"


def _state_expression(node: Any, why: str) -> ast.Expression:
    """An expression over one state, which has no temporal operator."""
    for inner in nodes_of_kind(node, *_NOT_OF_ONE_STATE):
        match inner:
            case TemporalExpression(operator=operator):
                help_ = (
                    "write the property once for each value"
                    if isinstance(node, ast.QuantifierExpression)
                    else f"parentheses may be missing, or `{operator}` in backticks is meant, a signal of that name"
                )
                raise Misplaced(
                    Diagnostic("E0131", f"the operator '{operator}' cannot stand here: {why}", inner.span, help_)
                )
            case ast.AssignmentExpression(operator=None):
                raise Misplaced(Diagnostic("E0132", "'=' assigns a value", inner.span, "compare with =="))
            case ast.AssignmentExpression() | ast.IncrementExpression():
                raise Misplaced(Diagnostic("E0132", "a formula does not change variables", inner.span))
            case ast.DeadlockExpression():
                raise Misplaced(
                    Diagnostic(
                        "E0132",
                        "'deadlock' is not a condition on a run",
                        inner.span,
                        "ask for A[] not deadlock in a query of its own; `deadlock` in backticks is a signal",
                    )
                )
            case _:
                pass
    result: ast.Expression = node
    return result


_NOT_OF_ONE_STATE = (TemporalExpression, ast.AssignmentExpression, ast.IncrementExpression, ast.DeadlockExpression)
