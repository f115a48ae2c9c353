"""Predicates as disjunctions of conditions with clock constraints and ``deadlock``.

Only what contains clocks or ``deadlock`` is multiplied out; a part without them stays one piece of code, unless the
whole predicate is a short disjunction of such parts: simple tests are faster than code.
"""

from __future__ import annotations

from collections.abc import Iterator

from tachk.analysis.conditions import (
    ClockAtom,
    Conjunction,
    clock_atoms,
    clock_form_unsupported,
    conjuncts,
)
from tachk.analysis.fold import Known, cannot_fail, fold, negate
from tachk.analysis.intervals import interval
from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.base.operators import COMPARISONS, BinaryOperator, OperandGroup, UnaryOperator
from tachk.base.records import dataclass
from tachk.base.span import Span
from tachk.engine.compiler.bounds import ConstraintRange
from tachk.engine.compiler.condition_code import ConditionCompiler, check_bound
from tachk.engine.compiler.program import Comparison, DeadlockLiteral, Disjunct, Goal
from tachk.model.connectives import is_conjunction, sides
from tachk.model.expressions import Binary, Conditional, Deadlock, Expression, Quantifier, QuantifierKind, Unary
from tachk.model.traversal import asks_deadlock, reads_clock
from tachk.model.variable_layout import slot_range

MAXIMAL_DISJUNCTS = 4096
MAXIMAL_ALTERNATIVES = 256


@dataclass(frozen=True, slots=True)
class _Literals:
    """One disjunct: integer conditions, clock atoms and at most one deadlock literal."""

    integers: tuple[Expression, ...] = ()
    atoms: tuple[ClockAtom, ...] = ()
    deadlock: DeadlockLiteral = DeadlockLiteral.ABSENT

    @property
    def can_fail(self) -> bool:
        return not all(map(cannot_fail, self.integers)) or not all(cannot_fail(a.bound) for a in self.atoms)


@dataclass(frozen=True, slots=True)
class ObservedByGoal:
    """The clock constraints of a disjunct, and the pairs (process, location) that it requires beside them."""

    constraint: ConstraintRange
    places: tuple[tuple[int, int], ...]


def compile_goal(
    predicate: Expression, known: Known, compiler: ConditionCompiler
) -> tuple[Goal, tuple[ObservedByGoal, ...]]:
    """The goal, and what its constraints compare clocks with.

    Raises UnsupportedError for a clock comparison of another form than ``x - y < c`` and for a predicate with too many
    disjuncts.
    """
    disjuncts: list[Disjunct] = []
    observed: list[ObservedByGoal] = []
    for literals in _top_level(fold(predicate, known), known):
        conjunction = Conjunction(literals.integers, tuple((None, atom) for atom in literals.atoms))
        compiled = compiler.compile(conjunction, known)
        if compiled is not None:
            disjuncts.append(Disjunct(compiled[0], literals.deadlock))
            places = tuple(
                (test.slot, test.constant)
                for test in compiled[0].tests
                if test.slot < compiler.layout.processes and test.comparison is Comparison.EQUAL
            )
            observed.extend(ObservedByGoal(constraint, places) for constraint in compiled[1])
    return Goal(tuple(disjuncts)), tuple(observed)


def _top_level(predicate: Expression, known: Known) -> tuple[_Literals, ...]:
    if not mentions_time(predicate) and cannot_fail(predicate):
        alternatives = tuple(_alternatives(predicate, True, known))
        if len(alternatives) <= MAXIMAL_ALTERNATIVES:
            return tuple(_Literals(tuple(conjuncts(part, positive))) for part, positive in alternatives)
    return _disjuncts(predicate, True, known, predicate.span)


def _alternatives(expression: Expression, positive: bool, known: Known) -> Iterator[tuple[Expression, bool]]:
    """The parts of a disjunction, each to be read as itself or (False) as its negation."""
    match expression:
        case Unary(UnaryOperator.NOT, operand):
            yield from _alternatives(operand, not positive, known)
        case Binary() if is_conjunction(expression, positive) is False:
            for side in sides(expression, positive):
                yield from _alternatives(*side, known)
        case Quantifier(QuantifierKind.EXISTS) if positive:
            yield from _instances(expression, True, known)
        case Quantifier(QuantifierKind.FORALL) if not positive:
            yield from _instances(expression, False, known)
        case _:
            yield expression, positive


def _instances(expression: Quantifier, positive: bool, known: Known) -> Iterator[tuple[Expression, bool]]:
    low, high = slot_range(expression.variable.type)
    if high - low >= MAXIMAL_ALTERNATIVES:
        yield expression, positive
        return
    for value in range(low, high + 1):
        inner = known.with_bound(expression.variable, value)
        yield from _alternatives(fold(expression.body, inner), positive, inner)


def check_predicate(predicate: Expression, known: Known) -> None:
    """Raises UnsupportedError if the predicate cannot be compiled to a goal."""
    for literals in _disjuncts(fold(predicate, known), True, known, predicate.span):
        for atom in literals.atoms:
            check_bound(*interval(atom.bound, known), atom.span)


