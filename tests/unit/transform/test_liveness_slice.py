"""What neither hinders nor runs for ever by itself is left out of questions about runs, and nothing else is."""

from __future__ import annotations

import re
from pathlib import Path
from random import Random

import pytest

import tachk
from tachk import Answer
from tachk.engine.compiler.lower import lower_obligation
from tachk.engine.liveness import find_avoiding_run
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import LivenessStatus, Obligation
from tachk.model.network import Network
from tachk.transform.liveness_slice import liveness_preserving_slice
from tests.support import Shape, random_case
from tests.support.obligations import random_obligations
from tests.support.oracles.liveness_regions import check_by_regions
from tests.support.seeds import enough, seeds

MODEL = """
clock x; int n = 0; bool b = false; int[0, 3] count = 0;
broadcast chan tick; urgent broadcast chan now; clock shared;

process Main() {
    init location Wait { invariant x <= 5; to Done { guard x >= 2; sync tick!; assign x = 0, n = 1 - n; } }
    location Done { invariant x <= 4; to Wait { guard x >= 1; assign x = 0, b = !b; } }
}
process Other() {
    clock y;
    init location A { invariant y <= 3; to B { guard y >= 2; assign y = 0; } to C { sync tick?; assign y = 0; } }
    location B { to A { guard b; assign y = 0; } }
    committed location C {
        to A { guard n == 0; assign y = 0; }
        to A { guard n >= 1 || n <= -1; assign y = 0, count = (count + 1) % 3; }
    }
}
system Main, Other;
"""
QUERIES = ("Main.Wait --> Main.Done", "A<> Main.Done", "E[] Main.Wait")


def written(text: str, folder: Path) -> tachk.Model:
    file = folder / "model.ta"
    file.write_text(text)
    return tachk.load(file)


def left_out(network: Network, obligation: Obligation) -> list[str]:
    asked = [one for one in (obligation.goal, obligation.trigger) if one is not None]
    reduced = liveness_preserving_slice(network, asked).network
    pairs = zip(network.processes, reduced.processes, strict=True)
    return [process.name for process, part in pairs if process.edges and not part.edges]


def obligation_of(model: tachk.Model, query: str) -> Obligation:
    (verdict,) = model.verify(query, trace=False).record.verdicts
    assert verdict.query.avoided is not None
    return Obligation(verdict.query.avoided, verdict.query.begins)


def answers(model: tachk.Model, drop: bool) -> list[Answer]:
    return [
        verdict.answer
        for verdict in model.verify(
            *QUERIES, options=Options(without=frozenset() if drop else frozenset({"unblocked", "sliced"}))
        ).record.verdicts
    ]


def test_who_always_moves_in_time_is_left_out(tmp_path: Path) -> None:
    model = written(MODEL, tmp_path)
    assert left_out(model.network, obligation_of(model, QUERIES[0])) == ["Other"]
    assert left_out(model.network, obligation_of(model, "A<> Other.C")) == []
    assert answers(model, True) == answers(model, False) == [Answer.HOLDS, Answer.HOLDS, Answer.FAILS]
    small, whole = (
        model.verify(
            QUERIES[0], options=Options(without=frozenset() if drop else frozenset({"unblocked", "sliced"}))
        ).record.verdicts[0]
        for drop in (True, False)
    )
    assert small.statistics.states_stored < whole.statistics.states_stored


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("guard y >= 2;", "guard y >= 4;"),  # does not move before its invariant ends
        ("guard y >= 2;", "guard y >= 2 && b;"),  # not always
        ("guard y >= 2;", "guard y >= 2; sync now!;"),  # stops time
        ("location B {", "location B { to B;"),  # moves for ever while no time passes
        ("location B {", "location B { invariant y < 9;"),  # never gets to the end of its invariant
        ("location B {", "urgent location B {"),
        ("guard n == 0; assign y = 0;", "guard n == 0; assign y = 7;"),  # then `C` cannot be left
        ("guard n == 0; assign y", "guard n == 0; sync tick?; assign y"),  # waits for Main
        ("guard n >= 1 ||", "guard n >= 2 ||"),  # is caught where n == 1
        ("guard n == 0;", "guard n == 5;"),  # is caught where n == 0, between what guards name
        ("to C { sync tick?; assign y = 0; }", "to A { sync tick?; } to C { guard n > 7; } to D { sync tick?; }"),
        ("clock y;", "clock y; clock z;"),
    ],
)
def test_who_may_hinder_or_go_on_for_ever_stays(before: str, after: str, tmp_path: Path) -> None:
    assert before in MODEL
    text = MODEL.replace(before, after)
    if "to D" in after:  # a broadcast that is not possible where z is large
        text = text.replace("    committed", "    location D { invariant y <= 1; to A; }\n    committed")
    if "clock z" in after:  # another process sets it
        text = re.sub(r"\by\b", "shared", text.replace("clock y; clock z;", ""))
        text = text.replace("assign x = 0, b = !b;", "assign x = 0, b = !b, shared = 2;")
    model = written(text, tmp_path)
    assert left_out(model.network, obligation_of(model, QUERIES[0])) == []
    assert answers(model, True) == answers(model, False)


def test_what_is_kept_keeps_what_it_needs(tmp_path: Path) -> None:
    text = MODEL.replace("system Main, Other;", "process Third() { init location L { to L { guard count > 0; } } }")
    text += "process Fourth() { init location L { to M { sync tick?; } } location M; }"
    text += "system Main, Other, Third, Fourth;"
    model = written(text, tmp_path)
    assert left_out(model.network, obligation_of(model, QUERIES[0])) == ["Fourth"]
    assert answers(model, True) == answers(model, False)


def test_a_run_that_is_found_is_one_of_the_whole_network(tmp_path: Path) -> None:
    model = written(MODEL.replace("invariant x <= 5; ", ""), tmp_path)
    (verdict,) = model.verify(QUERIES[0]).record.verdicts
    assert verdict.answer is Answer.FAILS
    assert verdict.trace is not None


def test_errors_that_were_not_searched_for_are_named(tmp_path: Path) -> None:
    model = written(MODEL.replace("(count + 1) % 3", "count + 1"), tmp_path)
    (verdict,) = model.verify(QUERIES[0]).record.verdicts
    assert (verdict.answer, verdict.unexamined) == (Answer.HOLDS, ("n", "Other"))


SHAPE = Shape(processes=2, locations=3, clocks=2, constant=3, deadlocks=False, companions=2)


def test_answers_do_not_depend_on_it() -> None:
    found = set()
    for seed in seeds(range(120)):
        random = Random(seed)
        case = random_case(random, SHAPE)
        for obligation in random_obligations(random, case, 2):
            asked = [one for one in (obligation.goal, obligation.trigger) if one is not None]
            reduced = liveness_preserving_slice(case.network, asked).network
            if reduced == case.network:
                continue
            lowered = (lower_obligation(each, obligation.goal, obligation.trigger) for each in (case.network, reduced))
            statuses = {find_avoiding_run(*one, limits=Limits(states=20_000)).status for one in lowered}
            statuses.add(check_by_regions(case.network, obligation, Limits(states=300)).status)
            statuses.discard(LivenessStatus.UNDECIDED)
            assert len(statuses) <= 1, f"seed {seed}"
            found |= statuses
    assert enough(len(found) == 2)
