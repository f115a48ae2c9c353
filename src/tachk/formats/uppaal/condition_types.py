"""The types of conditions in UPPAAL's open parser: guards, invariants and predicates of queries.

A condition without clocks is a number. Comparisons of clocks are INVARIANT or, as `==`, GUARD; what is joined of them
has the weakest type of its parts, and below ``!`` it is a CONSTRAINT, which only queries take. Source: the function
``checkExpression`` of UTAP 2.1.1 (``src/TypeChecker.cpp``).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from enum import IntEnum

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.operators import BinaryOperator, PrefixOperator
from tachk.formats.plain.text_types import TextTypes, text_types
from tachk.syntax import ast
from tachk.syntax.walk import nodes_of_kind


class ConditionKind(IntEnum):
    """The types of expressions, as far as conditions depend on them. From INTEGER to CONSTRAINT, what is a type is also
    each later one."""

    OTHER = 0
    """A record, an array, a text or an unknown type: the checker reports nothing about it."""
    CLOCK = 1
    DIFFERENCE = 2
    DOUBLE = 3
    RATE = 4
    INTEGER = 5
    BOOLEAN = 6
    INVARIANT = 7
    RATED = 8
    """An invariant that also says how fast clocks run."""
    GUARD = 9
    CONSTRAINT = 10
    WRONG = 11
    """UPPAAL refuses the expression itself."""


_INTEGRAL = (ConditionKind.INTEGER, ConditionKind.BOOLEAN)
_BOUND = (ConditionKind.INTEGER, ConditionKind.DOUBLE)
_NUMBER = (*_INTEGRAL, ConditionKind.DOUBLE, ConditionKind.CLOCK, ConditionKind.DIFFERENCE)
_INVARIANT = (*_INTEGRAL, ConditionKind.INVARIANT)
_RATED = (*_INVARIANT, ConditionKind.RATED)
_GUARD = (*_INVARIANT, ConditionKind.GUARD)
_CONSTRAINT = (*_GUARD, ConditionKind.CONSTRAINT)
_DECLARED = {
    "clock": ConditionKind.CLOCK,
    "int": ConditionKind.INTEGER,
    "bool": ConditionKind.BOOLEAN,
    "double": ConditionKind.DOUBLE,
}
_ONLY_INTEGERS = frozenset("%&|^") | {"<<", ">>"}
_MEND = "`tachk convert` writes it with `&&` and `||`"


def condition_findings(items: Iterable[ast.Item], version: str) -> Iterator[Diagnostic]:
    """One error for each guard, invariant and query whose type the version would refuse."""
    listed = tuple(items)
    names = text_types(listed)
    for template in (item for item in listed if isinstance(item, ast.Template)):
        inside = names.within(template.declarations, template.parameters)
        for location in template.locations:
            if location.invariant is not None:
                yield from _invariant(location.invariant, inside, version)
        owners: tuple[ast.LocationDeclaration | ast.Branchpoint, ...] = (*template.locations, *template.branchpoints)
        for edge in (*template.edges, *(edge for owner in owners for edge in owner.edges)):
            local = inside
            for binding in edge.selects:
                local = local.binding(binding.name.name, binding.type)
            if edge.guard is not None and not _takes(edge.guard, local, _GUARD):
                yield _rejected("a guard", edge.guard, version)
    for item in listed:
        if isinstance(item, ast.PropertyDeclaration) and isinstance(item.formula, ast.QueryFormula):
            for predicate in (item.formula.predicate, *item.formula.operands):
                if predicate is not None and kind_of(predicate, names) is ConditionKind.WRONG:
                    yield _rejected("a query", predicate, version)


def _invariant(invariant: ast.Expression, names: TextTypes, version: str) -> Iterator[Diagnostic]:
    if _takes(invariant, names, _RATED):
        return
    compared = nodes_of_kind(invariant, ast.BinaryExpression)
    equal = [n for n in compared if n.operator is BinaryOperator.EQUAL and kind_of(n, names) is ConditionKind.GUARD]
    for node in equal:
        message = f"{version} does not take a clock that equals something as an invariant"
        mend = "write `<=`; a lower bound belongs into the guards of the edges that lead here"
        yield Diagnostic("E0818", message, node.span, mend)
    if not equal or kind_of(invariant, names) is not ConditionKind.GUARD:
        yield _rejected("an invariant", invariant, version)


def _rejected(what: str, condition: ast.Expression, version: str) -> Diagnostic:
    return Diagnostic("E0823", f"{version} does not take this condition about clocks in {what}", condition.span, _MEND)


def _takes(condition: ast.Expression, names: TextTypes, kinds: tuple[ConditionKind, ...]) -> bool:
    return kind_of(condition, names) in (*kinds, ConditionKind.OTHER)


def kind_of(node: ast.Expression, names: TextTypes) -> ConditionKind:
    """The type of an expression for UPPAAL."""
    match node:
        case ast.NameExpression() | ast.IndexExpression() | ast.MemberExpression():
            # A name that is not a variable is a location, a signal or a constant that UPPAAL declares itself.
            found = names.place(node)
            return ConditionKind.INTEGER if found is None else _DECLARED.get(names.base_of(found), ConditionKind.OTHER)
        case ast.IntegerLiteral() | ast.IncrementExpression():
            return ConditionKind.INTEGER
        case ast.BooleanLiteral():
            return ConditionKind.BOOLEAN
        case ast.FloatLiteral():
            return ConditionKind.DOUBLE
        case ast.RateExpression():
            return ConditionKind.RATE
        case ast.DeadlockExpression():
            return ConditionKind.CONSTRAINT
        case ast.CallExpression(function=ast.NameExpression(name=name)) if name in names.results:
            result = names.results[name].base
            return (
                _DECLARED.get(result.name, ConditionKind.OTHER)
                if isinstance(result, ast.BuiltinType)
                else ConditionKind.OTHER
            )
        case ast.UnaryExpression(operator=operator, operand=operand):
            return _unary(operator, kind_of(operand, names))
        case ast.BinaryExpression(operator=operator, left=left, right=right):
            return _binary(operator, kind_of(left, names), kind_of(right, names))
        case ast.ConditionalExpression(condition=condition, then=then, otherwise=otherwise):
            return _conditional(*(kind_of(part, names) for part in (condition, then, otherwise)))
        case ast.QuantifierExpression(kind=kind, variable=variable, type=type_, body=body):
            return _quantified(kind, kind_of(body, names.binding(variable.name, type_)))
        case _:
            return ConditionKind.OTHER


def _unary(operator: PrefixOperator, operand: ConditionKind) -> ConditionKind:
    if operand in (ConditionKind.WRONG, ConditionKind.OTHER):
        return operand
    if operator is PrefixOperator.NOT:
        if operand in _INTEGRAL:
            return ConditionKind.BOOLEAN
        return ConditionKind.CONSTRAINT if operand in _CONSTRAINT else ConditionKind.WRONG
    if operand in _INTEGRAL:
        return ConditionKind.INTEGER
    return ConditionKind.DOUBLE if operand in _NUMBER else ConditionKind.WRONG


def _binary(operator: BinaryOperator, left: ConditionKind, right: ConditionKind) -> ConditionKind:
    if ConditionKind.WRONG in (left, right):
        return ConditionKind.WRONG
    if ConditionKind.OTHER in (left, right):
        return ConditionKind.OTHER
    match operator:
        case BinaryOperator.AND:
            return next(
                (kind for kinds, kind in _CONJUNCTIONS if left in kinds and right in kinds), ConditionKind.WRONG
            )
        case BinaryOperator.OR:
            return _disjunction(left, right)
        case BinaryOperator.IMPLY:
            return _disjunction(_unary(PrefixOperator.NOT, left), right)
        case BinaryOperator.XOR:
            return ConditionKind.BOOLEAN if left in _INTEGRAL and right in _INTEGRAL else ConditionKind.WRONG
        case BinaryOperator.EQUAL | BinaryOperator.NOT_EQUAL:
            return _equality(operator, left, right)
        case BinaryOperator.LESS | BinaryOperator.LESS_EQUAL:
            return _order(left, right, _BOUND)
        case BinaryOperator.GREATER | BinaryOperator.GREATER_EQUAL:
            return _order(left, right, (ConditionKind.INTEGER,))
        case _:
            return _arithmetic(operator, left, right)


_CONJUNCTIONS = (
    (_INTEGRAL, ConditionKind.BOOLEAN),
    (_INVARIANT, ConditionKind.INVARIANT),
    (_RATED, ConditionKind.RATED),
    (_GUARD, ConditionKind.GUARD),
    (_CONSTRAINT, ConditionKind.CONSTRAINT),
)


def _disjunction(left: ConditionKind, right: ConditionKind) -> ConditionKind:
    if ConditionKind.WRONG in (left, right):
        return ConditionKind.WRONG
    if left in _INTEGRAL and right in _INTEGRAL:
        return ConditionKind.BOOLEAN
    if left in _INTEGRAL or right in _INTEGRAL:
        timed = right if left in _INTEGRAL else left
        if timed in (ConditionKind.INVARIANT, ConditionKind.RATED, ConditionKind.GUARD):
            return timed
    return ConditionKind.CONSTRAINT if left in _CONSTRAINT and right in _CONSTRAINT else ConditionKind.WRONG


def _equality(operator: BinaryOperator, left: ConditionKind, right: ConditionKind) -> ConditionKind:
    if left in _INTEGRAL and right in _INTEGRAL:
        return ConditionKind.BOOLEAN
    if ConditionKind.RATE in (left, right):
        other = right if left is ConditionKind.RATE else left
        return ConditionKind.RATED if operator is BinaryOperator.EQUAL and other in _NUMBER else ConditionKind.WRONG
    if left not in _NUMBER or right not in _NUMBER:
        return ConditionKind.WRONG
    timed = (ConditionKind.CLOCK, ConditionKind.DIFFERENCE)
    if left in timed or right in timed:
        return ConditionKind.GUARD if operator is BinaryOperator.EQUAL else ConditionKind.CONSTRAINT
    return ConditionKind.BOOLEAN


def _order(left: ConditionKind, right: ConditionKind, bounds: tuple[ConditionKind, ...]) -> ConditionKind:
    if left in _INTEGRAL and right in _INTEGRAL:
        return ConditionKind.BOOLEAN
    for one, other in ((left, right), (right, left)):
        if (one is ConditionKind.CLOCK and other in (ConditionKind.CLOCK, *bounds)) or (
            one is ConditionKind.DIFFERENCE and other in bounds
        ):
            return ConditionKind.INVARIANT
    if left not in _NUMBER or right not in _NUMBER:
        return ConditionKind.WRONG
    return ConditionKind.GUARD if ConditionKind.CLOCK in (left, right) else ConditionKind.BOOLEAN


def _arithmetic(operator: BinaryOperator, left: ConditionKind, right: ConditionKind) -> ConditionKind:
    if left in _INTEGRAL and right in _INTEGRAL:
        return ConditionKind.INTEGER
    if operator in _ONLY_INTEGERS or left not in _NUMBER or right not in _NUMBER:
        return ConditionKind.WRONG
    pair = {left, right}
    if operator is BinaryOperator.ADD and pair == {ConditionKind.CLOCK, ConditionKind.INTEGER}:
        return ConditionKind.CLOCK
    if operator is BinaryOperator.SUBTRACT and (left, right) == (ConditionKind.CLOCK, ConditionKind.INTEGER):
        return ConditionKind.CLOCK
    if operator is BinaryOperator.SUBTRACT and pair == {ConditionKind.CLOCK}:
        return ConditionKind.DIFFERENCE
    if operator in (BinaryOperator.ADD, BinaryOperator.SUBTRACT) and pair == {
        ConditionKind.DIFFERENCE,
        ConditionKind.INTEGER,
    }:
        return ConditionKind.DIFFERENCE
    return ConditionKind.DOUBLE


def _conditional(condition: ConditionKind, then: ConditionKind, otherwise: ConditionKind) -> ConditionKind:
    if ConditionKind.WRONG in (condition, then, otherwise) or condition not in (*_GUARD, ConditionKind.OTHER):
        return ConditionKind.WRONG
    if ConditionKind.OTHER in (then, otherwise):
        return ConditionKind.OTHER
    if then in _INTEGRAL and otherwise in _INTEGRAL:
        return then
    values = (*_INTEGRAL, ConditionKind.CLOCK, ConditionKind.DOUBLE)
    if then in values and otherwise in values:
        return ConditionKind.CLOCK if then is otherwise is ConditionKind.CLOCK else ConditionKind.DOUBLE
    return ConditionKind.WRONG


def _quantified(kind: str, body: ConditionKind) -> ConditionKind:
    if body in (ConditionKind.OTHER, ConditionKind.WRONG):
        return body
    if kind == "sum":
        return (
            ConditionKind.INTEGER
            if body in _INTEGRAL
            else ConditionKind.DOUBLE
            if body in _NUMBER
            else ConditionKind.WRONG
        )
    if kind not in ("forall", "exists"):
        return ConditionKind.OTHER
    if body in _INTEGRAL:
        return ConditionKind.BOOLEAN
    if kind == "forall" and body in (*_CONSTRAINT, ConditionKind.RATED):
        return body
    return ConditionKind.CONSTRAINT if body in _CONSTRAINT else ConditionKind.WRONG
