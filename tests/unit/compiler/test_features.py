"""Features are found with their places, and what cannot be checked is refused by name."""

from __future__ import annotations

import pytest

from tachk.compiler.features import Feature, check_selections, check_supported, network_features, query_features
from tachk.diagnostics.codes.all_codes import CODES
from tachk.diagnostics.diagnostic import UnsupportedError
from tachk.model.builder import NetworkBuilder, Term, bound_variable, deadlock
from tachk.model.query import Query, QueryKind
from tachk.model.types import IntType


def query(predicate: Term, kind: QueryKind = QueryKind.POSSIBLY) -> Query:
    return Query("q1", kind, predicate.expression)


def features_of(network: NetworkBuilder) -> set[tuple[Feature, str]]:
    return {(use.feature, use.what) for use in network_features(network.build()).uses}


def test_a_plain_network_has_no_features() -> None:
    network = NetworkBuilder()
    c = network.channel("c", broadcast=True)
    p = network.process("P")
    x = p.clock("x")
    a = p.location("a", invariant=x <= 3)
    p.edge(a, a, guard=x >= 1, send=c)
    assert features_of(network) == set()


def test_features_of_locations_and_edges() -> None:
    network = NetworkBuilder()
    c, d = network.channel("c", broadcast=True), network.channel("d", urgent=True)
    network.channel("e", priority=4)
    p = network.process("P")
    q = network.process("Q", priority=1)
    x, y = p.clock("x"), p.clock("y")
    a = p.location("a", invariant=~(x >= 3), rates=[(y, 0)])
    b = p.location("b", rates=[(x, 1)])
    p.edge(a, b, guard=x - y >= 1)
    p.edge(b, a, guard=x >= 1, receive=c)
    p.edge(b, b, guard=x >= 1, send=d)
    q.location("c")
    assert features_of(network) == {
        (Feature.PRIORITIES, "the channel e"),
        (Feature.PRIORITIES, "the process Q"),
        (Feature.STRICT_BOUNDS, "the location P.a"),
        (Feature.STOPWATCHES, "the location P.a"),
        (Feature.DIAGONALS, "the edge a -> b of P"),
        (Feature.BROADCAST_CLOCK_GUARDS, "the edge b -> a of P"),
        (Feature.URGENT_CLOCK_GUARDS, "the edge b -> b of P"),
    }


def test_features_of_a_query() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    found = query_features(query(deadlock() & (x > 3)))
    assert Feature.DEADLOCK in found
    assert Feature.STRICT_BOUNDS in found
    assert Feature.DIAGONALS not in found


def refusal(network: NetworkBuilder, question: Query) -> str:
    with pytest.raises(UnsupportedError) as caught:
        check_supported(network.build(), question)
    assert caught.value.diagnostic.code in CODES
    return caught.value.diagnostic.code


@pytest.mark.parametrize(
    "kind", [kind for kind in QueryKind if kind not in (QueryKind.POSSIBLY, QueryKind.INVARIANTLY)]
)
def test_other_operators_are_refused_by_name(kind: QueryKind) -> None:
    network = NetworkBuilder()
    a = network.process("P").location("a")
    with pytest.raises(UnsupportedError) as caught:
        check_supported(network.build(), query(a.reached, kind))
    assert caught.value.diagnostic.code == "E0720"
    assert f"`{kind.value}`" in caught.value.diagnostic.message


def test_reachability_and_deadlock_are_supported() -> None:
    network = NetworkBuilder()
    a = network.process("P").location("a")
    for kind in (QueryKind.POSSIBLY, QueryKind.INVARIANTLY):
        check_supported(network.build(), query(a.reached & ~deadlock(), kind))


@pytest.mark.parametrize("sends", [True, False])
def test_a_clock_guard_on_an_urgent_channel_is_refused(sends: bool) -> None:
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


def test_a_predicate_that_is_too_large_when_negated_is_refused_under_invariantly_only() -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    network.process("P").location("a")
    predicate = (x < 0) & (y > 0)
    for i in range(1, 13):
        predicate = predicate | ((x < i) & (y > i))
    check_supported(network.build(), query(predicate))
    assert refusal(network, query(predicate, QueryKind.INVARIANTLY)) == "E0707"


def test_selections_that_cannot_all_be_tried_are_refused() -> None:
    network = NetworkBuilder()
    p = network.process("P")
    a = p.location("a")
    i, j = bound_variable("i", IntType(0, 30000)), bound_variable("j", IntType(0, 30000))
    p.edge(a, a, selects=[i, j], guard=i == j)
    with pytest.raises(UnsupportedError, match="900060001 combinations") as caught:
        check_selections(network.build())
    assert caught.value.diagnostic.code == "E0708"
