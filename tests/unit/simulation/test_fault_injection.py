"""Faults to order: what is ordered happens, as often as ordered, and every run stays one of the model."""

from __future__ import annotations

from collections import Counter
from math import sqrt

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.engine.simulation.policy import Policy
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, RecordedChanges, Simulated, SimulationOptions
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import replay
from tachk.model.network import Network
from tachk.simulation.fault_injection import parse_fault, read_plan, with_faults
from tachk.simulation.runs import Runs
from tests.support.simulated.timed import WITH_STATES, state_columns, timed_trace

LINK = """
const int LOSSES = 1000;
broadcast chan send[2][3];
int[0, LOSSES] lost[2];
int[0, 10000] kept[2];
process Sender() {
    clock x;
    init location S {
        invariant x <= 1;
        to S { select l : int[0, 1], k : int[0, 2]; guard x == 1; sync send[l][k]!; assign x = 0; }
    }
}
process Link(const int[0, 1] link) {
    init location Open {
        /// on its way
        to Open { select k : int[0, 2]; sync send[link][k]?; assign kept[link] = kept[link] + 1; }
        /// ! is lost
        to Open {
            select k : int[0, 2];
            guard lost[link] < LOSSES;
            sync send[link][k]?;
            assign lost[link] = lost[link] + 1;
        }
        /// ! is lost, and so is all that follows
        to Broken { select k : int[0, 2]; sync send[link][k]?; }
        /// ! is late
        to Late { select k : int[0, 2]; sync send[link][k]?; }
    }
    location Late { invariant true; to Open; }
    location Broken;
}
process Sleeper() {
    clock y;
    init location Awake {
        /// ! falls asleep
        to Asleep { guard y == 5; }
        /// ! falls asleep
        to Asleep { guard y == 3; }
    }
    location Asleep;
}
system Sender, Link, Sleeper;
"""


def _runs(
    network: Network, faults: list[str], count: int, until: int, policy: Policy = Policy.STOCHASTIC
) -> list[Simulated]:
    wanted = with_faults(network, read_plan(faults))
    runs = Runs(wanted.network, state_columns(network), [*wanted.done.values(), *wanted.missed.values()])
    return list(runs.draw(SimulationOptions(3, until * TICKS_PER_UNIT, policy), range(count), WITH_STATES))


def _taken(network: Network, runs: list[Simulated]) -> Counter[str]:
    """How often links did what, by the documentation of their edges."""
    edges = network.processes[1].edges
    links = {1, 2}
    return Counter(
        edges[participant.edge].doc
        for run in runs
        for action in run.actions
        for participant in action.participants
        if participant.process in links and edges[participant.edge].synchronisation is not None
    )


def _agrees(count: int, total: int, probability: float) -> bool:
    return abs(count - total * probability) <= 4.5 * sqrt(total * probability * (1 - probability))


def test_faults_happen_as_often_as_ordered() -> None:
    network = tachk.loads(LINK).network
    found = _taken(network, _runs(network, ["lost=0.2", "late=0.05"], 4, 1000))
    total = found.total()
    assert total > 3500
    assert _agrees(found["! is lost"], total, 0.2)
    assert _agrees(found["! is late"], total, 0.05)
    assert found["! is lost, and so is all that follows"] == 0  # nobody has ordered it
    assert _agrees(found["on its way"], total, 0.75)


def test_without_an_order_each_edge_is_as_likely() -> None:
    network = tachk.loads(LINK.replace("/// ! is lost, and", "/// is lost, and").replace("Broken {", "Open {")).network
    found = _taken(network, _runs(network, [], 3, 1000))
    assert all(_agrees(count, found.total(), 0.25) for count in found.values())


