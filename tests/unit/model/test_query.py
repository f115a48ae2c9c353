"""What a query looks for."""

from __future__ import annotations

import pytest

from tachk.base.operators import UnaryOperator
from tachk.base.words import QueryKind
from tachk.model.expressions import Constant, Unary
from tachk.model.query import Query

PREDICATE = Constant(1)


def test_a_possibility_looks_for_its_predicate_and_holds_where_it_is_reached() -> None:
    query = Query("q", QueryKind.POSSIBLY, PREDICATE)
    assert (query.target, query.holds_when_reached) == (PREDICATE, True)


def test_an_invariant_looks_for_its_violation_and_fails_where_it_is_reached() -> None:
    query = Query("q", QueryKind.INVARIANTLY, PREDICATE)
    assert isinstance(query.target, Unary)
    assert (query.target.operator, query.target.operand) == (UnaryOperator.NOT, PREDICATE)
    assert query.holds_when_reached is False


@pytest.mark.parametrize("kind", sorted(set(QueryKind) - {QueryKind.POSSIBLY, QueryKind.INVARIANTLY}))
def test_no_other_kind_is_decided_by_a_state_that_is_reached(kind: QueryKind) -> None:
    query = Query("q", kind, PREDICATE)
    assert (query.target, query.holds_when_reached) == (None, None)
