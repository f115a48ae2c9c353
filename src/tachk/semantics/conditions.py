"""Guards, invariants and predicates split into integer conditions and clock constraints.

The integer conditions of a conjunction are evaluated before its clock constraints, whatever the textual order, and
those that cannot fail before those that can; among themselves those that can fail keep the order of the text.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from tachk.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.diagnostics.span import Span
from tachk.model.expressions import (
    BOOL,
    Assign,
    Binary,
    BinaryOperator,
    Call,
    Conditional,
    Constant,
    Expression,
    Field,
    Index,
    LocationTest,
    Quantifier,
    QuantifierKind,
    Reference,
    Unary,
    UnaryOperator,
)
from tachk.model.traversal import children
from tachk.model.types import ClockType
from tachk.semantics.bounds import ConstraintRange
from tachk.semantics.codegen import CodeGenerator
from tachk.semantics.fold import COMPARISONS, Known, cannot_fail, fold, fold_place, is_integer, negate
from tachk.semantics.intervals import interval, possible_cells
from tachk.semantics.layout import Layout, cell_range
from tachk.semantics.program import NO_CODE, ClockConstraint, Comparison, Condition, Test

MAXIMAL_CONSTANT = 2**26 - 1
"""The largest absolute value of a clock bound that the engine takes (``largest_constant`` in the core)."""

_COMPARISON = {
    BinaryOperator.EQUAL: Comparison.EQUAL,
    BinaryOperator.NOT_EQUAL: Comparison.NOT_EQUAL,
    BinaryOperator.LESS: Comparison.LESS,
    BinaryOperator.LESS_EQUAL: Comparison.LESS_EQUAL,
    BinaryOperator.GREATER: Comparison.GREATER,
    BinaryOperator.GREATER_EQUAL: Comparison.GREATER_EQUAL,
}
_MIRRORED = {
    BinaryOperator.EQUAL: BinaryOperator.EQUAL,
    BinaryOperator.NOT_EQUAL: BinaryOperator.NOT_EQUAL,
    BinaryOperator.LESS: BinaryOperator.GREATER,
    BinaryOperator.LESS_EQUAL: BinaryOperator.GREATER_EQUAL,
    BinaryOperator.GREATER: BinaryOperator.LESS,
    BinaryOperator.GREATER_EQUAL: BinaryOperator.LESS_EQUAL,
}
_UNROLLED_VALUES = 64


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


def reads_clock(expression: Expression) -> bool:
    """Whether the value of the expression depends on the value of a clock."""
    match expression:
        case Call(function, arguments):
            pairs = zip(function.parameters, arguments, strict=True)
            return any(not p.reference and reads_clock(a) for p, a in pairs)
        case Assign(_, value):
            return reads_clock(value)
        case Reference() | Index() | Field() if isinstance(expression.type, ClockType):
            return True
        case _:
            return any(reads_clock(child) for child in children(expression))


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
        case _:
            return (below(True),), (above(True),)


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
    integers: list[Expression] = []
    clocks: list[tuple[Expression | None, ClockAtom]] = []
    _split(fold(expression, known), True, None, known, integers, clocks)
    return Conjunction(tuple(integers), tuple(clocks))


def _split(
    expression: Expression,
    positive: bool,
    condition: Expression | None,
    known: Known,
    integers: list[Expression],
    clocks: list[tuple[Expression | None, ClockAtom]],
) -> None:
    if not reads_clock(expression):
        parts = conjuncts(expression, positive)
        integers.extend(p if condition is None else fold(_or(negate(condition), p), known) for p in parts)
        return

    def again(inner: Expression, positive: bool, condition: Expression | None) -> None:
        if isinstance(condition, Constant):
            if condition.value == 0:
                return
            condition = None
        _split(inner, positive, condition, known, integers, clocks)

    match expression:
        case Unary(UnaryOperator.NOT, operand):
            again(operand, not positive, condition)
        case Binary(BinaryOperator.AND | BinaryOperator.OR | BinaryOperator.IMPLY as operator, left, right):
            left_positive = positive if operator is not BinaryOperator.IMPLY else not positive
            if (operator is BinaryOperator.AND) == positive:
                again(left, left_positive, condition)
                again(right, positive, condition)
            elif not reads_clock(left):
                again(right, positive, fold(both(condition, left if not left_positive else negate(left)), known))
            elif not reads_clock(right):
                again(left, left_positive, fold(both(condition, right if not positive else negate(right)), known))
            else:
                raise _disjunction_unsupported(expression.span)
        case Conditional(test, then, otherwise) if not reads_clock(test):
            again(then, positive, fold(both(condition, test), known))
            again(otherwise, positive, fold(both(condition, negate(test)), known))
        case Quantifier(kind, variable, body):
            if (kind is QuantifierKind.FORALL) != positive or kind is QuantifierKind.SUM:
                raise _disjunction_unsupported(expression.span)
            low, high = cell_range(variable.type)
            for value in range(low, high + 1):
                inner = known.with_bound(variable, value)
                _split(
                    fold(body, inner),
                    positive,
                    None if condition is None else fold(condition, inner),
                    inner,
                    integers,
                    clocks,
                )
        case Binary(operator) if operator in COMPARISONS:
            atoms = clock_atoms(expression, positive, known)
            if not isinstance(atoms, tuple):
                again(atoms, True, condition)
            elif len(atoms) == 1:
                clocks.extend((condition, atom) for atom in atoms[0])
            else:
                raise _disjunction_unsupported(expression.span)
        case _:
            raise clock_form_unsupported(expression.span)


def conjuncts(expression: Expression, positive: bool = True) -> Iterator[Expression]:
    """The parts of a conjunction without clocks, negations pushed inwards, in order."""
    match expression:
        case Unary(UnaryOperator.NOT, operand):
            yield from conjuncts(operand, not positive)
        case Binary(BinaryOperator.AND, left, right) if positive:
            yield from conjuncts(left)
            yield from conjuncts(right)
        case Binary(BinaryOperator.OR, left, right) if not positive:
            yield from conjuncts(left, False)
            yield from conjuncts(right, False)
        case Binary(BinaryOperator.IMPLY, left, right) if not positive:
            yield from conjuncts(left)
            yield from conjuncts(right, False)
        case _:
            yield expression if positive else negate(expression)


def both(one: Expression | None, other: Expression) -> Expression:
    return other if one is None else Binary(BinaryOperator.AND, one, other, BOOL, other.span)


def _or(left: Expression, right: Expression) -> Expression:
    return Binary(BinaryOperator.OR, left, right, BOOL, right.span)


# ---- compilation ----------------------------------------------------------------------------------------------------


class ConditionCompiler:
    """Turns conjunctions into `Condition` values and tells what they compare clocks with."""

    def __init__(self, layout: Layout, generator: CodeGenerator) -> None:
        self.layout = layout
        self.generator = generator

    def compile(self, conjunction: Conjunction, known: Known) -> tuple[Condition, tuple[ConstraintRange, ...]] | None:
        """The compiled condition; None if it is false in every state.

        Raises UnsupportedError for a clock bound that may be too large.
        """
        tests: list[Test] = []
        remaining: list[Expression] = []
        for integer in conjunction.integers:
            for part in self._tests_or_rest(integer, known):
                if part is False:
                    return None
                if isinstance(part, Test):
                    tests.append(part)
                elif part is not True:
                    remaining.append(part)
        constraints: list[ClockConstraint] = []
        ranges: list[ConstraintRange] = []
        code = NO_CODE
        if remaining:
            whole = remaining[0]
            for part in remaining[1:]:
                whole = both(whole, part)
            code = self.generator.value_code(whole, known)
        for condition, atom in conjunction.clocks:
            constraint, range_ = self._constraint(condition, atom, known)
            if _always_true(constraint):
                continue
            constraints.append(constraint)
            ranges.append(range_)
        unique = tuple(dict.fromkeys(tests))
        return Condition(unique, code, tuple(constraints)), tuple(ranges)

    def never(self) -> Condition:
        """A condition that is false in every state."""
        return Condition(code=self.generator.value_code(Constant(0)))

    def _tests_or_rest(self, integer: Expression, known: Known) -> list[Test | bool | Expression]:
        """The condition as tests, truth values that are known, and what needs code."""
        parts: list[Test | bool | Expression] = []
        for part in conjuncts(fold(integer, known)):
            test = self._test(part)
            unrolled = self._unrolled(part, known) if test is None else None
            if unrolled is not None:
                parts.extend(unrolled)
            else:
                parts.append(part if test is None else test)
        return parts

    def _unrolled(self, part: Expression, known: Known) -> list[Test | bool | Expression] | None:
        """A short ``forall`` whose instances are all tests."""
        positive = True
        if isinstance(part, Unary) and part.operator is UnaryOperator.NOT:
            positive, part = False, part.operand
        wanted = QuantifierKind.FORALL if positive else QuantifierKind.EXISTS
        if not isinstance(part, Quantifier) or part.kind is not wanted:
            return None
        low, high = cell_range(part.variable.type)
        if high - low >= _UNROLLED_VALUES or not cannot_fail_when_bound(part, known):
            return None
        found: list[Test | bool | Expression] = []
        for value in range(low, high + 1):
            for inner in conjuncts(fold(part.body, known.with_bound(part.variable, value)), positive):
                test = self._test(inner)
                if test is None:
                    return None
                found.append(test)
        return found

    def _test(self, part: Expression) -> Test | bool | None:
        """A condition on one slot that cannot fail, or its truth if the slot's range decides it."""
        match part:
            case Constant(value):
                return value != 0
            case LocationTest(process, location):
                return self._decided(Test(process, Comparison.EQUAL, location))
            case Unary(UnaryOperator.NOT, LocationTest(process, location)):
                return self._decided(Test(process, Comparison.NOT_EQUAL, location))
            case Unary(UnaryOperator.NOT, operand):
                return self._slot_test(operand, Comparison.EQUAL, 0)
            case Binary(operator, left, Constant(value)) if operator in COMPARISONS:
                return self._slot_test(left, _COMPARISON[operator], value)
            case Binary(operator, Constant(value), right) if operator in COMPARISONS:
                return self._slot_test(right, _COMPARISON[_MIRRORED[operator]], value)
            case Reference() | Index() | Field():
                return self._slot_test(part, Comparison.NOT_EQUAL, 0)
        return None

    def _slot_test(self, place: Expression, comparison: Comparison, value: int) -> Test | bool | None:
        if not isinstance(place, Reference | Index | Field) or not is_integer(place.type):
            return None
        slot = self.layout.known_slot(place)
        if slot is None or not self.layout.is_state(slot):
            return None
        return self._decided(Test(slot, comparison, value))

    def _decided(self, test: Test) -> Test | bool:
        """The test, or its truth if the slot's range decides it."""
        low, high = self.layout.slots[test.slot].low, self.layout.slots[test.slot].high
        constant = test.constant
        match test.comparison:
            case Comparison.EQUAL | Comparison.NOT_EQUAL:
                equal = low == high == constant
                different = constant < low or constant > high
                if equal or different:
                    return equal == (test.comparison is Comparison.EQUAL)
            case Comparison.LESS:
                return True if high < constant else False if low >= constant else test
            case Comparison.LESS_EQUAL:
                return True if high <= constant else False if low > constant else test
            case Comparison.GREATER:
                return True if low > constant else False if high <= constant else test
            case Comparison.GREATER_EQUAL:
                return True if low >= constant else False if high < constant else test
        return test

    def _constraint(
        self, condition: Expression | None, atom: ClockAtom, known: Known
    ) -> tuple[ClockConstraint, ConstraintRange]:
        left, left_code, lefts = self._clock(atom.left, known)
        right, right_code, rights = self._clock(atom.right, known)
        bound = fold(atom.bound, known)
        low, high = interval(bound, known)
        check_bound(low, high, atom.span)
        constant = isinstance(bound, Constant)
        constraint = ClockConstraint(
            left,
            right,
            atom.strict,
            bound=low if constant else 0,
            bound_code=NO_CODE if constant else self.generator.value_code(bound, known),
            condition=NO_CODE if condition is None else self.generator.value_code(condition, known),
            left_code=left_code,
            right_code=right_code,
        )
        return constraint, ConstraintRange(lefts, rights, low, high, atom.strict, atom.span)

    def _clock(self, place: Expression | None, known: Known) -> tuple[int, int, tuple[int, ...]]:
        """The number of a clock, or code for it, and the numbers it may have."""
        if place is None:
            return 0, NO_CODE, (0,)
        folded = fold_place(place, known)
        slot = self.layout.known_slot(folded)
        if slot is not None:
            number = self.layout.slots[slot].initial
            return number, NO_CODE, (number,)
        cells = possible_cells(folded, known)
        if cells is None:
            numbers: tuple[int, ...] = tuple(range(1, len(self.layout.clock_names) + 1))
        else:
            numbers = tuple(sorted({self.layout.slots[self.layout.first_slot(v) + c].initial for v, c in cells}))
        return 0, self.generator.number_code(folded, known), numbers


