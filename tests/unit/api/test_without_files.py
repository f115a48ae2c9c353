"""Models from texts and from Python, without a file."""

from __future__ import annotations

import pickle
from pathlib import Path

import pytest

import tachk
from tachk.model.builder import NetworkBuilder
from tachk.model.network import Network
from tests.support.seeds import seeds

MODELS = Path(__file__).parents[3] / "models"

COFFEE = """
const int BREW = 3;
process Machine() {
    clock x;
    init location Idle { to Brewing { assign x = 0; } }
    location Brewing { invariant x <= BREW; to Idle { guard x >= BREW; } }
}
system Machine;
property served : E<> Machine.Brewing;
"""


def stopping() -> Network:
    network = NetworkBuilder()
    n = network.integer("n", -2, 3, -1)
    go = network.channel("go", urgent=True, size=2)
    p, q = network.process("P"), network.process("Q")
    x = p.clock("x")
    a = p.location("a", invariant=x <= 4, rates=[(x, 0)])
    b = p.location("b", committed=True)
    p.edge(a, b, guard=n < 2, send=go[1], updates=[x.assign(0), n.assign(n + 1)])
    p.edge(b, a)
    c = q.location("c")
    q.edge(c, c, receive=go[1])
    return network.build()


def test_a_text_is_a_model() -> None:
    model = tachk.loads(COFFEE, BREW=5)
    assert model.constants == {"BREW": 5}
    assert model.verify().met
    with pytest.raises(tachk.InputError, match="<text>:1"):
        tachk.loads("process P( {")


def test_a_network_from_python_is_a_model() -> None:
    model = tachk.Model(stopping(), "stopping")
    report = model.verify("E<> P.b && n == 2", "A[] P.x <= 4", "A[] n <= 1", "G (P.b -> n >= 0)")
    assert [verdict.answer.value for verdict in report] == ["holds", "holds", "fails", "holds"]
    assert str(report).startswith("stopping\n")
    assert "<svg" in tachk.draw(model).svg
    again = tachk.loads(tachk.export(model, "xta"))
    assert tachk.diff(model, again) == ""
    assert again.verify("A[] n <= 1")[0].answer is tachk.Answer.FAILS


def test_what_the_language_cannot_say_can_still_be_checked() -> None:
    network = NetworkBuilder()
    p, q = network.process("P"), network.process("Q")
    a, b = p.location("a"), p.location("b")
    c = q.location("c")
    p.edge(a, b)
    q.edge(c, c, guard=b.reached)
    model = tachk.Model(network.build())
    assert model.verify("E<> P.b").met
    with pytest.raises(tachk.UsageError) as caught:
        tachk.draw(model)
    assert caught.value.help == "it has a test of a location in the behaviour"


@pytest.mark.parametrize("seed", seeds(range(8)))
def test_random_networks_are_the_same_in_python_and_written(seed: int) -> None:
    model = tachk.random_network(seed)
    again = tachk.loads(tachk.export(model, "xta"))
    assert tachk.diff(model, again) == ""
    last = " && ".join(f"{process.name}.{process.locations[-1].name}" for process in model.network.processes)
    assert model.verify(f"E<> {last}")[0].answer is again.verify(f"E<> {last}")[0].answer
    assert repr(tachk.random_network(seed).network.processes) == repr(model.network.processes)


def test_models_differ_by_what_they_do() -> None:
    slower = tachk.loads(COFFEE.replace("x <= BREW", "x <= BREW + 1"))
    assert "Brewing" in tachk.diff(tachk.loads(COFFEE), slower)


def test_formats_are_named() -> None:
    model = tachk.loads(COFFEE)
    assert tachk.export(model, "dot").startswith("digraph")
    with pytest.raises(tachk.UsageError, match="no format 'pdf'"):
        tachk.export(model, "pdf")


def test_models_reports_and_verdicts_are_pickled() -> None:
    model = tachk.load(MODELS / "classics/fischer.ta", N=2)
    copied = pickle.loads(pickle.dumps(model))
    report = copied.verify()
    assert [verdict.answer for verdict in report] == [verdict.answer for verdict in model.verify()]
    again = pickle.loads(pickle.dumps(report))
    assert again.to_text() == report.to_text()
    verdict = pickle.loads(pickle.dumps(report["patience"]))
    assert verdict.trace == report["patience"].trace


def test_the_run_of_a_report_is_replayed() -> None:
    model = tachk.load("models/classics/fischer.ta", N=2, WAIT=9)
    run = model.verify().run("mutual_exclusion")
    assert run is not None
    replayed = tachk.replay(model, run)
    assert replayed and replayed.trace == run.trace
    assert not tachk.load("models/classics/fischer.ta", N=2).replay(run)
    with pytest.raises(tachk.UsageError, match="a run of a report"):
        tachk.replay(model, model.simulate(runs=1)[0])  # type: ignore[arg-type]


@pytest.mark.parametrize(("start", "end", "named"), [("Machine.Gone", "Machine.Idle", "start"), (None, "Gone!", "end")])
def test_a_wrong_event_is_named_by_its_argument(start: str | None, end: str, named: str) -> None:
    with pytest.raises(tachk.InputError) as caught:
        tachk.loads(COFFEE).time(start, end)
    assert caught.value.diagnostics[0].span.source.name == named
