"""Comparisons of clocks, and the forms of conditions over clocks.

Every comparison is brought into the form ``x ~ e`` or ``x - y ~ e`` with clocks x, y and an integer expression e.
A guard or invariant must describe a convex set of clock values in every discrete state: a conjunction of comparisons
and clock-free conditions, with disjunctions of which at most one side has clocks. Negations, implications,
conditional expressions and quantifiers over clock comparisons are rewritten into that form where it is possible.
"""

from __future__ import annotations

from tachk.base.operators import BinaryOperator, UnaryOperator
from tachk.base.records import dataclass, field
from tachk.base.span import Span
from tachk.frontend.context import Context
from tachk.frontend.expressions import folded_expressions as fold
from tachk.frontend.expressions.folded_expressions import substitute
from tachk.model.expressions import (
    BOOL,
    INT,
    Binary,
    Conditional,
    Constant,
    Expression,
    Quantifier,
    QuantifierKind,
    Unary,
)
from tachk.model.traversal import children, compares_clocks, is_clock_comparison
from tachk.model.types import BoolType, ClockType, IntType, ScalarType, bounds

_SPLIT_HELP = "a zone cannot be split by one {where}; use two edges, one for each case"


@dataclass(frozen=True, slots=True)
class _Sum:
    """Clocks that are added, clocks that are subtracted, and an integer (None for 0)."""

    plus: tuple[Expression, ...]
    minus: tuple[Expression, ...]
    rest: Expression | None


def _add(left: Expression | None, right: Expression | None, operator: BinaryOperator, span: Span) -> Expression | None:
    if right is None:
        return left
    if left is None:
        if operator is BinaryOperator.ADD:
            return right
        return fold.unary(UnaryOperator.MINUS, right, INT, span)
    return fold.binary(operator, left, right, INT, span)


def _sum(term: Expression) -> _Sum:
    match term:
        case Binary(BinaryOperator.ADD | BinaryOperator.SUBTRACT as operator, left, right, ClockType(), span):
            first, second = _sum(left), _sum(right)
            rest = _add(first.rest, second.rest, operator, span)
            if operator is BinaryOperator.ADD:
                return _Sum(first.plus + second.plus, first.minus + second.minus, rest)
            return _Sum(first.plus + second.minus, first.minus + second.plus, rest)
        case Unary(UnaryOperator.MINUS, operand, ClockType(), span):
            inner = _sum(operand)
            return _Sum(inner.minus, inner.plus, _add(None, inner.rest, BinaryOperator.SUBTRACT, span))
        case _ if isinstance(term.type, ClockType):
            return _Sum((term,), (), None)
        case _:
            return _Sum((), (), term)


def compare(
    operator: BinaryOperator, left: Expression, right: Expression, span: Span, context: Context
) -> Expression | None:
    """The comparison of two terms, of which at least one contains a clock."""
    first, second = _sum(left), _sum(right)
    if not (first.plus or first.minus):
        first, second, operator = second, first, operator.mirrored
    plus, minus = [*first.plus, *second.minus], [*first.minus, *second.plus]
    for clock in tuple(plus):
        if clock in minus:
            plus.remove(clock)
            minus.remove(clock)
    if len(plus) > 1 or len(minus) > 1:
        context.error(
            "E0335",
            span,
            "a comparison can contain one clock, or the difference of two",
            "write it as `x <= e` or `x - y <= e` with an integer expression `e`",
        )
        return None
    if not plus:
        first, second, operator = second, first, operator.mirrored
        plus, minus = minus, plus
    constant = _add(second.rest, first.rest, BinaryOperator.SUBTRACT, span) or Constant(0, span=span)
    if not plus:
        return fold.binary(operator, Constant(0, span=span), constant, BOOL, span)
    clocks: Expression = plus[0]
    if minus:
        clocks = Binary(BinaryOperator.SUBTRACT, plus[0], minus[0], ClockType(), span)
    if operator is not BinaryOperator.NOT_EQUAL:
        return Binary(operator, clocks, constant, BOOL, span)
    if context.in_query:
        below = Binary(BinaryOperator.LESS, clocks, constant, BOOL, span)
        above = Binary(BinaryOperator.GREATER, clocks, constant, BOOL, span)
        return Binary(BinaryOperator.OR, below, above, BOOL, span)
    context.error(
        "E0332",
        span,
        "clocks cannot be compared with `!=`: the result is not convex",
        "write `<` or `>`; where a guard means both, use two edges",
    )
    return None


def _compares_clocks(expression: Expression, known: dict[int, bool]) -> bool:
    """As `compares_clocks`; ``known`` keeps the answers by the identity of nodes."""
    answer = known.get(id(expression))
    if answer is None:
        answer = is_clock_comparison(expression) or any(
            _compares_clocks(child, known) for child in children(expression)
        )
        known[id(expression)] = answer
    return answer


