"""Random obligations over the predicates of a random case."""

from __future__ import annotations

from random import Random

from tachk.base.operators import BinaryOperator
from tachk.engine.outcome import Obligation
from tachk.model.connectives import negation
from tachk.model.expressions import BOOL, Binary, Expression
from tachk.model.random_networks import RandomCase


def random_obligations(random: Random, case: RandomCase, count: int = 2) -> tuple[Obligation, ...]:
    """Half of them begin where another predicate holds; goals are met now and then."""
    return tuple(
        Obligation(_goal(random, case), _trigger(random, case) if random.random() < 0.5 else None) for _ in range(count)
    )


def _goal(random: Random, case: RandomCase) -> Expression:
    kind = random.random()
    one = random.choice(case.predicates)
    if kind < 0.3:
        return one
    if kind < 0.55:
        return negation(one)
    other = random.choice(case.predicates)
    return either(negation(one) if kind < 0.75 else one, other)


def _trigger(random: Random, case: RandomCase) -> Expression:
    one, other = random.choice(case.predicates), random.choice(case.predicates)
    return random.choice([one, one, negation(one), either(one, other)])


def either(one: Expression, other: Expression) -> Expression:
    return Binary(BinaryOperator.OR, one, other, BOOL, one.span)
