"""Features are found with their places, and what cannot be checked is refused by name."""

from __future__ import annotations

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UnsupportedError
from tachk.base.diagnostics.explanation import all_explanations
from tachk.base.words import QueryKind
from tachk.engine.compiler.features import check_supported, stopwatches, urgent_clock_guards
from tachk.model.builder import NetworkBuilder, Term, bound_variable, deadlock
from tachk.model.query import Query
from tachk.model.selections import check_selections
from tachk.model.types import IntType


def query(predicate: Term, kind: QueryKind = QueryKind.POSSIBLY) -> Query:
    return Query("q1", kind, predicate.expression)


def test_a_plain_network_uses_nothing_special() -> None:
    network = NetworkBuilder()
    c, d = network.channel("c", broadcast=True), network.channel("d", broadcast=True, urgent=True)
    p = network.process("P")
    x = p.clock("x")
    a = p.location("a", invariant=x <= 3, rates=[(x, 1)])
    p.edge(a, a, guard=x >= 1, send=c)
    p.edge(a, a, guard=x >= 1, receive=d)
    p.edge(a, a, send=d)
    built = network.build()
    assert (list(stopwatches(built)), list(urgent_clock_guards(built))) == ([], [])


def test_uses_are_named() -> None:
    network = NetworkBuilder()
    c, d = network.channel("c", broadcast=True, urgent=True), network.channel("d", urgent=True)
    p = network.process("P")
    x, y = p.clock("x"), p.clock("y")
    a = p.location("a", rates=[(y, 0), (x, 1)])
    b = p.location("b", rates=[(x, 1)])
    p.edge(a, b, guard=x >= 1, send=c)
    p.edge(b, b, guard=x >= 1, receive=d)
    built = network.build()
    assert [use.what for use in stopwatches(built)] == ["the location P.a"]
    assert [use.what for use in urgent_clock_guards(built)] == ["the edge a -> b of P", "the edge b -> b of P"]


def refusal(network: NetworkBuilder, question: Query) -> str:
    with pytest.raises(UnsupportedError) as caught:
        check_supported(network.build(), question)
    assert caught.value.diagnostic.code in all_explanations()
    return caught.value.diagnostic.code


@pytest.mark.parametrize("kind", [QueryKind.EVENTUALLY, QueryKind.POTENTIALLY_ALWAYS])
def test_deadlock_is_rejected_in_queries_about_runs_with_stopwatches(kind: QueryKind) -> None:
    network = NetworkBuilder()
    process = network.process("P")
    x = process.clock("x")
    a = process.location("a", rates=[(x, 0)])
    check_supported(network.build(), query(a.reached, kind))
    assert refusal(network, query(a.reached & ~deadlock(), kind)) == "E0720"


def test_reachability_and_deadlock_are_supported() -> None:
    network = NetworkBuilder()
    a = network.process("P").location("a")
    for kind in (QueryKind.POSSIBLY, QueryKind.INVARIANTLY):
        check_supported(network.build(), query(a.reached & ~deadlock(), kind))


@pytest.mark.parametrize("sends", [True, False])
def test_a_clock_guard_on_an_urgent_channel_is_rejected(sends: bool) -> None:
    network = NetworkBuilder()
    c = network.channel("c", urgent=True)
    p = network.process("P")
    x = p.clock("x")
    a = p.location("a")
    p.edge(a, a, guard=x >= 1, send=c if sends else None, receive=None if sends else c)
    assert refusal(network, query(a.reached)) == "E0721"


def test_a_receiver_of_an_urgent_broadcast_may_have_a_clock_guard() -> None:
    network = NetworkBuilder()
    c = network.channel("c", urgent=True, broadcast=True)
    p = network.process("P")
    x = p.clock("x")
    a = p.location("a")
    p.edge(a, a, guard=x >= 1, receive=c)
    check_supported(network.build(), query(a.reached))


def test_a_predicate_that_is_too_large_when_negated_is_rejected_under_invariantly_only() -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    network.process("P").location("a")
    predicate = (x < 0) & (y > 0)
    for i in range(1, 13):
        predicate = predicate | ((x < i) & (y > i))
    check_supported(network.build(), query(predicate))
    assert refusal(network, query(predicate, QueryKind.INVARIANTLY)) == "E0707"


@pytest.mark.parametrize("query", ["A<> {}", "P(1).A --> {}", "{} --> P(1).A", "E[] not ({})"])
def test_a_predicate_that_is_too_large_when_negated_leaves_other_queries_of_runs_their_answers(query: str) -> None:
    model = tachk.loads(
        "typedef int[1,6] id_t; process P(const id_t me) { clock x; state A, B; init A;"
        " trans A -> B { guard x > 1; }; } system P;"
    )
    large = "exists (i : id_t) exists (j : id_t) i != j && P(i).B && P(j).x > 3"
    report = model.verify("E<> P(1).B", query.format(large), trace=False)
    assert [verdict.answer.name for verdict in report] == ["HOLDS", "UNKNOWN"]
    assert report[1].unsupported is not None and report[1].unsupported.code == "E0707"


def test_selections_that_cannot_all_be_tried_are_rejected() -> None:
    network = NetworkBuilder()
    p = network.process("P")
    a = p.location("a")
    i, j = bound_variable("i", IntType(0, 30000)), bound_variable("j", IntType(0, 30000))
    p.edge(a, a, selects=[i, j], guard=i == j)
    with pytest.raises(UnsupportedError, match="900060001 combinations") as caught:
        check_selections(network.build())
    assert caught.value.diagnostic.code == "E0708"
