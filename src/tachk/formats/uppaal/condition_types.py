"""What UPPAAL takes for a guard, an invariant or the predicate of a query: the types of its open parser.

A condition without clocks is a number. Comparisons of clocks are INVARIANT or, as `==`, GUARD; what is joined of them
has the weakest type of its parts, and below ``!`` it is a CONSTRAINT, which only queries take. Source: the function
``checkExpression`` of UTAP 2.1.1 (``src/TypeChecker.cpp``).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from enum import IntEnum

from tachk.diagnostics.diagnostic import Diagnostic
from tachk.formats.plain.text_types import TextTypes, text_types
from tachk.operators import BinaryOperator, PrefixOperator
from tachk.syntax import ast
from tachk.syntax.walk import nodes_of_kind


class Kind(IntEnum):
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


_INTEGRAL = (Kind.INTEGER, Kind.BOOLEAN)
_BOUND = (Kind.INTEGER, Kind.DOUBLE)
_NUMBER = (*_INTEGRAL, Kind.DOUBLE, Kind.CLOCK, Kind.DIFFERENCE)
_INVARIANT = (*_INTEGRAL, Kind.INVARIANT)
_RATED = (*_INVARIANT, Kind.RATED)
_GUARD = (*_INVARIANT, Kind.GUARD)
_CONSTRAINT = (*_GUARD, Kind.CONSTRAINT)
_DECLARED = {"clock": Kind.CLOCK, "int": Kind.INTEGER, "bool": Kind.BOOLEAN, "double": Kind.DOUBLE}
_ONLY_INTEGERS = frozenset("%&|^") | {"<<", ">>"}
_MEND = "`tachk export` writes it with `&&` and `||`"


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
                yield _refused("a guard", edge.guard, version)
    for item in listed:
        if isinstance(item, ast.PropertyDeclaration) and isinstance(item.formula, ast.QueryFormula):
            for predicate in (item.formula.predicate, *item.formula.operands):
                if predicate is not None and kind_of(predicate, names) is Kind.WRONG:
                    yield _refused("a query", predicate, version)


def _invariant(invariant: ast.Expression, names: TextTypes, version: str) -> Iterator[Diagnostic]:
    if _takes(invariant, names, _RATED):
        return
    compared = nodes_of_kind(invariant, ast.BinaryExpression)
    equal = [n for n in compared if n.operator is BinaryOperator.EQUAL and kind_of(n, names) is Kind.GUARD]
    for node in equal:
        message = f"{version} does not take a clock that equals something as an invariant"
        mend = "write `<=`; a lower bound belongs into the guards of the edges that lead here"
        yield Diagnostic("E0818", message, node.span, mend)
    if not equal or kind_of(invariant, names) is not Kind.GUARD:
        yield _refused("an invariant", invariant, version)


def _refused(what: str, condition: ast.Expression, version: str) -> Diagnostic:
    return Diagnostic("E0823", f"{version} does not take this condition about clocks in {what}", condition.span, _MEND)


def _takes(condition: ast.Expression, names: TextTypes, kinds: tuple[Kind, ...]) -> bool:
    return kind_of(condition, names) in (*kinds, Kind.OTHER)


def kind_of(node: ast.Expression, names: TextTypes) -> Kind:
    """The type of an expression for UPPAAL."""
    match node:
        case ast.NameExpression() | ast.IndexExpression() | ast.MemberExpression():
            # What is not declared as a variable is a location, a signal or a constant that UPPAAL declares itself.
            found = names.place(node)
            return Kind.INTEGER if found is None else _DECLARED.get(names.base_of(found), Kind.OTHER)
        case ast.IntegerLiteral() | ast.IncrementExpression():
            return Kind.INTEGER
        case ast.BooleanLiteral():
            return Kind.BOOLEAN
        case ast.FloatLiteral():
            return Kind.DOUBLE
        case ast.RateExpression():
            return Kind.RATE
        case ast.DeadlockExpression():
            return Kind.CONSTRAINT
        case ast.CallExpression(function=ast.NameExpression(name=name)) if name in names.results:
            result = names.results[name].base
            return _DECLARED.get(result.name, Kind.OTHER) if isinstance(result, ast.BuiltinType) else Kind.OTHER
        case ast.UnaryExpression(operator=operator, operand=operand):
            return _unary(operator, kind_of(operand, names))
        case ast.BinaryExpression(operator=operator, left=left, right=right):
            return _binary(operator, kind_of(left, names), kind_of(right, names))
        case ast.ConditionalExpression(condition=condition, then=then, otherwise=otherwise):
            return _conditional(*(kind_of(part, names) for part in (condition, then, otherwise)))
        case ast.QuantifierExpression(kind=kind, variable=variable, type=type_, body=body):
            return _quantified(kind, kind_of(body, names.binding(variable.name, type_)))
        case _:
            return Kind.OTHER


def _unary(operator: PrefixOperator, operand: Kind) -> Kind:
    if operand in (Kind.WRONG, Kind.OTHER):
        return operand
    if operator is PrefixOperator.NOT:
        if operand in _INTEGRAL:
            return Kind.BOOLEAN
        return Kind.CONSTRAINT if operand in _CONSTRAINT else Kind.WRONG
    if operand in _INTEGRAL:
        return Kind.INTEGER
    return Kind.DOUBLE if operand in _NUMBER else Kind.WRONG


def _binary(operator: BinaryOperator, left: Kind, right: Kind) -> Kind:
    if Kind.WRONG in (left, right):
        return Kind.WRONG
    if Kind.OTHER in (left, right):
        return Kind.OTHER
    match operator:
        case BinaryOperator.AND:
            return next((kind for kinds, kind in _CONJUNCTIONS if left in kinds and right in kinds), Kind.WRONG)
        case BinaryOperator.OR:
            return _disjunction(left, right)
        case BinaryOperator.IMPLY:
            return _disjunction(_unary(PrefixOperator.NOT, left), right)
        case BinaryOperator.XOR:
            return Kind.BOOLEAN if left in _INTEGRAL and right in _INTEGRAL else Kind.WRONG
        case BinaryOperator.EQUAL | BinaryOperator.NOT_EQUAL:
            return _equality(operator, left, right)
        case BinaryOperator.LESS | BinaryOperator.LESS_EQUAL:
            return _order(left, right, _BOUND)
        case BinaryOperator.GREATER | BinaryOperator.GREATER_EQUAL:
            return _order(left, right, (Kind.INTEGER,))
        case _:
            return _arithmetic(operator, left, right)


_CONJUNCTIONS = (
    (_INTEGRAL, Kind.BOOLEAN),
    (_INVARIANT, Kind.INVARIANT),
    (_RATED, Kind.RATED),
    (_GUARD, Kind.GUARD),
    (_CONSTRAINT, Kind.CONSTRAINT),
)


def _disjunction(left: Kind, right: Kind) -> Kind:
    if Kind.WRONG in (left, right):
        return Kind.WRONG
    if left in _INTEGRAL and right in _INTEGRAL:
        return Kind.BOOLEAN
    if left in _INTEGRAL or right in _INTEGRAL:
        timed = right if left in _INTEGRAL else left
        if timed in (Kind.INVARIANT, Kind.RATED, Kind.GUARD):
            return timed
    return Kind.CONSTRAINT if left in _CONSTRAINT and right in _CONSTRAINT else Kind.WRONG


def _equality(operator: BinaryOperator, left: Kind, right: Kind) -> Kind:
    if left in _INTEGRAL and right in _INTEGRAL:
        return Kind.BOOLEAN
    if Kind.RATE in (left, right):
        other = right if left is Kind.RATE else left
        return Kind.RATED if operator is BinaryOperator.EQUAL and other in _NUMBER else Kind.WRONG
    if left not in _NUMBER or right not in _NUMBER:
        return Kind.WRONG
    timed = (Kind.CLOCK, Kind.DIFFERENCE)
    if left in timed or right in timed:
        return Kind.GUARD if operator is BinaryOperator.EQUAL else Kind.CONSTRAINT
    return Kind.BOOLEAN


def _order(left: Kind, right: Kind, bounds: tuple[Kind, ...]) -> Kind:
    if left in _INTEGRAL and right in _INTEGRAL:
        return Kind.BOOLEAN
    for one, other in ((left, right), (right, left)):
        if (one is Kind.CLOCK and other in (Kind.CLOCK, *bounds)) or (one is Kind.DIFFERENCE and other in bounds):
            return Kind.INVARIANT
    if left not in _NUMBER or right not in _NUMBER:
        return Kind.WRONG
    return Kind.GUARD if Kind.CLOCK in (left, right) else Kind.BOOLEAN


def _arithmetic(operator: BinaryOperator, left: Kind, right: Kind) -> Kind:
    if left in _INTEGRAL and right in _INTEGRAL:
        return Kind.INTEGER
    if operator in _ONLY_INTEGERS or left not in _NUMBER or right not in _NUMBER:
        return Kind.WRONG
    pair = {left, right}
    if operator is BinaryOperator.ADD and pair == {Kind.CLOCK, Kind.INTEGER}:
        return Kind.CLOCK
    if operator is BinaryOperator.SUBTRACT and (left, right) == (Kind.CLOCK, Kind.INTEGER):
        return Kind.CLOCK
    if operator is BinaryOperator.SUBTRACT and pair == {Kind.CLOCK}:
        return Kind.DIFFERENCE
    if operator in (BinaryOperator.ADD, BinaryOperator.SUBTRACT) and pair == {Kind.DIFFERENCE, Kind.INTEGER}:
        return Kind.DIFFERENCE
    return Kind.DOUBLE


def _conditional(condition: Kind, then: Kind, otherwise: Kind) -> Kind:
    if Kind.WRONG in (condition, then, otherwise) or condition not in (*_GUARD, Kind.OTHER):
        return Kind.WRONG
    if Kind.OTHER in (then, otherwise):
        return Kind.OTHER
    if then in _INTEGRAL and otherwise in _INTEGRAL:
        return then
    values = (*_INTEGRAL, Kind.CLOCK, Kind.DOUBLE)
    if then in values and otherwise in values:
        return Kind.CLOCK if then is otherwise is Kind.CLOCK else Kind.DOUBLE
    return Kind.WRONG


def _quantified(kind: str, body: Kind) -> Kind:
    if body in (Kind.OTHER, Kind.WRONG):
        return body
    if kind == "sum":
        return Kind.INTEGER if body in _INTEGRAL else Kind.DOUBLE if body in _NUMBER else Kind.WRONG
    if kind not in ("forall", "exists"):
        return Kind.OTHER
    if body in _INTEGRAL:
        return Kind.BOOLEAN
    if kind == "forall" and body in (*_CONSTRAINT, Kind.RATED):
        return body
    return Kind.CONSTRAINT if body in _CONSTRAINT else Kind.WRONG
