"""The least and the largest values that tachk finds, held against an oracle that only says what is reachable."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from random import Random

from tachk.base.operators import BinaryOperator
from tachk.base.words import QueryKind
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import Status
from tachk.model.expressions import BOOL, Binary, Constant, Expression, Reference
from tachk.model.query import Query
from tachk.model.random_networks import RandomCase
from tachk.model.types import ClockType, IntType
from tachk.verify.verdict import Answer, Extreme
from tachk.verify.verify import verify
from tests.support.oracles import digitised

FAR = 40
"""A value that counts as being without limit."""

_O = BinaryOperator


@dataclass(frozen=True, slots=True)
class ExtremesAgreement:
    """Attributes:
    decided: how many values were found.
    unlimited: how many of them have no limit.
    strict: how many are approached and not taken.
    never: how many questions were about states that are not reachable.
    problems: what cannot be right.
    """

    decided: int = 0
    unlimited: int = 0
    strict: int = 0
    never: int = 0
    problems: tuple[str, ...] = ()


def expressions_of(case: RandomCase, random: Random, differences: bool) -> tuple[Expression, ...]:
    """Some that can be measured: a clock, an integer and perhaps the difference of two clocks."""
    variables = [variable for variable in case.network.all_variables() if not variable.declared_meta]
    clocks = [Reference(variable) for variable in variables if isinstance(variable.type, ClockType)]
    integers = [Reference(variable) for variable in variables if isinstance(variable.type, IntType)]
    found: list[Expression] = [random.choice(kind) for kind in (clocks, integers) if kind]
    if differences and len(clocks) > 1:
        left, right = random.sample(clocks, 2)
        found.append(Binary(_O.SUBTRACT, left, right, left.type))
    return tuple(found)


def compare_extremes(
    case: RandomCase, expressions: Sequence[Expression], options: Sequence[Options], oracle_states: int = 1500
) -> ExtremesAgreement:
    """Asks for the bounds of expressions over the first predicate of a case, with each of the options."""
    where = case.predicates[0]
    result = ExtremesAgreement()
    for expression in expressions:
        query = Query("q", QueryKind.BOUNDS, where, (expression,))
        values: set[tuple[object, ...]] = set()
        for each in options:
            (verdict,) = verify(case.network, [query], each, Limits(states=20_000))
            if verdict.answer is Answer.UNKNOWN:
                continue
            found = tuple((e.least, e.largest) for e in verdict.extremes)
            values.add(tuple((x.value, x.strict) for pair in found for x in pair if x is not None))
            problems = list(_missing_runs(found))
            if problems:
                result = replace(result, problems=(*result.problems, *problems))
        if len(values) > 1:
            return replace(result, problems=(*result.problems, f"the options disagree: {values}"))
        if not values:
            continue
        problems = list(_against_oracle(case, where, expression, found[0] if found else None, oracle_states))
        result = replace(
            result,
            decided=result.decided + 1,
            never=result.never + (not found),
            unlimited=result.unlimited + any(x is not None and x.value is None for pair in found for x in pair),
            strict=result.strict + any(x is not None and x.strict for pair in found for x in pair),
            problems=(*result.problems, *problems),
        )
    return result


def _missing_runs(found: Sequence[tuple[Extreme | None, Extreme | None]]) -> Iterator[str]:
    for pair in found:
        for extreme in pair:
            taken = extreme is not None and extreme.value is not None and not extreme.strict
            if extreme is not None and taken is not (extreme.run is not None):
                yield f"the value {extreme.value} has {'no' if taken else 'a'} run"


def _against_oracle(
    case: RandomCase,
    where: Expression,
    expression: Expression,
    found: tuple[Extreme | None, Extreme | None] | None,
    states: int,
) -> Iterator[str]:
    """What the oracle contradicts: each claim is that some states are reachable, or that some are not."""
    claims: list[tuple[str, Expression, Status]] = []
    if found is None:
        claims.append(("nothing", where, Status.UNREACHABLE))
    else:
        least, largest = found
        assert least is not None and largest is not None
        claims += _claims(where, expression, largest, _O.GREATER, _O.GREATER_EQUAL, 1)
        claims += _claims(where, expression, least, _O.LESS, _O.LESS_EQUAL, -1)
    for what, goal, expected in claims:
        status = digitised.explore_regions(case.network, [goal], Limits(states=states)).goals[0].status
        if status not in (expected, Status.UNDECIDED):
            yield f"{what} is {status.value} for the oracle"


def _claims(
    where: Expression, expression: Expression, found: Extreme, beyond: _O, at: _O, sign: int
) -> Iterator[tuple[str, Expression, Status]]:
    def goal(operator: _O, value: int) -> Expression:
        return Binary(_O.AND, where, Binary(operator, expression, Constant(value), BOOL), BOOL)

    value = found.value
    if value is None:
        yield "a value far out", goal(beyond, sign * FAR), Status.REACHED
    elif found.strict:
        yield f"{at.value} {value}", goal(at, value), Status.UNREACHABLE
        yield f"{beyond.value} {value - sign}", goal(beyond, value - sign), Status.REACHED
    else:
        yield f"{beyond.value} {value}", goal(beyond, value), Status.UNREACHABLE
        yield f"{value}", goal(_O.EQUAL, value), Status.REACHED
