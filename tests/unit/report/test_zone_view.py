from __future__ import annotations

from pathlib import Path
from random import Random

import networkx
import pytest

import tachk
from tachk.meaning import dbm
from tachk.meaning.dbm import Zone
from tachk.model.random_networks import random_case
from tachk.report.run.zone_view import constraint_texts
from tests.support.seeds import seeds

FISCHER = Path(__file__).parents[3] / "models/classics/fischer.ta"

LAMP = """
int[0,2] n;
bool lit;
chan press;
process Lamp() {
    clock y;
    init location Off { to Low { sync press?; assign y = 0, lit = true; } }
    location Low { invariant y <= 5; to Off { guard y >= 5; assign lit = false; } }
}
process User() { clock z; init location Idle { to Idle { guard n < 2; sync press!; assign n = n + 1; } } }
system Lamp, User;
"""


def test_states_and_steps_are_readable() -> None:
    graph = tachk.loads(LAMP).zone_graph()
    assert isinstance(graph, networkx.DiGraph)
    (start,) = graph.graph["initial"]
    assert repr(start) == "<0: Lamp.Off, User.Idle; n = 0, lit = false; User.z == Lamp.y>"
    (low,) = graph.successors(start)
    assert low.at("Lamp") == "Low"
    assert dict(low.variables) == {"n": 1, "lit": True}
    assert low.constraints == ("Lamp.y <= 5", "Lamp.y <= User.z")
    step = "press! User: Idle → Idle, press? Lamp: Off → Low"
    assert graph.edges[start, low] == {"transitions": (step,), "label": step}
    assert graph.graph["reason"] == ""
    assert [state.number for state in graph] == list(range(len(graph)))


def test_fischer_has_the_known_graph() -> None:
    graph = tachk.load(FISCHER, N=2).zone_graph()
    assert len(graph) == 35
    assert networkx.number_strongly_connected_components(graph) == 10


def test_a_limit_is_reported() -> None:
    graph = tachk.load(FISCHER, N=2).zone_graph(limit=7)
    assert len(graph) == 7
    assert graph.graph["reason"] == "state limit"


def test_an_error_of_the_model_is_reported() -> None:
    text = "int[0,1] n; process P() { init location a { to a { assign n = n + 1; } } } system P;"
    graph = tachk.loads(text).zone_graph()
    assert len(graph) == 2
    assert graph.graph["reason"] == "run-time error"


@pytest.mark.parametrize("seed", seeds(range(12)))
def test_the_graph_has_what_the_engine_reaches(seed: int) -> None:
    network = random_case(Random(seed)).network
    model = tachk.Model(network)
    graph = model.zone_graph(limit=3000)
    assert graph.graph["reason"] in ("", "state limit")
    whole = not graph.graph["reason"]
    seen = {place for state in graph for place in state.locations}
    for process in network.processes:
        for location in process.locations:
            reached = model.verify(f"E<> {process.name}.{location.name}")[0].answer is tachk.Answer.HOLDS
            found = (process.name, location.name) in seen
            assert reached is found if whole else reached or not found


@pytest.mark.parametrize("seed", seeds(range(40)))
def test_few_constraints_say_the_whole_zone(seed: int) -> None:
    random = Random(seed)
    zone: Zone | None = dbm.up(dbm.point((0, 0, 0)))
    for _ in range(4):
        assert zone is not None
        i, j = random.sample(range(4), 2)
        tight = dbm.constrain(zone, (i, j, dbm.raw_bound(random.randint(0, 4), random.random() < 0.3)))
        zone = dbm.up(dbm.reset(tight or zone, random.randint(1, 3), random.randint(0, 2)))
    assert zone is not None
    texts = constraint_texts(zone, ("a", "b", "c"))
    rebuilt = dbm.universe(4)
    for text in texts:
        for constraint in parsed(text):
            narrowed = dbm.constrain(rebuilt, constraint)
            assert narrowed is not None
            rebuilt = narrowed
    assert rebuilt == zone
    assert len(texts) <= 3 + sum(1 for _ in zone.constraints())


def parsed(text: str) -> list[dbm.Constraint]:
    """``a - b <= 3``, ``a == b + 1``, ``a >= 2`` as bounds."""
    number = {"a": 1, "b": 2, "c": 3}
    left, sign, right = next(text.partition(f" {s} ") for s in ("==", "<=", ">=", "<", ">") if f" {s} " in text)
    first, _, second = left.partition(" - ")
    words = right.split()
    value = 0
    if words[0] in number:
        second = words[0]
        value = int(words[1] + words[2]) if len(words) == 3 else 0
    else:
        value = int(words[0])
    i, j = number[first], number.get(second, 0)
    match sign.strip():
        case "==":
            return [(i, j, dbm.raw_bound(value, False)), (j, i, dbm.raw_bound(-value, False))]
        case "<=" | "<" as strict:
            return [(i, j, dbm.raw_bound(value, strict == "<"))]
        case strict:
            return [(j, i, dbm.raw_bound(-value, strict == ">"))]
