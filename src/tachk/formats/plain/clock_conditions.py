"""Conditions about clocks in the form that UPPAAL reads.

UPPAAL takes a conjunction of comparisons and of conditions without clocks; a disjunction or an implication may have
clocks on one side, not left of ``imply``. It does not take them below ``!`` and ``?:`` in guards and invariants, below
``?:`` and ``==`` in queries, and no ``x == e`` in invariants. Negations are pushed inwards here, the rest is written
with ``&&`` and ``||``. What UPPAAL reads stays as it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from tachk.base.operators import BinaryOperator, OperandGroup, PrefixOperator
from tachk.formats.plain.plain_model import PlainModel, PlainQuery, PlainRewriting
from tachk.formats.plain.text_types import TextTypes, text_types
from tachk.syntax import ast
from tachk.syntax.printing.expression_printer import print_expression

_AND, _OR, _IMPLY = BinaryOperator.AND, BinaryOperator.OR, BinaryOperator.IMPLY
_JOINING = (_AND, _OR, _IMPLY)


def with_plain_conditions(plain: PlainModel) -> PlainModel:
    """The model with every guard, invariant and query in that form."""
    names = text_types((*plain.declarations, *plain.templates, *plain.instantiations))
    steps: list[PlainRewriting] = []
    templates = tuple(_template(template, names, steps) for template in plain.templates)
    queries = tuple(_query(query, names, steps) for query in plain.queries)
    if not steps:
        return plain
    return replace(plain, templates=templates, queries=queries, steps=(*plain.steps, *steps))


def _template(template: ast.Template, names: TextTypes, steps: list[PlainRewriting]) -> ast.Template:
    inside = names.within(template.declarations, template.parameters)
    locations = tuple(
        _changed(location, "invariant", _ConditionRewriting(inside, invariant=True), steps)
        for location in template.locations
    )
    edges = []
    for edge in template.edges:
        local = inside
        for binding in edge.selects:
            local = local.binding(binding.name.name, binding.type)
        edges.append(_changed(edge, "guard", _ConditionRewriting(local), steps))
    return replace(template, locations=locations, edges=tuple(edges))


def _changed(node: Any, field: str, former: _ConditionRewriting, steps: list[PlainRewriting]) -> Any:
    old = getattr(node, field)
    if old is None or not former.names.mentions_clock(old):
        return node
    new = former.formed(old, True)
    if new is old:
        return node
    steps.append(PlainRewriting("condition", old.span, f"`{print_expression(old)}` is `{print_expression(new)}`"))
    return replace(node, **{field: new})


def _query(query: PlainQuery, names: TextTypes, steps: list[PlainRewriting]) -> PlainQuery:
    formula = query.formula
    if not isinstance(formula, ast.QueryFormula):
        return query
    if not any(names.mentions_clock(part) for part in (formula.predicate, *formula.operands)):
        return query
    former = _ConditionRewriting(names, query=True)
    operands = tuple(former.formed(operand, True) for operand in formula.operands)
    predicate = None if formula.predicate is None else former.formed(formula.predicate, True)
    if predicate is formula.predicate and _same(operands, formula.operands):
        return query
    steps.append(PlainRewriting("condition", formula.span, f"`{query.name}` asks without `?:` and `==` about clocks"))
    return replace(query, formula=replace(formula, predicate=predicate, operands=operands))


def _same(new: Sequence[object], old: Sequence[object]) -> bool:
    return all(one is other for one, other in zip(new, old, strict=True))


@dataclass(frozen=True, slots=True)
class _ConditionRewriting:
    """Brings conditions into the form.

    Attributes:
        invariant: what is formed is an invariant, which has upper and lower bounds only.
        query: what is formed is a query, in which UPPAAL takes negations and disjunctions of clocks.
    """

    names: TextTypes
    invariant: bool = False
    query: bool = False

    def formed(self, node: ast.Expression, positive: bool) -> ast.Expression:
        """The condition, or its negation where ``positive`` is false; the node itself where nothing is to change."""
        if not self._is_condition(node):
            return node if positive else _negated(node)
        match node:
            case ast.UnaryExpression(operator=PrefixOperator.NOT, operand=operand):
                if not self.query:
                    return self.formed(operand, not positive)
                inner = self.formed(operand, True)
                whole = node if inner is operand else replace(node, operand=inner)
                return whole if positive else inner
            case ast.BinaryExpression(operator=operator) if operator in _JOINING:
                return self._joined(node, positive)
            case ast.BinaryExpression(operator=operator) if operator.group is not OperandGroup.COMPARISON:
                return self._compared(node, positive)  # xor
            case ast.BinaryExpression(left=left, right=right):
                if self._is_condition(left) or self._is_condition(right):
                    return self._compared(node, positive)
                return self._comparison(node, positive)
            case ast.ConditionalExpression(condition=condition, then=then, otherwise=otherwise):
                first = _join(_OR, self.formed(condition, False), self.formed(then, positive))
                second = _join(_OR, self.formed(condition, True), self.formed(otherwise, positive))
                return _join(_AND, first, second)
            case ast.QuantifierExpression():
                return self._quantified(node, positive)
            case _:
                return node if positive else _negated(node)

    def _joined(self, node: ast.BinaryExpression, positive: bool) -> ast.Expression:
        operator, left, right = node.operator, node.left, node.right
        if self.query and not positive:
            return _negated(self._joined(node, True))
        turned = operator is _IMPLY and not self.query and self._is_condition(left)
        if positive and not turned:
            first, second = self.formed(left, True), self.formed(right, True)
            return node if _same((first, second), (left, right)) else replace(node, left=first, right=second)
        first = self.formed(left, positive is not (operator is _IMPLY))
        # De Morgan: a negated disjunction or implication is a conjunction.
        joined = _OR if (operator is _AND) is not positive else _AND
        return _join(joined, first, self.formed(right, positive))

    def _comparison(self, node: ast.BinaryExpression, positive: bool) -> ast.Expression:
        """A comparison of clocks with a number or of two clocks."""
        if not positive:
            node = replace(node, operator=node.operator.negated)
        return self._bounded(node) if self.invariant else node

    def _bounded(self, node: ast.BinaryExpression) -> ast.Expression:
        """A comparison in an invariant as UPPAAL wants it: a bound, which is an integer or above a lower bound."""
        clock_first = self.names.reads_clock(node.left)
        bound = node.right if clock_first else node.left
        if self._is_truth(bound):
            number = ast.BinaryExpression(bound.span, BinaryOperator.ADD, bound, ast.IntegerLiteral(bound.span, 0))
            node = replace(node, right=number) if clock_first else replace(node, left=number)
        elif isinstance(bound, ast.FloatLiteral) or self.names.base(bound) == "double":
            if node.operator in (BinaryOperator.GREATER, BinaryOperator.GREATER_EQUAL):
                node = replace(node, operator=node.operator.mirrored, left=node.right, right=node.left)
        if node.operator is not BinaryOperator.EQUAL:
            return node
        bounds = (BinaryOperator.LESS_EQUAL, BinaryOperator.GREATER_EQUAL)
        return _join(_AND, *(replace(node, operator=bound) for bound in bounds))

    def _is_truth(self, node: ast.Expression) -> bool:
        match node:
            case ast.BinaryExpression(operator=operator):
                return operator.group is not OperandGroup.ARITHMETIC
            case ast.UnaryExpression(operator=operator):
                return operator is PrefixOperator.NOT
            case ast.QuantifierExpression(kind=kind):
                return kind != "sum"
            case _:
                return isinstance(node, ast.BooleanLiteral) or self.names.base(node) == "bool"

    def _compared(self, node: ast.BinaryExpression, positive: bool) -> ast.Expression:
        """Two conditions that are to be equally true, or not; only queries have them."""
        if not self.query:
            return node if positive else _negated(node)
        equal = (node.operator is BinaryOperator.EQUAL) is positive
        first = _join(_AND, self.formed(node.left, True), self.formed(node.right, equal))
        second = _join(_AND, self.formed(node.left, False), self.formed(node.right, not equal))
        return _join(_OR, first, second)

    def _quantified(self, node: ast.QuantifierExpression, positive: bool) -> ast.Expression:
        inside = replace(self, names=self.names.binding(node.variable.name, node.type))
        if self.query:
            body = inside.formed(node.body, True)
            whole = node if body is node.body else replace(node, body=body)
            return whole if positive else _negated(whole)
        # Where it is to be `exists`, the type has one value: everything else was refused when the model was loaded.
        body = inside.formed(node.body, positive)
        return node if body is node.body and node.kind == "forall" else replace(node, kind="forall", body=body)

    def _is_condition(self, node: ast.Expression) -> bool:
        """True if a condition is about clocks."""
        match node:
            case ast.UnaryExpression(operator=PrefixOperator.NOT, operand=operand):
                return self._is_condition(operand)
            case ast.BinaryExpression(operator=operator, left=left, right=right):
                match operator.group:
                    case OperandGroup.ARITHMETIC:
                        return False
                    case OperandGroup.COMPARISON:  # a condition within it reads a clock, too
                        return self.names.reads_clock(left) or self.names.reads_clock(right)
                    case _:
                        return self._is_condition(left) or self._is_condition(right)
            case ast.ConditionalExpression(condition=condition, then=then, otherwise=otherwise):
                return any(map(self._is_condition, (condition, then, otherwise)))
            case ast.QuantifierExpression(variable=variable, type=type_, body=body):
                return replace(self, names=self.names.binding(variable.name, type_))._is_condition(body)
            case _:
                return False


def _join(operator: BinaryOperator, left: ast.Expression, right: ast.Expression) -> ast.Expression:
    return ast.BinaryExpression(left.span, operator, left, right)


def _negated(node: ast.Expression) -> ast.Expression:
    match node:
        case ast.UnaryExpression(operator=PrefixOperator.NOT, operand=operand):
            return operand
        case ast.BooleanLiteral(value=value):
            return replace(node, value=not value)
        case ast.BinaryExpression(operator=BinaryOperator.EQUAL | BinaryOperator.NOT_EQUAL as operator):
            return replace(node, operator=operator.negated)
        case _:
            return ast.UnaryExpression(node.span, PrefixOperator.NOT, node)