def _disjuncts(expression: Expression, positive: bool, known: Known, whole: Span) -> tuple[_Literals, ...]:
    """The disjunctive normal form of an expression or of its negation."""
    if not mentions_time(expression):
        return (_Literals(tuple(conjuncts(expression, positive))),)
    match expression:
        case Deadlock():
            return (_Literals(deadlock=DeadlockLiteral.REQUIRED if positive else DeadlockLiteral.FORBIDDEN),)
        case Unary(UnaryOperator.NOT, operand):
            return _disjuncts(operand, not positive, known, whole)
        case Binary() if is_conjunction(expression) is not None:
            (left, left_positive), (right, _) = sides(expression, positive)
            one = _disjuncts(left, left_positive, known, whole)
            other = _disjuncts(right, positive, known, whole)
            if is_conjunction(expression, positive):
                return _product(one, other, whole)
            return _union(left, left_positive, one, other, whole)
        case Binary(BinaryOperator.XOR | BinaryOperator.EQUAL | BinaryOperator.NOT_EQUAL as operator, left, right) if (
            _is_condition(left) and _is_condition(right)
        ):
            equal = (operator is BinaryOperator.EQUAL) == positive
            both_true = _product(_disjuncts(left, True, known, whole), _disjuncts(right, equal, known, whole), whole)
            both_false = _product(
                _disjuncts(left, False, known, whole), _disjuncts(right, not equal, known, whole), whole
            )
            return _limited(both_true + both_false, whole)
        case Binary(operator) if operator in COMPARISONS:
            atoms = clock_atoms(expression, positive, known)
            if isinstance(atoms, tuple):
                if any(asks_deadlock(atom.bound) for conjunction in atoms for atom in conjunction):
                    raise _no_number(expression.span)
                return tuple(_Literals(atoms=conjunction) for conjunction in atoms)
            if not mentions_time(atoms):
                return _disjuncts(atoms, True, known, whole)
        case Conditional(condition, then, otherwise):
            one = _product(_disjuncts(condition, True, known, whole), _disjuncts(then, positive, known, whole), whole)
            other = _product(
                _disjuncts(condition, False, known, whole), _disjuncts(otherwise, positive, known, whole), whole
            )
            return _limited(one + other, whole)
        case Quantifier(kind) if kind is not QuantifierKind.SUM:
            return _quantifier(expression, positive, known, whole)
    if not reads_clock(expression):
        raise _no_number(expression.span)
    raise clock_form_unsupported(expression.span)


def _no_number(span: Span) -> UnsupportedError:
    message = "`deadlock` is not a number to compare or to count with"
    return UnsupportedError(
        Diagnostic("E0706", message, span, "join it with other conditions by `and`, `or`, `not` or `imply`")
    )


def _quantifier(expression: Quantifier, positive: bool, known: Known, whole: Span) -> tuple[_Literals, ...]:
    low, high = slot_range(expression.variable.type)
    conjunctive = (expression.kind is QuantifierKind.FORALL) == positive
    result: tuple[_Literals, ...] = (_Literals(),) if conjunctive else ()
    for value in range(low, high + 1):
        inner = known.with_bound(expression.variable, value)
        instance = _disjuncts(fold(expression.body, inner), positive, inner, whole)
        result = _product(result, instance, whole) if conjunctive else _limited(result + instance, whole)
    return result


def mentions_time(expression: Expression) -> bool:
    """True if the expression compares clocks or contains ``deadlock``."""
    return reads_clock(expression) or asks_deadlock(expression)


def _is_condition(expression: Expression) -> bool:
    """True if the expression is a truth value rather than a clock, a difference or a number."""
    match expression:
        case Binary(operator):
            return operator.group is not OperandGroup.ARITHMETIC
        case Unary(UnaryOperator.NOT, _) | Deadlock():
            return True
        case Quantifier(kind):
            return kind is not QuantifierKind.SUM
        case _:
            pass
    return not reads_clock(expression)


def _union(
    left: Expression, left_positive: bool, one: tuple[_Literals, ...], other: tuple[_Literals, ...], whole: Span
) -> tuple[_Literals, ...]:
    """A disjunction. The right side is evaluated only where the left one is false, if that can prevent an error."""
    if not mentions_time(left) and any(literals.can_fail for literals in other):
        guard = _Literals((negate(left) if left_positive else left,))
        other = _product((guard,), other, whole)
    return _limited(one + other, whole)


def _product(one: tuple[_Literals, ...], other: tuple[_Literals, ...], whole: Span) -> tuple[_Literals, ...]:
    if len(one) * len(other) > MAXIMAL_DISJUNCTS:
        raise _too_large(whole)
    result = []
    for first in one:
        for second in other:
            if first.deadlock * second.deadlock < 0:
                continue
            deadlock = first.deadlock or second.deadlock
            result.append(_Literals(first.integers + second.integers, first.atoms + second.atoms, deadlock))
    return tuple(result)


def _limited(literals: tuple[_Literals, ...], whole: Span) -> tuple[_Literals, ...]:
    if len(literals) > MAXIMAL_DISJUNCTS:
        raise _too_large(whole)
    return literals


def _too_large(span: Span) -> UnsupportedError:
    return UnsupportedError(
        Diagnostic(
            "E0707",
            f"the disjunctive normal form of this predicate has more than {MAXIMAL_DISJUNCTS} disjuncts",
            span,
            "split the property, or move clock comparisons out of nested disjunctions",
        )
    )
