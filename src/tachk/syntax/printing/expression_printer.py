"""Expressions and types as text, with no more parentheses than needed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import assert_never

from tachk.base.operators import BinaryOperator, PrefixOperator
from tachk.syntax import ast
from tachk.syntax.chains import LONGEST_FROM_LEFT, operands_of
from tachk.syntax.edge_clauses import Clause, ClauseKind

_LONGEST_QUOTED = 50
_QUANTIFIED, _ASSIGNED, _CONDITIONAL = 0, 1, 2
_PREFIXED, _POSTFIXED = 15, 16
"""Beside the levels of the binary operators."""


def print_expression(expression: ast.Expression) -> str:
    """The text of an expression; reading it again gives an equal tree."""
    return _print(expression, _QUANTIFIED, True)


def quoted(expression: ast.Expression) -> str:
    """An expression in a message, between backticks; the middle of a long one is left out."""
    text = print_expression(expression)
    return f"`{text}`" if len(text) <= _LONGEST_QUOTED else f"`{text[:24].rstrip()} ... {text[-12:].lstrip()}`"


def print_rate(rate: ast.Expression, divisor: ast.Expression | None) -> str:
    """The rate of an exponential distribution: ``r`` or ``r : q``."""
    return print_expression(rate) if divisor is None else f"{print_expression(rate)} : {print_expression(divisor)}"


def print_expressions(expressions: Sequence[ast.Expression]) -> str:
    return ", ".join(print_expression(expression) for expression in expressions)


def _print(expression: ast.Expression, least: int, open_right: bool) -> str:
    """The text of an expression as an operand.

    Args:
        least: the weakest binding that needs no parentheses here.
        open_right: whether nothing follows that the body of a quantifier would take in.
    """
    level, closed = _level(expression)
    if level >= least or (level == _QUANTIFIED and open_right and least <= _PREFIXED):
        return _text(expression, open_right)
    assert not closed
    return f"({_text(expression, True)})"


def _level(expression: ast.Expression) -> tuple[int, bool]:
    """The precedence of an expression, and whether it is an operand as it is."""
    match expression:
        case ast.QuantifierExpression():
            return _QUANTIFIED, False
        case ast.AssignmentExpression():
            return _ASSIGNED, False
        case ast.ConditionalExpression():
            return _CONDITIONAL, False
        case ast.BinaryExpression():
            return expression.operator.level, False
        case ast.UnaryExpression() | ast.SpawnExpression():
            return _PREFIXED, False
        case ast.IncrementExpression():
            return (_PREFIXED if expression.prefix else _POSTFIXED), False
        case ast.IntegerLiteral():
            return (_PREFIXED if expression.value < 0 else _POSTFIXED), False
        case _:
            return _POSTFIXED, True


def _text(expression: ast.Expression, open_right: bool) -> str:
    match expression:
        case ast.NameExpression(name=name):
            return name
        case ast.IntegerLiteral(name=name) if name:
            return name
        case ast.IntegerLiteral(value=value):
            return str(value)
        case ast.FloatLiteral(text=text):
            return text
        case ast.BooleanLiteral(value=value):
            return "true" if value else "false"
        case ast.StringLiteral(value=value):
            return f'"{value}"'
        case ast.DeadlockExpression():
            return "deadlock"
        case ast.UnaryExpression(operator=operator, operand=operand):
            inner = _print(operand, _PREFIXED, open_right)
            if not inner.startswith(operator) or operator is PrefixOperator.NOT:
                return operator + inner
            return f"{operator} {inner}" if _is_long(operand) else f"{operator}({inner})"
        case ast.BinaryExpression(operator=operator):
            level = operator.level
            head, *others, last = operands_of(expression)
            return f" {operator} ".join(
                (
                    _print(head, level + needs_parentheses(head, operator), False),
                    *(_print(operand, level + 1, False) for operand in others),
                    _print(last, level + 1, open_right),
                )
            )
        case ast.AssignmentExpression(operator=operator, target=target, value=value):
            return f"{_print(target, _CONDITIONAL, False)} {operator or ''}= {_print(value, _ASSIGNED, open_right)}"
        case ast.IncrementExpression(operator=operator, prefix=True, target=target):
            return operator + _print(target, _PREFIXED, open_right)
        case ast.IncrementExpression(operator=operator, target=target):
            return _print(target, _POSTFIXED, False) + operator
        case ast.ConditionalExpression(condition=condition, then=then, otherwise=otherwise):
            first = _print(condition, _CONDITIONAL + 1, False)
            second = _print(then, _QUANTIFIED, True)
            return f"{first} ? {second} : {_print(otherwise, _CONDITIONAL, open_right)}"
        case ast.CallExpression(function=function, arguments=arguments):
            return f"{_print(function, _POSTFIXED, False)}({print_expressions(arguments)})"
        case ast.IndexExpression(base=base, index=index):
            return f"{_print(base, _POSTFIXED, False)}[{print_expression(index)}]"
        case ast.MemberExpression(base=base, name=name):
            return f"{_print(base, _POSTFIXED, False)}.{name.name}"
        case ast.RateExpression(clock=clock):
            return f"{_print(clock, _POSTFIXED, False)}'"
        case ast.QuantifierExpression(kind=kind, variable=variable, type=type_, body=body):
            return f"{kind} ({variable.name} : {print_type(type_)}) {_print(body, _QUANTIFIED, open_right)}"
        case ast.SpawnExpression(template=template, arguments=arguments):
            return f"spawn {template.name}({print_expressions(arguments)})"
        case ast.InitialiserList(items=items):
            return "{ " + ", ".join(_initialiser(name, value) for name, value in items) + " }"
        case _:
            assert_never(expression)


def _is_long(operand: ast.Expression) -> bool:
    """True if so many signs stand before an operand that parentheses would be nested too deeply."""
    for _ in range(LONGEST_FROM_LEFT):
        if not isinstance(operand, ast.UnaryExpression):
            return False
        operand = operand.operand
    return True


def needs_parentheses(first: ast.Expression, operator: BinaryOperator) -> bool:
    """True if the first operand of a chain must not become a part of it."""
    return operator.associative and isinstance(first, ast.BinaryExpression) and first.operator == operator


def _initialiser(name: ast.Identifier | None, value: ast.Expression) -> str:
    return print_expression(value) if name is None else f"{name.name}: {print_expression(value)}"


def print_type(type_: ast.TypeExpression) -> str:
    """The text of a type on one line."""
    return " ".join((*type_.prefixes, _print_base(type_.base)))


def _print_base(
    base: ast.BuiltinType | ast.RangeType | ast.ScalarSetType | ast.StructType | ast.NamedType,
) -> str:
    match base:
        case ast.BuiltinType(name=name) | ast.NamedType(name=name):
            return name
        case ast.RangeType(low=low, high=high):
            return f"int[{print_expression(low)}, {print_expression(high)}]"
        case ast.ScalarSetType(size=size):
            return f"scalar[{print_expression(size)}]"
        case ast.StructType(fields=fields):
            return "struct { " + " ".join(print_variables(field) for field in fields) + " }"
        case _:
            assert_never(base)


def print_declarator(declarator: ast.Declarator) -> str:
    text = declarator.name.name + print_dimensions(declarator.dimensions)
    if declarator.initialiser is not None:
        text += f" = {print_expression(declarator.initialiser)}"
    return text


def print_dimensions(dimensions: Sequence[ast.Expression | ast.TypeExpression]) -> str:
    return "".join(
        f"[{print_type(dimension) if isinstance(dimension, ast.TypeExpression) else print_expression(dimension)}]"
        for dimension in dimensions
    )


def print_variables(declaration: ast.VariableDeclaration) -> str:
    """``type a, b = 1;`` on one line."""
    type_ = print_type(declaration.type) if declaration.type is not None else "const int"
    return f"{type_} {', '.join(print_declarator(d) for d in declaration.declarators)};"


def print_parameters(parameters: Sequence[ast.Parameter]) -> str:
    return ", ".join(
        f"{print_type(p.type)} {'&' if p.reference else ''}{p.name.name}{print_dimensions(p.dimensions)}"
        for p in parameters
    )


def print_clause(clause: Clause) -> str:
    """A clause of an edge without its word."""
    match clause.kind:
        case ClauseKind.SELECT:
            return ", ".join(f"{binding.name.name} : {print_type(binding.type)}" for binding in clause.value)
        case ClauseKind.GUARD | ClauseKind.PROBABILITY:
            return print_expression(clause.value)
        case ClauseKind.SYNCHRONISATION:
            return print_synchronisation(clause.value)
        case ClauseKind.UPDATES:
            return print_expressions(clause.value)
        case never:
            assert_never(never)


def print_synchronisation(label: ast.SynchronisationLabel) -> str:
    value = print_expression(label.value) if label.value is not None else ""
    channel = print_expression(label.channel)
    if not isinstance(label.channel, ast.NameExpression | ast.IndexExpression | ast.MemberExpression):
        channel = f"({channel})"
    return f"{channel}{label.direction or ''}{value}"
