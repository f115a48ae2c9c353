"""Conditions of requirements that speak of no signal: `3 > 2` is true, whatever happens."""

from __future__ import annotations

import operator
from typing import Any

from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.operators import BinaryOperator
from tachk.base.span import NOWHERE
from tachk.logic.constant_values import value_of
from tachk.logic.simplify import simplify
from tachk.syntax import ast
from tachk.syntax.formula import Atom, Formula, TruthConstant
from tachk.syntax.rewrite import rewrite
from tachk.syntax.walk import nodes_of_kind
from tachk.verify.requirements.signals import NotFollowed

_COMPARED = {
    BinaryOperator.LESS: operator.lt,
    BinaryOperator.LESS_EQUAL: operator.le,
    BinaryOperator.EQUAL: operator.eq,
    BinaryOperator.NOT_EQUAL: operator.ne,
    BinaryOperator.GREATER: operator.gt,
    BinaryOperator.GREATER_EQUAL: operator.ge,
}


def folded(formula: Formula) -> Formula:
    """The formula without conditions that are constant. Its robustness is not kept, its truth is."""
    changed = rewrite(formula, _folded)
    return simplify(changed) if next(nodes_of_kind(changed, TruthConstant), None) is not None else changed


def _folded(node: Any) -> Any:
    match node:
        case ast.BinaryExpression(operator=sign, left=left, right=right) if sign in _COMPARED:
            try:
                truth = _COMPARED[sign](value_of(left, _no_constant), value_of(right, _no_constant))
            except (InputError, NotFollowed):
                return node
            return ast.BooleanLiteral(node.span, bool(truth))
        case Atom(span=span, expression=ast.BooleanLiteral(value=value)):
            return TruthConstant(span, value)
        case _:
            return node


def _no_constant(expression: ast.Expression) -> int:
    raise NotFollowed(NOWHERE, "it is no constant")
