"""Freezing what cannot influence an answer."""

from __future__ import annotations

from random import Random

import pytest

from tachk.base.span import Source
from tachk.engine import zone
from tachk.engine.compiler.lower import lower
from tachk.engine.options import Limits, Options
from tachk.formats.loading.load import load_model
from tachk.model.expressions import Expression
from tachk.model.random_networks import Shape, random_case
from tachk.transform.cone_of_influence import cone_of_influence
from tests.support.seeds import enough, seeds

MODEL = """
clock x; int n = 0; int noise = 0;
broadcast chan tick; chan hand;

process Main() {
    init location A { to A { guard x >= 1; sync tick!; assign x = 0, n = (n + 1) % 3; } to A { sync hand!; } }
}
process Listener() {
    int heard = 0;
    init location Off { to On { sync tick?; assign heard = n; } }
    location On { to Off; }
}
process Second() {
    init location Off { to On { guard noise > 0; } }
    location On;
}
process Writer() {
    init location Off { to Off { sync tick?; assign noise = 1; } }
}
process Partner() { init location Off { to Off { sync hand?; } } }
process Committed() {
    init location Off { to On { sync tick?; } }
    committed location On { to Off; }
}
process Bounded() { clock y; init location Off { invariant y <= 3; to Off { assign y = 0; } } }

system Main, Listener, Second, Writer, Partner, Committed, Bounded;
"""


def still_for(query: str, text: str = MODEL) -> list[str]:
    loaded = load_model(Source("model.ta", f"{text}\nproperty P : E<> {query};"))
    network = cone_of_influence(loaded.network, [target(loaded.queries[0].predicate)]).network
    assert [process.name for process in network.processes] == [process.name for process in loaded.network.processes]
    return [
        process.name
        for process, before in zip(network.processes, loaded.network.processes, strict=True)
        if process.edges != before.edges
    ]


def target(predicate: Expression | None) -> Expression:
    assert predicate is not None
    return predicate


@pytest.mark.parametrize(
    ("query", "still"),
    [
        ("n == 2", ["Listener", "Second", "Writer"]),
        ("Listener.On", ["Second", "Writer"]),
        ("Listener.heard == 1", ["Second", "Writer"]),
        ("Second.On", ["Listener"]),
        ("Second.Off && Listener.On", []),
        ("noise == 1", ["Listener", "Second"]),
        ("deadlock", []),
    ],
)
def test_what_cannot_influence_the_target_is_frozen(query: str, still: list[str]) -> None:
    assert still_for(query) == still


def test_nothing_is_frozen_beside_priorities() -> None:
    assert still_for("n == 2", MODEL.replace("process Main", "chan priority hand < default;\nprocess Main")) == []


def test_a_write_through_a_reference_parameter_counts() -> None:
    text = MODEL.replace("assign noise = 1", "assign raise(noise)").replace(
        "process Main", "void raise(int &v) { v = 1; }\nprocess Main"
    )
    assert still_for("Second.On", text) == ["Listener"]


def test_verdicts_do_not_depend_on_what_is_outside() -> None:
    shape = Shape(processes=2, receivers=2, clocks=2)
    limits = Limits(states=20_000)
    held = 0
    for seed in seeds(range(70)):
        case = random_case(Random(seed), shape)
        for predicate in case.predicates:
            smaller = cone_of_influence(case.network, [predicate]).network
            held += smaller != case.network
            found = [
                zone.explore(*lower(network, [predicate]), Options(), limits).goals[0].status
                for network in (case.network, smaller)
            ]
            assert found[0] is found[1], seed
    assert enough(held > 70)
