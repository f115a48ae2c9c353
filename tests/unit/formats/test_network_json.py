"""Networks as JSON: nothing of their behaviour is lost, and the schema describes it."""

from __future__ import annotations

import json
from pathlib import Path
from random import Random

import jsonschema
import pytest
from hypothesis import given, settings

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.formats.network_json.json_lines import DEEPEST_INDENT, json_pieces
from tachk.formats.network_json.network import (
    network_from_json,
    network_to_json,
    network_to_json_text,
    same_network,
)
from tachk.model.network import Network
from tachk.model.random_networks import RandomCase, Shape, random_case
from tests.support.random_cases import cases

ROOT = Path(__file__).parents[3]
SCHEMA = json.loads((ROOT / "docs/schema/network.schema.json").read_text(encoding="utf-8"))
EVERYTHING = Shape(diagonals=True, priorities=True, stopwatches=True)

RICH = """\
time_unit = 2 s;
const int N = 2;
typedef scalar[3] who_t;
typedef struct { int a[2]; bool b; } pair_t;
pair_t p = { { 1, 2 }, true }, q;
meta int scratch;
who_t owner;
chan c[N];
urgent broadcast chan d;
clock x;
int sum(const int &v[2], int from) {
    int result = 0;
    for (i : int[0, 1]) result += v[i];
    while (from > 0) from--;
    do { result++; } while (result < 0);
    if (result > 3) return -result; else return result;
}
process P(const int[0, 1] id) {
    int n = id ? 1 : 0;
    init location A {
        invariant x <= 5 && x' == n;
        to B { select w : who_t, i : int[0, 1]; guard sum(p.a, i) > 0; sync c[i]!; assign p = q, q.a[i]++, n++; }
    }
    urgent location B { to A { sync d!; assign owner = owner, n = n > 0 ? 0 : 1; } }
    committed location C { to C { sync c[0]?; } }
}
signal level = forall (i : int[0, 1]) p.a[i] > 0;
system P;
"""


def rich() -> Network:
    return load_model(Source("rich.ta", RICH)).network


def test_a_rich_network_survives() -> None:
    text = json.dumps(network_to_json(rich()))
    back = network_from_json(json.loads(text))
    assert same_network(back, rich())
    assert back.time_unit == "2 s"
    assert back.constants == (("N", 2),)


@settings(max_examples=40, deadline=None)
@given(cases(EVERYTHING))
def test_random_networks_survive(case: RandomCase) -> None:
    assert same_network(network_from_json(network_to_json(case.network)), case.network)


@pytest.mark.parametrize("network", [rich(), random_case(Random(1), EVERYTHING).network], ids=["rich", "random"])
def test_the_schema_describes_it(network: Network) -> None:
    jsonschema.validate(network_to_json(network), SCHEMA)


def test_a_changed_bound_is_another_network() -> None:
    other = load_model(Source("rich.ta", RICH.replace("x <= 5", "x <= 6"))).network
    assert not same_network(rich(), other)


@pytest.mark.parametrize("change", [{"format": "x"}, {"version": 2}, {"processes": 3}, {"variables": [{}]}])
def test_other_json_is_rejected(change: dict[str, object]) -> None:
    with pytest.raises(UsageError):
        network_from_json({**network_to_json(rich()), **change})
    with pytest.raises(UsageError):
        network_from_json([])


def nested(depth: int) -> object:
    value: object = {"empty": [], "none": {}, "text": "\u00e9\n", "numbers": [1, 2.5, True, None], "pair": (1, {})}
    for number in range(depth):
        value = {"left": value, "right": number} if number % 2 else [number, value]
    return value


def test_the_text_is_that_of_json() -> None:
    value = nested(DEEPEST_INDENT - 2)
    assert "".join(json_pieces(value)) == json.dumps(value, indent=1)


def test_deeper_lines_are_indented_no_further() -> None:
    text = "".join(json_pieces(nested(DEEPEST_INDENT + 50)))
    assert json.loads(text) == json.loads(json.dumps(nested(DEEPEST_INDENT + 50)))
    assert max(len(line) - len(line.lstrip()) for line in text.splitlines()) == DEEPEST_INDENT


@pytest.mark.parametrize("kind", ["else if", "-"])
def test_the_text_of_a_chain_is_as_long_as_the_chain(kind: str) -> None:
    """Not the square of it: each link lies deeper than the one before."""

    def length(links: int) -> int:
        tests = [f"n == {link}" for link in range(1000, 1000 + links)]
        body = {
            "else if": " else ".join(f"if ({test}) {{ n = 0; }}" for test in tests),
            "-": f"n = 0 - {' - '.join(['n'] * links)};",
        }[kind]
        process = "process P() { init location A { to A { assign f(); } } }"
        model = f"int[0, 9999] n; void f() {{ {body} }} {process} system P;"
        return len(network_to_json_text(load_model(Source("chain.ta", model)).network))

    assert length(900) - length(600) == length(600) - length(300)
