"""Guards, invariants and predicates split into integer conditions and clock constraints.

The integer conditions of a conjunction are evaluated before its clock constraints, whatever the textual order, and
those that cannot fail before those that can; among themselves those that can fail keep the order of the text.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tachk.analysis.fold import Known, fold, negate
from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.base.operators import COMPARISONS, BinaryOperator, UnaryOperator
from tachk.base.records import dataclass, field
from tachk.base.span import Span
from tachk.model.connectives import both, either, is_conjunction, sides
from tachk.model.expressions import (
    BOOL,
    Binary,
    Conditional,
    Constant,
    Expression,
    Field,
    Index,
    Quantifier,
    QuantifierKind,
    Reference,
    Unary,
)
from tachk.model.traversal import reads_clock
from tachk.model.types import ClockType
from tachk.model.variable_layout import slot_range


@dataclass(frozen=True, slots=True)
class ClockAtom:
    """``left - right < bound`` (strict) or ``<= bound``; None stands for the constant zero."""

    left: Expression | None
    right: Expression | None
    strict: bool
    bound: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class Conjunction:
    """Attributes:
    integers: conditions without clocks, in the order of the text.
    clocks: pairs (condition or None, atom): the atom must hold where its condition does.
    """

    integers: tuple[Expression, ...] = ()
    clocks: tuple[tuple[Expression | None, ClockAtom], ...] = ()


# ---- comparisons ----------------------------------------------------------------------------------------------------


def clock_atoms(comparison: Binary, positive: bool, known: Known) -> tuple[tuple[ClockAtom, ...], ...] | Expression:
    """A comparison with clocks, or its negation, as a disjunction of conjunctions of atoms.

    Where the clocks cancel out (``x - x < 3``) the result is a comparison of integers. Raises UnsupportedError for
    anything but the comparison of a clock or a difference of two clocks with an integer.
    """
    operator = comparison.operator
    folded = negate(comparison) if not positive else comparison
    assert isinstance(folded, Binary)
    operator = folded.operator
    plus: list[Expression] = []
    minus: list[Expression] = []
    terms: list[tuple[bool, Expression]] = []
    _linear(comparison.right, True, minus, plus, terms)
    _linear(comparison.left, False, minus, plus, terms)
    for clock in tuple(plus):
        if clock in minus:
            plus.remove(clock)
            minus.remove(clock)
    if len(plus) > 1 or len(minus) > 1:
        raise clock_form_unsupported(comparison.span)
    bound = fold(_sum(terms), known)
    if not plus and not minus:
        return fold(Binary(operator, Constant(0), bound, BOOL, comparison.span), known)
    left, right = plus[0] if plus else None, minus[0] if minus else None
    opposite = fold(Unary(UnaryOperator.MINUS, bound, bound.type, bound.span), known)

    def below(strict: bool) -> ClockAtom:
        return ClockAtom(left, right, strict, bound, comparison.span)

    def above(strict: bool) -> ClockAtom:
        return ClockAtom(right, left, strict, opposite, comparison.span)

    match operator:
        case BinaryOperator.LESS | BinaryOperator.LESS_EQUAL:
            return ((below(operator is BinaryOperator.LESS),),)
        case BinaryOperator.GREATER | BinaryOperator.GREATER_EQUAL:
            return ((above(operator is BinaryOperator.GREATER),),)
        case BinaryOperator.EQUAL:
            return ((below(False), above(False)),)
        case BinaryOperator.NOT_EQUAL:
            return (below(True),), (above(True),)
        case _:
            raise TypeError(f"{operator} does not compare clocks")


def _linear(
    side: Expression,
    positive: bool,
    plus: list[Expression],
    minus: list[Expression],
    terms: list[tuple[bool, Expression]],
) -> None:
    """Splits a sum into clocks and integer terms, each with its sign."""
    if not reads_clock(side):
        terms.append((positive, side))
        return
    match side:
        case Binary(BinaryOperator.ADD, left, right):
            _linear(left, positive, plus, minus, terms)
            _linear(right, positive, plus, minus, terms)
        case Binary(BinaryOperator.SUBTRACT, left, right):
            _linear(left, positive, plus, minus, terms)
            _linear(right, not positive, plus, minus, terms)
        case Unary(UnaryOperator.MINUS, operand):
            _linear(operand, not positive, plus, minus, terms)
        case Reference() | Index() | Field() | Conditional() if isinstance(side.type, ClockType):
            (plus if positive else minus).append(side)
        case _:
            raise clock_form_unsupported(side.span)


def _sum(terms: Sequence[tuple[bool, Expression]]) -> Expression:
    result: Expression | None = None
    for positive, term in terms:
        if result is None:
            result = term if positive else Unary(UnaryOperator.MINUS, term, term.type, term.span)
        else:
            operator = BinaryOperator.ADD if positive else BinaryOperator.SUBTRACT
            result = Binary(operator, result, term, result.type, term.span)
    return Constant(0) if result is None else result


# ---- conjunctions ---------------------------------------------------------------------------------------------------


def split_conjunction(expression: Expression, known: Known) -> Conjunction:
    """A guard or invariant as a conjunction.

    Raises UnsupportedError for a disjunction in which both sides have clocks.
    """
    parts = _Conjuncts()
    parts.split(fold(expression, known), True, None, known)
    return Conjunction(tuple(parts.integers), tuple(parts.clocks))


@dataclass(slots=True)
class _Conjuncts:
    """The parts of a conjunction. An expression that is split with ``positive`` false is negated; with a condition it
    has to hold where the condition does."""

    integers: list[Expression] = field(default_factory=list)
    clocks: list[tuple[Expression | None, ClockAtom]] = field(default_factory=list)

    def split(self, expression: Expression, positive: bool, condition: Expression | None, known: Known) -> None:
        if isinstance(condition, Constant):
            if condition.value == 0:
                return
            condition = None
        if not reads_clock(expression):
            parts = conjuncts(expression, positive)
            self.integers.extend(p if condition is None else fold(either(negate(condition), p), known) for p in parts)
            return
        match expression:
            case Unary(UnaryOperator.NOT, operand):
                self.split(operand, not positive, condition, known)
            case Binary() if is_conjunction(expression) is not None:
                self._connective(expression, positive, condition, known)
            case Conditional(test, then, otherwise) if not reads_clock(test):
                self.split(then, positive, fold(both(condition, test), known), known)
                self.split(otherwise, positive, fold(both(condition, negate(test)), known), known)
            case Quantifier():
                self._instances(expression, positive, condition, known)
            case Binary(operator) if operator in COMPARISONS:
                atoms = clock_atoms(expression, positive, known)
                if not isinstance(atoms, tuple):
                    self.split(atoms, True, condition, known)
                elif len(atoms) == 1:
                    self.clocks.extend((condition, atom) for atom in atoms[0])
                else:
                    raise _disjunction_unsupported(expression.span)
            case _:
                raise clock_form_unsupported(expression.span)

    def _connective(self, expression: Binary, positive: bool, condition: Expression | None, known: Known) -> None:
        (left, left_positive), (right, _) = sides(expression, positive)
        if is_conjunction(expression, positive):
            self.split(left, left_positive, condition, known)
            self.split(right, positive, condition, known)
        elif not reads_clock(left):
            where = left if not left_positive else negate(left)
            self.split(right, positive, fold(both(condition, where), known), known)
        elif not reads_clock(right):
            where = right if not positive else negate(right)
            self.split(left, left_positive, fold(both(condition, where), known), known)
        else:
            raise _disjunction_unsupported(expression.span)

    def _instances(self, expression: Quantifier, positive: bool, condition: Expression | None, known: Known) -> None:
        if (expression.kind is QuantifierKind.FORALL) != positive or expression.kind is QuantifierKind.SUM:
            raise _disjunction_unsupported(expression.span)
        low, high = slot_range(expression.variable.type)
        for value in range(low, high + 1):
            inner = known.with_bound(expression.variable, value)
            where = None if condition is None else fold(condition, inner)
            self.split(fold(expression.body, inner), positive, where, inner)


def conjuncts(expression: Expression, positive: bool = True) -> Iterator[Expression]:
    """The parts of a conjunction without clocks, negations pushed inwards, in order."""
    if isinstance(expression, Unary) and expression.operator is UnaryOperator.NOT:
        yield from conjuncts(expression.operand, not positive)
    elif isinstance(expression, Binary) and is_conjunction(expression, positive):
        for side in sides(expression, positive):
            yield from conjuncts(*side)
    else:
        yield expression if positive else negate(expression)


def _disjunction_unsupported(span: Span) -> UnsupportedError:
    return UnsupportedError(
        Diagnostic(
            "E0705",
            "a disjunction in which more than one side compares clocks cannot be a guard or an invariant",
            span,
            "use one edge (or location) for each side",
        )
    )


def clock_form_unsupported(span: Span) -> UnsupportedError:
    return UnsupportedError(
        Diagnostic(
            "E0706",
            "only a clock or the difference of two clocks can be compared, with an integer expression",
            span,
        )
    )