def test_ordered_messages_are_lost_and_no_others() -> None:
    network = tachk.loads(LINK).network
    faults = ["lost=send[1][2]:2,4..5", "lost=send[0][0]:1"]
    for run in _runs(network, faults, 5, 100):
        counts: Counter[tuple[int, int]] = Counter()
        lost = []
        for action in run.actions:
            sender, *receivers = action.participants
            if sender.process != 0:
                continue
            (receiver,) = receivers
            counts[sender.selects[0], sender.selects[1]] += 1
            doc = network.processes[receiver.process].edges[receiver.edge].doc
            if doc == "! is lost":
                lost.append((*sender.selects, counts[sender.selects[0], sender.selects[1]]))
            else:
                assert doc == "on its way"
        assert sorted(lost) == [(0, 0, 1), (1, 2, 2), (1, 2, 4), (1, 2, 5)]
        assert run.observed[-1, -4:].tolist() == [3, 1, 0, 0]


def test_what_the_model_does_not_allow_is_counted() -> None:
    network = tachk.loads(LINK.replace("LOSSES = 1000", "LOSSES = 1")).network
    (run,) = _runs(network, ["lost=send[0][0]:1..3"], 1, 200)
    assert run.observed[-1, -2:].tolist() == [1, 2]


@pytest.mark.parametrize("policy", Policy)
def test_runs_with_orders_are_runs_of_the_model(policy: Policy) -> None:
    network = tachk.loads(LINK).network
    model = prepare(network)
    for run in _runs(network, ["lost=0.3", "lost=send[1][2]:1..2", "falls asleep=now"], 2, 20, policy):
        trace = timed_trace(network, run)
        slots = len(model.layout.types)
        assert all(len(state.discrete.values) >= slots for state in trace.states)
        replay(model, timed_trace(network, run, slots))


def test_a_fault_that_is_ordered_now_happens_at_its_first_moment() -> None:
    network = tachk.loads(LINK).network
    for run in _runs(network, ["falls asleep=now"], 3, 20):
        times = [t for t, a in zip(run.times[1:].tolist(), run.actions, strict=True) if a.participants[0].process == 3]
        assert times == [3 * TICKS_PER_UNIT]


@pytest.mark.parametrize(
    "written",
    [
        "lost",
        "lost=",
        "=1",
        "lost=2",
        "lost=often",
        "lost=send[0][0]:0",
        "lost=send[0][0]:x",
        "lost=post[0]:1",
        "melts=0.5",
    ],
)
def test_wrong_orders_are_rejected(written: str) -> None:
    network = tachk.loads(LINK).network
    with pytest.raises(UsageError, match="fault `"):
        with_faults(network, [parse_fault(written)])


def test_the_packets_of_the_five_automata_are_lost_as_ordered() -> None:
    network = tachk.load("models/micro_xrce_dds/client_3_0.ta", LOSSES=5).network
    wanted = with_faults(network, read_plan(["lost=send[PUB_UP][DATA]:2,4"]))
    runs = Runs(wanted.network, (), [*wanted.done.values(), *wanted.missed.values()])
    drawing = SimulationOptions(1, 20_000 * TICKS_PER_UNIT)
    for run in runs.draw(drawing, range(3), RecordedChanges(actions=True, observed=True)):
        assert runs.counts(run) == [2, 0]
        news = [
            network.processes[p.process].edges[p.edge].doc
            for action in run.actions
            for p in action.participants
            if network.processes[p.process].template == "InstantLink"
        ]
        assert news.count("! is lost") == 2


OWN_LINK = """
const int LOSSES = 1000;
chan request; broadcast chan deliver;
int[0, 10000] sent, delivered, lost, late;
process Sender() {
    clock x;
    init location S { invariant x <= 10; to S { guard x == 10; sync request!; assign x = 0, sent = sent + 1; } }
}
process Link() {
    clock y;
    init location Empty { to Full { sync request?; assign y = 0; } }
    location Full {
        invariant y <= 5;
        /// delivered
        to Empty { guard y >= 1; sync deliver!; assign delivered = delivered + 1; }
        /// ! lost
        to Empty { guard lost < LOSSES; assign lost = lost + 1; }
        /// ! late
        to Empty { guard y >= 4; assign late = late + 1; }
        /// ! never ordered
        to Stuck;
    }
    location Stuck;
}
system Sender, Link;
"""
"""A link that holds a message: the fault is an edge of its own, beside one that synchronises."""


