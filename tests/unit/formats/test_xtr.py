"""Traces and models in UPPAAL's own formats, read back as the tracer of its parsing library reads them.

`Tracer` follows src/tracer.cpp of that library (Uppsala and Aalborg University): what it takes from each line, and how.
"""

from __future__ import annotations

import re
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from xml.etree import ElementTree

import pytest

from tachk.api import model as api
from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.span import Source
from tachk.base.words import QueryKind
from tachk.engine.options import Limits
from tachk.formats.loading.load import load_model
from tachk.formats.uppaal.intermediate import network_to_intermediate
from tachk.formats.uppaal.trace_xml import run_to_trace_xml
from tachk.formats.uppaal.xtr import run_to_xtr
from tachk.meaning.dbm import contains
from tachk.meaning.zones_of_run import zones_of_run
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.random_networks import Shape, random_case
from tachk.model.run import TimedTrace
from tachk.verify.verify import verify
from tests.support.seeds import seeds

MODEL = """\
const int N = 2;
typedef int[0, N - 1] id_t;
clock z;
int[0, 9] n = 3;
meta int m;
broadcast chan go[N];
process P(const id_t me) {
    clock x;
    location A { invariant x <= 5; }
    init location S { to A { select v : id_t; sync go[v]!; assign x = 0, n = n + v; } }
    location B;
}
process Q() {
    init location W { to V { guard z >= 2; } }
    urgent location V { to U { sync go[1]?; } }
    location U;
}
system P, Q;
property p : E<> Q.U && P(0).A && z < 3;
"""
LAYOUT = (
    r"\d+:(?:clock:\d+:\S+|const:-?\d+|(?:var|meta):-?\d+:-?\d+:-?\d+:\d+:\S+|"
    r"location:(?:|committed|urgent):\S+)"
)


@dataclass
class Tracer:
    """What the tracer knows after it has read a model."""

    clocks: list[str] = field(default_factory=list)
    variables: list[str] = field(default_factory=list)
    slots: list[str] = field(default_factory=list)
    processes: list[tuple[str, list[int], list[int]]] = field(default_factory=list)
    edges: list[list[int]] = field(default_factory=list)
    expressions: dict[int, str] = field(default_factory=dict)

    def layout(self, line: str) -> None:
        assert re.fullmatch(LAYOUT, line), line
        number, kind, *_, name = line.split(":")
        assert int(number) == len(self.slots)
        self.slots.append(name)
        if kind == "clock":
            self.clocks.append(name)
        if kind in ("var", "meta"):
            self.variables.append(name)

    def take_process(self, line: str) -> None:
        number, _, name = line.split(":")
        assert int(number) == len(self.processes)
        self.processes.append((name, [], []))

    def locations(self, line: str) -> None:
        slot, process, _ = map(int, line.split(":"))
        self.processes[process][1].append(slot)

    def take_edge(self, line: str) -> None:
        edge = [int(part) for part in line.split(":")]
        assert len(edge) == 6
        self.processes[edge[0]][2].append(len(self.edges))
        self.edges.append(edge)

    def take_expression(self, line: str) -> None:
        number, _, _, text = line.split(":", 3)
        self.expressions[int(number)] = text.strip()

    def trace(self, text: str) -> list[str]:
        words = text.split()
        told = [self.state(words)]
        while words[0] != ".":
            after = self.state(words)
            told += [self.transition(words), after]
        assert words == ["."]
        return told

    def state(self, words: list[str]) -> str:
        places = [words.pop(0) for _ in self.processes]
        assert words.pop(0) == "."
        bounds = []
        while words[0] != ".":
            i, j, raw = (int(words.pop(0)) for _ in range(3))
            assert words.pop(0) == "."
            bounds.append(f"{self.clocks[i]}-{self.clocks[j]}{'<' if raw & 1 else '<='}{raw >> 1}")
        words.pop(0)
        values = [f"{name}={int(words.pop(0))}" for name in self.variables]
        assert words.pop(0) == "."
        here = [f"{name}.{self.slots[own[int(at)]]}" for at, (name, own, _) in zip(places, self.processes, strict=True)]
        return " ".join((*here, *values, *bounds))

    def transition(self, words: list[str]) -> str:
        told = []
        while words[0] != ".":
            numbers = []
            while words[0] != ";":
                numbers.append(int(words.pop(0)))
            words.pop(0)
            process, edge, *selects = numbers
            name, _, own = self.processes[process]
            _, source, target, *labels = self.edges[own[edge]]
            chosen = f" {selects}" if selects else ""
            texts = "; ".join(self.expressions[label] for label in labels)
            told.append(f"{name}.{self.slots[source]} -> {name}.{self.slots[target]}{chosen} {{{texts}}}")
        words.pop(0)
        return ", ".join(told)


