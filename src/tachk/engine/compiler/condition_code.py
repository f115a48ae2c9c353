"""Conjunctions of conditions as tests, code and clock constraints of a program."""

from __future__ import annotations

from collections.abc import Sequence
from math import gcd

from tachk.analysis.conditions import ClockAtom, Conjunction, conjuncts
from tachk.analysis.divisors import divisor
from tachk.analysis.failures import can_fail
from tachk.analysis.fold import Known, cannot_fail, fold, fold_place, is_integer
from tachk.analysis.intervals import interval, possible_slots
from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.base.operators import COMPARISONS, UnaryOperator
from tachk.base.span import Span
from tachk.engine.compiler.bounds import ConstraintRange
from tachk.engine.compiler.codegen import CodeGenerator
from tachk.engine.compiler.hybrid import flow_test
from tachk.engine.compiler.program import NO_CODE, ClockConstraint, Comparison, Condition, FlowTest, Test
from tachk.engine.compiler.slot_layout import SlotLayout
from tachk.model.expressions import (
    Binary,
    Constant,
    Expression,
    Field,
    Index,
    LocationTest,
    Quantifier,
    QuantifierKind,
    Reference,
    Unary,
)
from tachk.model.traversal import reads_hybrid
from tachk.model.variable_layout import slot_range

MAXIMAL_CONSTANT = 2**31 - 1
"""The largest absolute value of a clock bound: that of any integer."""

_UNROLLED_VALUES = 64


class ConditionCompiler:
    """Turns conjunctions into `Condition` values and notes the constants that they compare clocks with.

    Attributes:
        computed_unit: divides every value of the bounds that need code; 0 if they are all 0.
    """

    def __init__(self, layout: SlotLayout, generator: CodeGenerator, has_hybrid_clocks: bool = False) -> None:
        self.layout = layout
        self.has_hybrid_clocks = has_hybrid_clocks
        self.generator = generator
        self.computed_unit = 0

    def compile(self, conjunction: Conjunction, known: Known) -> tuple[Condition, tuple[ConstraintRange, ...]] | None:
        """The compiled condition; None if it is false in every state.

        Tests come before code, but none that stands behind something that may fail: it would hide the error.
        Raises UnsupportedError for a clock bound that may be too large.
        """
        tests: list[Test] = []
        remaining: list[Expression] = []
        flow: list[FlowTest] = []
        fails = False  # once something may fail, what stands behind it must not hide that
        for part in (part for integer in conjunction.integers for part in conjuncts(fold(integer, known))):
            if self.has_hybrid_clocks and reads_hybrid(part):
                flow.append(flow_test(part, known, self.generator))
                continue
            if fails:
                remaining.append(part)
                continue
            for simple in self._tests_or_rest(part, known):
                if simple is False:
                    return None
                if isinstance(simple, Test):
                    tests.append(simple)
                elif simple is not True:
                    remaining.append(simple)
                    fails = fails or can_fail(simple, known)
        constraints: list[ClockConstraint] = []
        ranges: list[ConstraintRange] = []
        code = NO_CODE
        if len(remaining) == 1:
            code = self.generator.value_code(remaining[0], known)
        elif remaining:
            code = self.generator.conjunction_code(remaining, known)
        for condition, atom in conjunction.clocks:
            if self.has_hybrid_clocks and condition is not None and reads_hybrid(condition):
                raise _mixed_disjunction(atom.span)
            constraint, range_ = self._constraint(condition, atom, known)
            if _always_true(constraint):
                continue
            constraints.append(constraint)
            ranges.append(range_)
        unique = tuple(dict.fromkeys(tests))
        return Condition(unique, code, tuple(constraints), tuple(flow)), tuple(ranges)

    def never(self) -> Condition:
        """A condition that is false in every state."""
        return Condition(code=self.generator.value_code(Constant(0)))

    def _tests_or_rest(self, part: Expression, known: Known) -> Sequence[Test | bool | Expression]:
        """The condition as tests, known truth values, and the parts that need code."""
        test = self._test(part)
        if test is not None:
            return [test]
        unrolled = self._unrolled(part, known)
        return [part] if unrolled is None else unrolled

    def _unrolled(self, part: Expression, known: Known) -> list[Test | bool | Expression] | None:
        """A short ``forall`` whose instances are all tests."""
        positive = True
        if isinstance(part, Unary) and part.operator is UnaryOperator.NOT:
            positive, part = False, part.operand
        wanted = QuantifierKind.FORALL if positive else QuantifierKind.EXISTS
        if not isinstance(part, Quantifier) or part.kind is not wanted:
            return None
        low, high = slot_range(part.variable.type)
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
                return self._slot_test(left, Comparison[operator.name], value)
            case Binary(operator, Constant(value), right) if operator in COMPARISONS:
                return self._slot_test(right, Comparison[operator.mirrored.name], value)
            case Reference() | Index() | Field():
                return self._slot_test(part, Comparison.NOT_EQUAL, 0)
            case _:
                pass
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
        if not constant:
            self.computed_unit = gcd(self.computed_unit, divisor(bound, known))
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
        return 0, self.generator.number_code(folded, known), self.possible_clocks(folded, known)

    def possible_clocks(self, place: Expression, known: Known) -> tuple[int, ...]:
        """The numbers of the clocks that a place may denote."""
        slots = possible_slots(place, known)
        if slots is None:
            return tuple(range(1, len(self.layout.clock_names) + 1))
        return tuple(sorted({self.layout.slots[self.layout.first_slot(v) + c].initial for v, c in slots}))


def _mixed_disjunction(span: Span) -> UnsupportedError:
    return UnsupportedError(
        Diagnostic(
            "E0705",
            "a disjunction with plain clocks and with hybrid ones cannot be a condition",
            span,
            "use one edge (or location) for each side",
        )
    )


def cannot_fail_when_bound(quantifier: Quantifier, known: Known) -> bool:
    """True if no instance of the quantifier's body can fail."""
    low, high = slot_range(quantifier.variable.type)
    return all(
        cannot_fail(fold(quantifier.body, known.with_bound(quantifier.variable, value)))
        for value in range(low, high + 1)
    )


def check_bound(low: int, high: int, span: Span) -> None:
    """Raises UnsupportedError if a value compared with or assigned to a clock may be too large for the engine."""
    if low < -MAXIMAL_CONSTANT or high > MAXIMAL_CONSTANT:
        if low == high:
            message = f"a clock is used with {low}, beyond the limit of {MAXIMAL_CONSTANT}"
            help_ = "choose a coarser unit of time"
        else:
            message = (
                f"a clock is used with a value that may lie anywhere in [{low}, {high}], "
                f"beyond the limit of {MAXIMAL_CONSTANT}"
            )
            help_ = "declare a smaller range for the variables of this expression, for instance int[0, 1000]"
        raise UnsupportedError(Diagnostic("E0704", message, span, help_))


def _always_true(constraint: ClockConstraint) -> bool:
    """True if the constraint only says that a clock is not negative, without code that might fail."""
    codes = constraint.bound_code, constraint.condition, constraint.left_code, constraint.right_code
    if constraint.left or any(code != NO_CODE for code in codes):
        return False
    return constraint.bound > 0 or (constraint.bound == 0 and not constraint.strict)
