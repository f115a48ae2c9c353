"""Leaving out what can only hinder: what is unreachable without it is unreachable."""

from __future__ import annotations

from pathlib import Path
from random import Random

import pytest

import tachk
from tachk import Answer
from tachk.base.span import Source
from tachk.engine import zone
from tachk.engine.compiler.lower import lower
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import Status
from tachk.formats.loading.load import load_model
from tachk.model.random_networks import Shape, random_case
from tachk.transform.blocking_processes import without_blocking
from tests.support.seeds import enough, seeds

MODEL = """
clock x; int n = 0; int passed = 0; int noise = 0; int read = 0;
broadcast chan tick, own; chan hand; urgent chan now;

process Main() {
    init location A {
        to A { guard x >= 1 && n < 3; sync tick!; assign x = 0, n = n + 1, passed = passed + 1; }
        to B { guard x >= 4; sync hand!; }
        to B { guard read == 1; }
    }
    location B;
}
process Partner() { init location Off { to Off { sync hand?; } } }
process Hinders() {
    clock y;
    init location Off { invariant y <= 3; to On { sync tick?; assign y = 0, passed = passed - 1; } }
    committed location On { to Off { sync own!; assign noise = 1; } }
}
process Hears() { init location Off { to On { guard noise == 1; sync own?; } } urgent location On { to Off; } }
process Reads() { init location Off { to Off { guard n == 2; assign noise = 2; } } }

system Main, Partner, Hinders, Hears, Reads;
"""


def written(text: str, folder: Path) -> tachk.Model:
    file = folder / "model.ta"
    file.write_text(text)
    return tachk.load(file)


def left_out(query: str, text: str = MODEL) -> list[str]:
    loaded = load_model(Source("model.ta", f"{text}\nproperty P : E<> {query};"))
    predicate = loaded.queries[0].predicate
    assert predicate is not None
    network = without_blocking(loaded.network, [predicate]).network
    pairs = zip(network.processes, loaded.network.processes, strict=True)
    return [process.name for process, before in pairs if before.edges and not process.edges]


@pytest.mark.parametrize(
    ("query", "names"),
    [
        ("n == 3", ["Hinders", "Hears", "Reads"]),
        ("Main.B", ["Hinders", "Hears", "Reads"]),
        ("passed == 3", ["Hears", "Reads"]),
        ("noise == 2", ["Hears"]),
        ("Hears.On", []),
        ("Reads.Off && n > 3", ["Hinders", "Hears"]),
        ("deadlock", []),
    ],
)
def test_what_makes_nothing_possible_is_left_out(query: str, names: list[str]) -> None:
    assert left_out(query) == names


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("to On { sync tick?;", "to On { sync tick?; assign read = 1;"),  # writes what Main reads
        ("sync own!;", "sync hand?;"),  # is a partner of Main
        ("clock y;", "clock y; chan priority hand < default;"),
        ("invariant y <= 3;", "invariant y <= 3 && x' == 0;"),  # stops a clock of Main
        ("init location Off { invariant y <= 3;", "init committed location Off { invariant y <= 3;"),
    ],
)
def test_what_might_make_something_possible_stays(before: str, after: str) -> None:
    text = MODEL.replace(before, after).replace("assign y = 0, passed = passed - 1", "assign y = 0")
    text = text.replace("sync tick?; assign read = 1; assign y = 0", "sync tick?; assign read = 1, y = 0")
    if "priority" in after:
        text = MODEL.replace("process Main", "chan priority hand < default;\nprocess Main")
    assert "Hinders" not in left_out("n == 3", text)


COMMITTED = """
int n; broadcast chan call;
process Stuck() { init committed location Here { to There { guard n == 1; } } location There; }
process Caller() { init location A { to A { sync call!; assign n = 1; } } }
process Listener() { init committed location A { to B { sync call?; } } location B; }
system Stuck, Caller, Listener;
"""


def test_a_committed_listener_makes_a_broadcast_possible(tmp_path: Path) -> None:
    assert left_out("Stuck.There", COMMITTED) == []
    (verdict,) = written(COMMITTED, tmp_path).verify("E<> Stuck.There")
    assert verdict.answer is Answer.HOLDS


def test_updates_that_nothing_needs_are_left_out_with_them() -> None:
    loaded = load_model(Source("model.ta", f"{MODEL}\nproperty P : E<> n == 3;"))
    predicate = loaded.queries[0].predicate
    assert predicate is not None
    main = without_blocking(loaded.network, [predicate]).network.processes[0]
    assert [update.span.text for update in main.edges[0].updates] == ["x = 0", "n = n + 1"]


@pytest.mark.parametrize(
    "query", ["A[] n <= 3", "A[] n <= 2", "E<> n == 4", "E<> n == 3", "A[] not Main.B", "E<> Main.B"]
)
def test_verdicts_are_those_of_the_whole_network(query: str, tmp_path: Path) -> None:
    model = written(MODEL, tmp_path)
    (quick,) = model.verify(query)
    (whole,) = model.verify(query, options=Options().off("unblocked", "sliced", "cone"))
    assert quick.answer is whole.answer
    assert (quick.trace is None) is (whole.trace is None)


def test_what_is_reachable_only_without_them_is_searched_for_in_the_whole_network(tmp_path: Path) -> None:
    # Time never passes 3, as Hinders hears nothing.
    model = written(MODEL.replace("n < 3", "n < 0"), tmp_path)
    (verdict,) = model.verify("A[] x < 4")
    assert verdict.answer is Answer.HOLDS


def test_unreachable_without_what_only_blocks_is_unreachable() -> None:
    shape = Shape(processes=2, clocks=1, locations=3, blockers=2, deadlocks=False)
    limits = Limits(states=20_000)
    smaller = settled = hindered = 0
    for seed in seeds(range(80)):
        case = random_case(Random(seed), shape)
        for predicate in case.predicates:
            relaxed = without_blocking(case.network, [predicate]).network
            if relaxed == case.network:
                continue
            smaller += 1
            without, whole = (
                zone.explore(*lower(network, [predicate]), Options(), limits).goals[0].status
                for network in (relaxed, case.network)
            )
            if without is Status.UNREACHABLE:
                assert whole is Status.UNREACHABLE, seed
                settled += 1
            else:
                hindered += whole is Status.UNREACHABLE
    assert enough(smaller > 80)
    assert enough(settled > 25)
    assert enough(hindered > 0)
