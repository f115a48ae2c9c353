"""Runs that are found along a run of a part of the network."""

from __future__ import annotations

import pytest

import tachk
from tachk.engine.compiler.lower import lower
from tachk.engine.exact.concretise import concretise
from tachk.engine.guided_search import explore_along
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import INTERRUPTED, GoalOutcome, Outcome, Statistics, Status
from tachk.engine.zone import explore
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import replay
from tachk.model.run import Transition
from tachk.transform.blocking_processes import without_blocking
from tachk.transform.guided import guided
from tachk.transform.monotone_counters import monotone_counters
from tachk.verify import along_path, over_approximations

MODEL = """
int[0, 2] used = 0; int[0, 9] n = 0;
broadcast chan tell[3]; chan hand;
process Main() {
    clock x;
    init location A {
        invariant x <= 4;
        to A { select i : int[1, 2], j : int[0, 2]; guard x >= 1 && n + i + j < 9 && used < 2; sync tell[j]!;
               assign n = n + i + j, used = used + 1, x = 0; }
        to B { guard n == 7; sync hand!; }
    }
    location B;
}
process Hearer() {
    int[0, 2] last = 0;
    init location H { to H { select j : int[0, 2]; sync tell[j]?; assign last = j; } to H { sync hand?; } }
}
process Other() {
    clock y;
    init urgent location O { to P { assign y = 0; } }
    location P { invariant y <= 3; to P { guard y >= 3 && used < 2; assign used = used + 1, y = 0; } LEAVES }
    location Q;
}
system Main, Hearer, Other;
property P : E<> Main.B && Hearer.last == 2;
"""


def along_the_part(text: str) -> tuple[Outcome, list[Transition], set[int], tachk.Model]:
    model = tachk.loads(text)
    target = model.loaded.queries[0].target
    assert target is not None
    reduced = without_blocking(model.network, [target]).network
    program, goals = lower(reduced, [target])
    path = explore(program, goals).goals[0].path
    assert path is not None
    members = {number for number, process in enumerate(reduced.processes) if process.edges}
    along = guided(model.network, path, members, monotone_counters(model.network, [target]))
    return explore_along(along, model.network, target, Options(), Limits()), list(path), members, model


def test_the_others_move_beside_the_path() -> None:
    outcome, path, members, model = along_the_part(MODEL.replace("LEAVES", "to Q { guard y >= 1; }"))
    (goal,) = outcome.goals
    assert members == {0, 1}
    assert goal.status is Status.REACHED and goal.path is not None
    moves = [[p for p in transition.participants if p.process in members] for transition in goal.path]
    assert [move for move in moves if move] == [list(transition.participants) for transition in path]
    assert any(participant.process == 2 for transition in goal.path for participant in transition.participants)
    prepared = prepare(model.network)
    run = concretise(prepared, goal.path, model.loaded.queries[0].target)
    assert run is not None
    replay(prepared, run, model.loaded.queries[0].target)


def test_a_path_that_the_others_do_not_allow_decides_nothing() -> None:
    outcome, _, _, model = along_the_part(MODEL.replace("LEAVES", "").replace("x >= 1", "x >= 2"))
    assert outcome.goals[0].status is Status.UNDECIDED
    assert next(iter(model.verify())).answer is tachk.Answer.FAILS


@pytest.mark.parametrize("leaves", ["to Q { guard y >= 1; }", ""])
def test_answers_are_those_of_the_whole(leaves: str, monkeypatch: pytest.MonkeyPatch) -> None:
    model = tachk.loads(MODEL.replace("LEAVES", leaves))
    (whole,) = model.verify(options=Options().off("unblocked", "sliced"))
    monkeypatch.setattr(over_approximations, "WORTH_CARRYING_OVER", 0)
    (carried,) = model.verify()
    assert (carried.answer, carried.trace is None) == (whole.answer, whole.trace is None)


def test_after_an_interruption_no_query_is_begun(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> Outcome:
        return Outcome((GoalOutcome(Status.UNDECIDED),), Statistics(), INTERRUPTED)

    monkeypatch.setattr(over_approximations, "WORTH_CARRYING_OVER", 0)
    monkeypatch.setattr(along_path, "explore_along", interrupted)
    queries = ("E<> Main.B && Hearer.last == 2", "E<> Main.B && Hearer.last == 1")
    verdicts = tachk.loads(MODEL.replace("LEAVES", "")).verify(*queries)
    assert [verdict.reason for verdict in verdicts] == [INTERRUPTED, INTERRUPTED]