def cannot_fail_when_bound(quantifier: Quantifier, known: Known) -> bool:
    """Whether no instance of the quantifier's body can fail."""
    low, high = cell_range(quantifier.variable.type)
    return all(
        cannot_fail(fold(quantifier.body, known.with_bound(quantifier.variable, value)))
        for value in range(low, high + 1)
    )


def check_bound(low: int, high: int, span: Span) -> None:
    """Raises UnsupportedError if a value compared with or assigned to a clock may be too large for the engine."""
    if low < -MAXIMAL_CONSTANT or high > MAXIMAL_CONSTANT:
        raise UnsupportedError(
            Diagnostic(
                "E0704",
                f"a clock is used with a value that may lie anywhere in [{low}, {high}], "
                f"beyond the limit of {MAXIMAL_CONSTANT}",
                span,
                "declare a smaller range for the variables of this expression, for instance int[0, 1000]",
            )
        )


def _always_true(constraint: ClockConstraint) -> bool:
    """Whether the constraint only says that a clock is not negative, without code that might fail."""
    codes = constraint.bound_code, constraint.condition, constraint.left_code, constraint.right_code
    if constraint.left or any(code != NO_CODE for code in codes):
        return False
    return constraint.bound > 0 or (constraint.bound == 0 and not constraint.strict)


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
