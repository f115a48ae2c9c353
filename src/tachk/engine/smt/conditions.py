"""Guards, invariants and predicates as formulas: what is evaluated in which order, as docs/semantics.md says."""

from __future__ import annotations

from collections.abc import Iterator

from tachk.base.operators import BinaryOperator, UnaryOperator
from tachk.engine.smt.machine import Machine, PossibleFault, or_false
from tachk.engine.smt.terms import Formula, any_of, conj, disj, neg
from tachk.model.connectives import is_conjunction, sides
from tachk.model.expressions import Binary, Conditional, Expression, Quantifier, QuantifierKind, Unary
from tachk.model.types import ScalarLike, bounds

_Excuses = tuple[tuple[Expression, bool], ...]
"""The excuse of a part of a condition: an expression with the truth value that makes the part superfluous."""


def guard(machine: Machine, condition: Expression | None) -> tuple[Formula, Formula]:
    """The integer conditions of a guard or an invariant, and the whole of it; None stands for true."""
    if condition is None:
        return True, True
    integer: Formula = True
    for excuses, part, positive in _parts(machine, condition, True, ()):
        if not machine.depends_on_clocks(part):
            integer = conj(integer, _unless_excused(machine, integer, excuses, part, positive))
    whole = integer
    for excuses, part, positive in _parts(machine, condition, True, ()):
        if machine.depends_on_clocks(part):
            whole = conj(whole, _unless_excused(machine, integer, excuses, part, positive))
    return integer, whole


def _unless_excused(
    machine: Machine, demanded: Formula, excuses: _Excuses, part: Expression, positive: bool
) -> Formula:
    excused: Formula = False
    for expression, wanted in excuses:

        def value(expression: Expression = expression) -> Formula:
            return machine.truth(expression)

        truth = or_false(machine.under(conj(demanded, neg(excused)), value))
        excused = disj(excused, truth if wanted else neg(truth))
    truth = or_false(machine.under(conj(demanded, neg(excused)), lambda: machine.truth(part)))
    return disj(excused, truth if positive else neg(truth))


def _parts(
    machine: Machine, condition: Expression, positive: bool, excuses: _Excuses
) -> Iterator[tuple[_Excuses, Expression, bool]]:
    """The conjuncts of a condition, or (not positive) of its negation, with what excuses from each; quantified
    variables are bound in the machine while one is looked at."""
    if not machine.depends_on_clocks(condition):
        yield excuses, condition, positive
        return
    match condition:
        case Unary(UnaryOperator.NOT, operand):
            yield from _parts(machine, operand, not positive, excuses)
        case Binary() if is_conjunction(condition) is not None:
            (left, left_positive), (right, _) = sides(condition, positive)
            if is_conjunction(condition, positive):
                yield from _parts(machine, left, left_positive, excuses)
                yield from _parts(machine, right, positive, excuses)
            elif not machine.depends_on_clocks(left):
                yield from _parts(machine, right, positive, (*excuses, (left, left_positive)))
            elif not machine.depends_on_clocks(right):
                yield from _parts(machine, left, left_positive, (*excuses, (right, positive)))
            else:
                yield excuses, condition, positive
        case Conditional(test, then, otherwise) if not machine.depends_on_clocks(test):
            yield from _parts(machine, then, positive, (*excuses, (test, False)))
            yield from _parts(machine, otherwise, positive, (*excuses, (test, True)))
        case Quantifier(kind, variable, body) if kind is (QuantifierKind.FORALL if positive else QuantifierKind.EXISTS):
            assert isinstance(variable.type, ScalarLike)
            low, high = bounds(variable.type)
            for value in range(low, high + 1):
                machine.bind(variable, value)
                yield from _parts(machine, body, positive, excuses)
        case _:
            yield excuses, condition, positive


def certain(machine: Machine, predicate: Expression, wrong: list[PossibleFault]) -> tuple[Formula, Formula]:
    """The formulas that a predicate is true, and that it is false, whatever its parts are that cannot be evaluated.

    Args:
        wrong: takes the run-time errors that are possible.
    """
    match predicate:
        case Unary(UnaryOperator.NOT, operand):
            yes, no = certain(machine, operand, wrong)
            return no, yes
        case Binary(operator, left, right) if is_conjunction(predicate) is not None:
            (yes, no), (also, nor) = certain(machine, left, wrong), certain(machine, right, wrong)
            if operator is BinaryOperator.AND:
                return conj(yes, also), disj(no, nor)
            if operator is BinaryOperator.IMPLY:
                yes, no = no, yes
            return disj(yes, also), conj(no, nor)
        case Conditional(test, then, otherwise):
            yes, no = certain(machine, test, wrong)
            (yes_then, no_then), (yes_else, no_else) = certain(machine, then, wrong), certain(machine, otherwise, wrong)
            return (
                disj(conj(yes, yes_then), conj(no, yes_else)),
                disj(conj(yes, no_then), conj(no, no_else)),
            )
        case _:
            before = len(machine.faults)
            truth = machine.truth(predicate)
            fails = any_of(fault.condition for fault in machine.faults[before:])
            wrong += machine.faults[before:]
            del machine.faults[before:]
            return conj(truth, neg(fails)), conj(neg(truth), neg(fails))
