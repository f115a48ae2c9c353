"""The clock constraints of a condition in a given discrete state.

Everything but the comparisons of clocks is evaluated; what is left is brought into disjunctive normal form. What is
evaluated, and in which order, is the rule for run-time errors in docs/semantics.md; `conditional_constraints` has it
for guards and invariants, `certain` for the predicates of queries.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from tachk.base.job import check_job
from tachk.base.operators import BinaryOperator, UnaryOperator
from tachk.meaning.dbm import INFINITY, LESS_EQUAL_ZERO, Constraint, add, bound_value, complement, raw_bound
from tachk.model.evaluate import Environment, clock_number, evaluate
from tachk.model.expressions import Binary, Comma, Conditional, Expression, Quantifier, QuantifierKind, Unary
from tachk.model.fault import EvaluationFault
from tachk.model.traversal import ClockDependence, depends_on_clocks
from tachk.model.types import ClockType, ScalarLike, bounds

Conjunction = tuple[Constraint, ...]
Disjunction = list[Conjunction]
"""Disjunctive normal form: the empty list is false, the empty conjunction true."""

TRUE: Disjunction = [()]
FALSE: Disjunction = []
_FEW = 256
"""The number of conjunctions up to which each is compared with each."""


class TooManyConjunctionsError(Exception):
    """A condition is a disjunction of more conjunctions than its reader allows."""


def conditional_constraints(condition: Expression | None, environment: Environment) -> Disjunction:
    """The disjunctive normal form of a guard or an invariant; None stands for true.

    First the integer conditions of the conjunction are evaluated from left to right, as far as they are true; then
    the bounds of all clock comparisons. Where one side of a disjunction compares clocks, the other one is evaluated
    before it. Raises EvaluationFault, and ValueError for a comparison that is not a difference constraint.
    """
    if condition is None:
        return TRUE
    timed = ClockDependence()
    for excuses, part, positive in _parts(condition, True, (), environment, timed):
        if not timed(part) and not _excused(excuses, environment):
            if (evaluate(part, environment) != 0) is not positive:
                return FALSE
    result = TRUE
    for excuses, part, positive in _parts(condition, True, (), environment, timed):
        if timed(part) and not _excused(excuses, environment):
            result = conjunction(result, disjunctive(part, environment, not positive))
    return result


_Excuses = tuple[tuple[Expression, bool], ...]


def _excused(excuses: _Excuses, environment: Environment) -> bool:
    """True if something makes the evaluation of a part superfluous: an expression with its truth for that."""
    return any((evaluate(expression, environment) != 0) is wanted for expression, wanted in excuses)


def _parts(
    condition: Expression,
    positive: bool,
    excuses: _Excuses,
    environment: Environment,
    timed: ClockDependence,
) -> Iterator[tuple[_Excuses, Expression, bool]]:
    """The conjuncts of a condition, or (not positive) of its negation, with what excuses from each; quantified
    variables are bound in the environment while one is looked at."""
    if not timed(condition):
        yield excuses, condition, positive
        return
    match condition:
        case Unary(UnaryOperator.NOT, operand):
            yield from _parts(operand, not positive, excuses, environment, timed)
        case Binary(BinaryOperator.AND | BinaryOperator.OR | BinaryOperator.IMPLY as operator, left, right):
            left_positive = positive if operator is not BinaryOperator.IMPLY else not positive
            if (operator is BinaryOperator.AND) is positive:
                yield from _parts(left, left_positive, excuses, environment, timed)
                yield from _parts(right, positive, excuses, environment, timed)
            elif not timed(left):
                yield from _parts(right, positive, (*excuses, (left, left_positive)), environment, timed)
            elif not timed(right):
                yield from _parts(left, left_positive, (*excuses, (right, positive)), environment, timed)
            else:
                yield excuses, condition, positive
        case Conditional(test, then, otherwise) if not timed(test):
            yield from _parts(then, positive, (*excuses, (test, False)), environment, timed)
            yield from _parts(otherwise, positive, (*excuses, (test, True)), environment, timed)
        case Quantifier(kind, variable, body) if kind is (QuantifierKind.FORALL if positive else QuantifierKind.EXISTS):
            assert isinstance(variable.type, ScalarLike)
            low, high = bounds(variable.type)
            for value in range(low, high + 1):
                environment.bind(variable, value)
                yield from _parts(body, positive, excuses, environment, timed)
        case _:
            yield excuses, condition, positive


def certain(
    predicate: Expression, environment: Environment, negated: bool = False, unknown: Disjunction = FALSE
) -> Disjunction:
    """The valuations at which a predicate, or its negation, is true whatever its parts are that cannot be evaluated;
    with TRUE for unknown, those at which it may be true.

    The disjunctive normal form in Kleene's logic, an error being the third value.
    """
    if not _is_connected(predicate):
        try:
            return disjunctive(predicate, environment, negated)
        except EvaluationFault:
            return unknown
    match predicate:
        case Unary(UnaryOperator.NOT, operand):
            return certain(operand, environment, not negated, unknown)
        case Binary(BinaryOperator.AND | BinaryOperator.OR | BinaryOperator.IMPLY as operator, left, right):
            left_negated = negated if operator is not BinaryOperator.IMPLY else not negated
            one = certain(left, environment, left_negated, unknown)
            other = certain(right, environment, negated, unknown)
            return conjunction(one, other) if (operator is BinaryOperator.AND) is not negated else union(one, other)
        case Conditional(test, then, otherwise):
            is_true, is_false = (certain(test, environment, no, unknown) for no in (False, True))
            return union(
                conjunction(is_true, certain(then, environment, negated, unknown)),
                conjunction(is_false, certain(otherwise, environment, negated, unknown)),
            )
        case _:
            raise TypeError(f"{type(predicate).__name__} connects no predicates")


def alternatives(predicate: Expression, negated: bool = False) -> Iterator[tuple[Expression, bool]]:
    """Predicates, or (True) their negations, of which one is true, or a run-time error, wherever the given one is."""
    match predicate:
        case Unary(UnaryOperator.NOT, operand):
            yield from alternatives(operand, not negated)
        case Binary(BinaryOperator.AND, left, right) if negated:
            yield from (*alternatives(left, True), *alternatives(right, True))
        case Binary(BinaryOperator.OR | BinaryOperator.IMPLY as operator, left, right) if not negated:
            yield from alternatives(left, operator is BinaryOperator.IMPLY)
            yield from alternatives(right)
        case _:
            yield predicate, negated


def _is_connected(predicate: Expression) -> bool:
    match predicate:
        case Unary(UnaryOperator.NOT) | Binary(BinaryOperator.AND | BinaryOperator.OR | BinaryOperator.IMPLY):
            return True
        case Conditional():
            return True
        case _:
            return False


def satisfied(condition: Disjunction, clocks: Sequence[Fraction]) -> bool:
    """True if clock values, entry i for clock number i + 1, satisfy a disjunction."""
    point = (Fraction(0), *clocks)

    def met(constraint: Constraint) -> bool:
        i, j, raw = constraint
        difference, bound = point[i] - point[j], bound_value(raw)
        return raw >= INFINITY or difference < bound or (difference == bound and raw % 2 == 1)

    return any(all(map(met, conjunction)) for conjunction in condition)


def disjunctive(condition: Expression | None, environment: Environment, negated: bool = False) -> Disjunction:
    """The disjunctive normal form of a condition, or of its negation, each part evaluated as it stands in the text;
    None stands for true.

    Raises EvaluationFault, and ValueError for a comparison that is not a difference constraint.
    """
    if condition is None:
        return FALSE if negated else TRUE
    if not depends_on_clocks(condition):
        return TRUE if (evaluate(condition, environment) != 0) is not negated else FALSE
    match condition:
        case Unary(UnaryOperator.NOT, operand):
            return disjunctive(operand, environment, not negated)
        case Binary(BinaryOperator.AND, left, right):
            return _connect(left, False, right, False, environment, negated)
        case Binary(BinaryOperator.OR, left, right):
            return _connect(left, True, right, True, environment, not negated)
        case Binary(BinaryOperator.IMPLY, left, right):
            return _connect(left, False, right, True, environment, not negated)
        case Binary(operator, left, right) if isinstance(left.type, ClockType) or isinstance(right.type, ClockType):
            return _comparison(operator.negated if negated else operator, left, right, environment)
        case Binary(BinaryOperator.XOR | BinaryOperator.EQUAL | BinaryOperator.NOT_EQUAL as operator, left, right):
            same = (operator is BinaryOperator.EQUAL) is not negated
            return union(
                _connect(left, False, right, not same, environment, False),
                _connect(left, True, right, same, environment, False),
            )
        case Conditional(test, then, otherwise):
            return union(
                _connect(test, False, then, negated, environment, False),
                _connect(test, True, otherwise, negated, environment, False),
            )
        case Quantifier(kind, variable, body):
            assert isinstance(variable.type, ScalarLike)
            low, high = bounds(variable.type)
            conjunctive = (kind is QuantifierKind.FORALL) is not negated
            result = TRUE if conjunctive else FALSE
            for value in range(low, high + 1):
                environment.bind(variable, value)
                instance = disjunctive(body, environment, negated)
                result = conjunction(result, instance) if conjunctive else union(result, instance)
            return result
        case Comma(items):
            return disjunctive(items[-1], environment, negated)
        case _:
            raise ValueError(f"{condition.span}: a condition on clocks cannot have this form")


def conjunction(left: Disjunction, right: Disjunction) -> Disjunction:
    check_job()
    return list(dict.fromkeys(a + b for a in left for b in right))


def union(left: Disjunction, right: Disjunction) -> Disjunction:
    """Either of two conditions; what both have is there once."""
    return list(dict.fromkeys(left + right))


def tidied(condition: Disjunction) -> Disjunction:
    """The same condition in fewer words: of several bounds on a difference the tightest, no conjunction that two bounds
    contradict, none twice, and, where there are few, none that implies another one.

    A product of disjunctions over a few clocks stays small if it is tidied after each factor.
    """
    conjunctions: dict[Conjunction, dict[tuple[int, int], int]] = {}
    for constraints in condition:
        tightest = _tightest(constraints)
        if tightest is not None:
            conjunctions.setdefault(tuple(sorted((i, j, raw) for (i, j), raw in tightest.items())), tightest)
    if len(conjunctions) > _FEW:
        return list(conjunctions)
    others = list(conjunctions.values())
    return [
        c for c, own in conjunctions.items() if not any(other is not own and _implies(own, other) for other in others)
    ]


def _tightest(constraints: Conjunction) -> dict[tuple[int, int], int] | None:
    """The bounds by the clocks whose difference they bound; None if two of them contradict each other."""
    found: dict[tuple[int, int], int] = {}
    for i, j, raw in constraints:
        if raw < found.get((i, j), INFINITY):
            found[i, j] = raw
    contradict = any(add(raw, found.get((j, i), INFINITY)) < LESS_EQUAL_ZERO for (i, j), raw in found.items())
    return None if contradict else found


def _implies(one: dict[tuple[int, int], int], other: dict[tuple[int, int], int]) -> bool:
    """True if each bound of the other is met by the one. No two of `tidied` imply each other."""
    return all(one.get(clocks, INFINITY) <= raw for clocks, raw in other.items())


def complemented(condition: Disjunction) -> Disjunction:
    """The valuations at which a condition does not hold."""
    denied = TRUE
    for constraints in condition:
        denied = conjunction(denied, [(complement(constraint),) for constraint in constraints])
    return denied


def _connect(
    left: Expression,
    left_negated: bool,
    right: Expression,
    right_negated: bool,
    environment: Environment,
    negated: bool,
) -> Disjunction:
    """``left and right``, each perhaps negated; negated as a whole it is ``not left or not right``.

    The right side is not evaluated where the left side decides without looking at clocks.
    """
    if not negated:
        first = disjunctive(left, environment, left_negated)
        return FALSE if first == FALSE else conjunction(first, disjunctive(right, environment, right_negated))
    first = disjunctive(left, environment, not left_negated)
    return TRUE if () in first else union(first, disjunctive(right, environment, not right_negated))


def _comparison(operator: BinaryOperator, left: Expression, right: Expression, environment: Environment) -> Disjunction:
    plus_left, minus_left, constant_left = _linear(left, environment)
    plus_right, minus_right, constant_right = _linear(right, environment)
    positive = [c for c in (plus_left, minus_right) if c]
    negative = [c for c in (minus_left, plus_right) if c]
    for clock in list(positive):
        if clock in negative:
            positive.remove(clock)
            negative.remove(clock)
    if len(positive) > 1 or len(negative) > 1:
        raise ValueError(f"{left.span}: a comparison with more than two clocks is not a difference constraint")
    i, j = (positive or [0])[0], (negative or [0])[0]
    bound = constant_right - constant_left
    at_most, below = (i, j, raw_bound(bound, False)), (i, j, raw_bound(bound, True))
    match operator:
        case BinaryOperator.LESS:
            found: Disjunction = [(below,)]
        case BinaryOperator.LESS_EQUAL:
            found = [(at_most,)]
        case BinaryOperator.GREATER:
            found = [(complement(at_most),)]
        case BinaryOperator.GREATER_EQUAL:
            found = [(complement(below),)]
        case BinaryOperator.EQUAL:
            found = [(at_most, complement(below))]
        case BinaryOperator.NOT_EQUAL:
            found = [(below,), (complement(at_most),)]
        case _:
            raise ValueError(f"{left.span}: {operator} does not compare clocks")
    return _simplified(found) if i == j else found


def _simplified(found: Disjunction) -> Disjunction:
    """Without clocks in it, a comparison is true or false: here every entry compares 0 with its bound."""
    return TRUE if any(all(raw >= 1 for _, _, raw in c) for c in found) else FALSE


def _linear(expression: Expression, environment: Environment) -> tuple[int, int, int]:
    """One side of a comparison as ``clock - clock + constant``; clock 0 where there is none."""
    if not isinstance(expression.type, ClockType):
        return 0, 0, evaluate(expression, environment)
    if isinstance(expression, Binary):
        return clock_number(expression.left, environment), clock_number(expression.right, environment), 0
    return clock_number(expression, environment), 0, 0