def forbid(expression: Expression, where: str, context: Context) -> bool:
    """Reports a comparison of clocks where none may stand; ``where`` reads like "an update"."""
    if not compares_clocks(expression):
        return True
    known: dict[int, bool] = {}
    node = expression
    while True:
        inner = next((child for child in children(node) if _compares_clocks(child, known)), None)
        if inner is None:
            break
        node = inner
    context.error(
        "E0330",
        node.span,
        f"{where} cannot compare clocks",
        "clocks can be compared in guards, invariants and queries only",
    )
    return False


def convex(condition: Expression, where: str, context: Context) -> Expression | None:
    """The condition of a guard or invariant in convex form, or None after a report; ``where`` is "guard" or
    "invariant"."""
    if not compares_clocks(condition):
        return condition
    return _Former(where, context).formed(condition, True)


@dataclass(slots=True)
class _Former:
    """Brings conditions into convex form; each method gives None after a report.

    Attributes:
        where: "guard" or "invariant".
        known: of nodes, by their identity, whether they compare clocks.
    """

    where: str
    context: Context
    known: dict[int, bool] = field(default_factory=dict)

    def _compares_clocks(self, node: Expression) -> bool:
        return _compares_clocks(node, self.known)

    def formed(self, node: Expression, positive: bool) -> Expression | None:
        """The condition, or its negation where ``positive`` is false."""
        if not self._compares_clocks(node):
            value = fold.truth(node)
            return value if positive else fold.negation(value, node.span)
        match node:
            case Unary(UnaryOperator.NOT, operand):
                return self.formed(operand, not positive)
            case Binary(operator, left, _) if isinstance(left.type, ClockType):
                if positive:
                    return node
                if operator is BinaryOperator.EQUAL:
                    help = _SPLIT_HELP.format(where=self.where)
                    self.context.error("E0332", node.span, "the negation of a clock equality is not convex", help)
                    return None
                return Binary(operator.negated, left, node.right, BOOL, node.span)
            case Binary(BinaryOperator.AND, left, right):
                return self._joined((left, positive), (right, positive), positive, node.span)
            case Binary(BinaryOperator.OR, left, right):
                return self._joined((left, positive), (right, positive), not positive, node.span)
            case Binary(BinaryOperator.IMPLY, left, right):
                return self._joined((left, not positive), (right, positive), not positive, node.span)
            case Conditional(condition, then, otherwise) if not self._compares_clocks(condition):
                first = self._joined((condition, False), (then, positive), False, node.span)
                second = self._joined((condition, True), (otherwise, positive), False, node.span)
                if first is None or second is None:
                    return None
                return fold.binary(BinaryOperator.AND, first, second, BOOL, node.span)
            case Quantifier(QuantifierKind.FORALL | QuantifierKind.EXISTS):
                return self._instances(node, positive)
            case _:
                self.context.error(
                    "E0331",
                    node.span,
                    "a comparison of clocks cannot be used as a value",
                    "combine comparisons of clocks with `&&` only, or with `||` and a condition without clocks",
                )
                return None

    def _instances(self, node: Quantifier, positive: bool) -> Expression | None:
        conjunctive = (node.kind is QuantifierKind.FORALL) is positive
        variable = node.variable
        assert isinstance(variable.type, IntType | BoolType | ScalarType)
        low, high = bounds(variable.type)
        if not self.context.allow_instances(high - low + 1, node.span):
            return None
        parts: list[Expression] = []
        for number in range(low, high + 1):
            value = {variable: Constant(number, variable.type)}
            instance = substitute(node.body, value, self.context.constants)
            part = _Former(self.where, self.context).formed(instance, positive)
            if part is None:
                return None
            if parts and not conjunctive:
                self._not_convex(node.span)
                return None
            parts.append(part)
        return fold.joined(BinaryOperator.AND, parts, BOOL, node.span)

    def _joined(
        self, left: tuple[Expression, bool], right: tuple[Expression, bool], conjunctive: bool, span: Span
    ) -> Expression | None:
        """Two conditions, each with whether it is positive, as a conjunction or a disjunction."""
        if not conjunctive and self._compares_clocks(left[0]) and self._compares_clocks(right[0]):
            self._not_convex(span)
            return None
        first, second = self.formed(*left), self.formed(*right)
        if first is None or second is None:
            return None
        return fold.binary(BinaryOperator.AND if conjunctive else BinaryOperator.OR, first, second, BOOL, span)

    def _not_convex(self, span: Span) -> None:
        self.context.error(
            "E0331",
            span,
            "clocks on both sides of a disjunction: the condition is not convex",
            _SPLIT_HELP.format(where=self.where),
        )