def _counted(network: Network, faults: list[str], until: int) -> dict[str, int]:
    (run,) = _runs(network, faults, 1, until)
    edges = network.processes[1].edges
    taken = Counter(edges[p.edge].doc for action in run.actions for p in action.participants if p.process == 1)
    return {doc.removeprefix("! "): count for doc, count in taken.items() if doc}


def test_a_message_that_a_link_holds_is_lost_as_often_as_ordered() -> None:
    found = _counted(tachk.loads(OWN_LINK).network, ["lost=0.2", "late=0.05"], 40_000)
    total = sum(found.values())
    assert total > 3900 and set(found) == {"delivered", "lost", "late"}
    assert _agrees(found["lost"], total, 0.2) and _agrees(found["late"], total, 0.05)


def test_the_messages_of_a_list_are_lost_in_a_link_that_holds_them() -> None:
    network = tachk.loads(OWN_LINK).network
    (run,) = _runs(network, ["lost=request:2,5..7"], 1, 200)
    edges = network.processes[1].edges
    docs = [edges[p.edge].doc for action in run.actions for p in action.participants if p.process == 1]
    kept = [doc for doc in docs if doc]
    assert kept == ["delivered", "! lost", *["delivered"] * 2, *["! lost"] * 3, *["delivered"] * (len(kept) - 7)]
    assert run.observed[-1, -2:].tolist() == [4, 0]


def test_a_held_message_that_the_model_does_not_allow_to_be_lost_is_delivered() -> None:
    network = tachk.loads(OWN_LINK.replace("LOSSES = 1000", "LOSSES = 2")).network
    (run,) = _runs(network, ["lost=request:1..5"], 1, 200)
    assert run.observed[-1, -2:].tolist() == [2, 3]
    assert _counted(network, ["lost=request:1..5"], 200) == {"lost": 2, "delivered": 17}


@pytest.mark.parametrize("policy", Policy)
def test_runs_of_an_own_link_with_faults_are_runs_of_the_model(policy: Policy) -> None:
    network = tachk.loads(OWN_LINK).network
    model = prepare(network)
    for run in _runs(network, ["lost=0.3", "late=request:1..2"], 3, 100, policy):
        replay(model, timed_trace(network, run, len(model.layout.types)))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("/// ! lost\n", "/// ! gone\n"), r"no edge is documented as `lost` .*documents: gone; late; never ordered"),
        (("guard lost < LOSSES;", "guard lost < LOSSES; sync request!;"), "its edge in Link.Full waits for a partner"),
    ],
)
def test_what_a_link_lacks_is_named(change: tuple[str, str], said: str) -> None:
    with pytest.raises(UsageError, match=f"fault `lost=0.5`: .*{said}"):
        with_faults(tachk.loads(OWN_LINK.replace(*change)).network, [parse_fault("lost=0.5")])


def test_a_wrong_name_of_a_fault_or_channel_gets_advice() -> None:
    network = tachk.loads(OWN_LINK).network
    with pytest.raises(UsageError, match=r"no channel requests \(did you mean `request`"):
        with_faults(network, [parse_fault("lost=requests:1")])
    bare = tachk.loads("process P() { init location a { to a; } } system P;").network
    with pytest.raises(UsageError, match=r"write `/// ! drop` on a line of its own above the edge"):
        with_faults(bare, [parse_fault("drop=0.5")])


@pytest.mark.parametrize(
    ("locations", "said"),
    [
        ("init location A { to B; } location B {\n/// ! breaks\nto A; }", "there is no other edge in P.B"),
        (
            "location A; init location B {\n/// ! breaks\nto A;\nto A { guard x > 1; sync c!; } }",
            "no edge leads to P.B",
        ),
    ],
)
def test_a_fault_that_nothing_decides_is_explained(locations: str, said: str) -> None:
    network = tachk.loads(f"broadcast chan c; process P() {{ clock x; {locations} }} system P;").network
    with pytest.raises(UsageError, match=said):
        with_faults(network, [parse_fault("breaks=0.5")])