def read_model(network: Network) -> Tracer:
    tracer = Tracer()
    text = network_to_intermediate(network)
    for section in text.rstrip("\n").split("\n\n"):
        title, *lines = section.split("\n")
        reader = {
            "layout": tracer.layout,
            "instructions": lambda line: None,
            "processes": tracer.take_process,
            "locations": tracer.locations,
            "edges": tracer.take_edge,
            "expressions": tracer.take_expression,
        }[title]
        for line in lines:
            reader(line)
    return tracer


def witness(text: str = MODEL) -> tuple[Network, TimedTrace]:
    model = api.Model(load_model(Source("m.ta", text)), "m.ta")
    run = model.verify()[0].trace
    assert run is not None
    return model.network, run


def test_the_trace_as_the_tracer_prints_it() -> None:
    network, run = witness()
    told = read_model(network).trace(run_to_xtr(network, run))
    assert told[0].startswith("P(0).S P(1).S Q.W n=3 m=0 t(0)-z<=0 t(0)-P(0).x<=0 ")
    assert "P(0).S -> P(0).A [1] {1; go[v]!; x = 0, n = n + v}" in " ".join(told)
    assert "Q.V -> Q.U {1; go[1]?; 1}" in " ".join(told)
    assert "Q.W -> Q.V {z >= 2; tau; 1}" in " ".join(told)
    assert len(told) == 2 * sum(step.transition is not None for step in run.steps) + 1


def test_strict_bounds_are_odd() -> None:
    text = (
        "process P() { clock x; init location A { to B { guard x > 1; } } location B; } system P; property p : E<> P.B;"
    )
    network, run = witness(text)
    assert run_to_xtr(network, run).split("\n") == [
        *("0", ".", "0 1 0", ".", ".", "", "."),
        *("1", ".", "0 1 -1", ".", ".", "", "."),
        *("0 0 ; .", ".", ""),
    ]
    assert "t(0)-P.x<-1" in read_model(network).trace(run_to_xtr(network, run))[2]


@pytest.mark.parametrize("name", ["train_gate", "bridge", "fischer", "csma_cd", "fddi"])
def test_shipped_models(name: str) -> None:
    model = api.load(Path(__file__).parents[3] / "models" / "classics" / f"{name}.ta")
    tracer = read_model(model.network)
    runs = [verdict.trace for verdict in model.verify() if verdict.trace is not None]
    assert runs
    for run in runs:
        told = tracer.trace(run_to_xtr(model.network, run))
        assert len(told) % 2 == 1
        assert ElementTree.fromstring(run_to_trace_xml(model.network, run)).tag == "trace"


def test_the_xml_form_names_everything_it_refers_to() -> None:
    network, run = witness()
    root = ElementTree.fromstring(run_to_trace_xml(network, run))
    identifiers = {element.get("id") for element in root.iter() if element.get("id")}
    for element in root.iter():
        for attribute in (
            "from",
            "to",
            "clock1",
            "clock2",
            "variable",
            "location_vector",
            "dbm_instance",
            "initial_node",
        ):
            assert element.get(attribute) is None or element.get(attribute) in identifiers
        for several in ("edges", "locations"):
            assert set((element.get(several) or "").split()) <= identifiers
    assert len(root.findall("node")) == len(root.findall("transition")) + 1


@pytest.mark.parametrize("seed", seeds(range(60)))
def test_runs_of_random_networks(seed: int) -> None:
    shape = Shape(
        diagonals=seed % 2 == 0,
        priorities=seed % 3 == 0,
        stopwatches=seed % 4 == 0,
        clocks_on_urgent=True,
        clocks_on_broadcast=True,
        lower_invariants=True,
    )
    case = random_case(Random(seed), shape)
    queries = [Query(f"q{i}", QueryKind.POSSIBLY, predicate) for i, predicate in enumerate(case.predicates)]
    with suppress(InputError):
        for verdict in verify(case.network, queries, limits=Limits(states=2000)):
            if verdict.trace is not None:
                told = read_model(case.network).trace(run_to_xtr(case.network, verdict.trace))
                assert len(told) == 2 * sum(step.transition is not None for step in verdict.trace.steps) + 1
                zones = zones_of_run(case.network, verdict.trace)
                arrivals = [verdict.trace.initial, *(s.state for s in verdict.trace.steps if s.transition is not None)]
                assert all(contains(zone, state.clocks) for zone, state in zip(zones, arrivals, strict=True))
