"""A limit that is met, an interruption and a full machine give `unknown`, never an answer."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace

import pytest

from tachk.base.job import Job, under_way
from tachk.base.span import Source
from tachk.engine import zone
from tachk.engine.compiler.lower import lower
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import Status
from tachk.formats.loading.load import load_model

Answers = Callable[..., dict[str, str]]


def test_a_limit_met_without_what_only_blocks_is_no_answer(answers: Answers) -> None:
    text = """
    int[0,9] n = 0; int[0,1] m = 0;
    process Main() { init location A { to A { guard n < 9; assign n = n + 1; } } }
    process Hinders() { urgent location U { to V; } init location V { to U { guard n == 3; } } }
    system Main, Hinders;
    property P : A[] n < 9;
    """
    assert answers(text, options=Options().off("pruning"), limits=Limits(states=3)) == {"P": "unknown"}
    assert answers(text) == {"P": "fails"}


def test_the_first_search_keeps_the_limit_on_states(answers: Answers) -> None:
    text = """
    int[0,9] n = 0;
    process Main() { init location A { to A { guard n < 8; assign n = n + 1; } } }
    process Hinders() { urgent location U { to V; } init location V { to U { guard n == 3; } } }
    system Main, Hinders;
    property P : A[] n < 9;
    """
    assert answers(text, options=Options().off("pruning"), limits=Limits(states=3)) == {"P": "unknown"}
    assert answers(text) == {"P": "holds"}


def test_a_time_limit_gives_unknown(answers: Answers) -> None:
    text = """
    int[0,1000] n = 0;
    process Main() { init location A { to A { guard n < 1000; assign n = n + 1; } } }
    system Main;
    property P : A[] n < 1000;
    """
    assert answers(text, limits=Limits(seconds=0.0)) == {"P": "unknown"}
    model = load_model(Source("model.ta", text.replace("A[] n < 1000", "E<> n > 1000")))
    (goal,) = [query.predicate for query in model.queries]
    assert goal is not None
    program, goals = lower(model.network, [goal])
    with under_way(Job(ends=0.0)):
        outcome = zone.explore(program, goals)
    assert outcome.goals[0].status is Status.UNDECIDED
    assert outcome.reason == "time limit"


def test_an_interrupted_search_leaves_a_doubtful_deadlock_open(answers: Answers) -> None:
    text = """
    clock x, y; int[0,2000] n = 0;
    process P() {
        init location I { to A { assign x = 0, y = 0; } to K; }
        location A { invariant x <= 2; to B { guard y <= 3; } }
        location B { to B; }
        location K { to K { guard n < 2000; assign n = n + 1; } }
    }
    system P;
    property D : E<> deadlock && P.A;
    property N : E<> deadlock && P.K;
    """

    def interrupt(*_):
        raise KeyboardInterrupt

    assert answers(text) == {"D": "fails", "N": "holds"}
    assert answers(text, progress=interrupt) == {"D": "unknown", "N": "unknown"}


def test_a_machine_out_of_memory_gives_no_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> int:
        raise MemoryError

    explorer = SimpleNamespace(
        run=full,
        reached=lambda _: None,
        failure=lambda _: None,
        statistics=lambda: (0, 0, 0, 0),
        effort=lambda: 0,
    )
    monkeypatch.setattr(zone, "_explorer", lambda *_: explorer)
    text = "process P() { init location A; } system P; property Q : A[] P.A;"
    loaded = load_model(Source("model.ta", text))
    (goal,) = [query.predicate for query in loaded.queries]
    assert goal is not None
    outcome = zone.explore(*lower(loaded.network, [goal]))
    assert outcome.goals[0].status is Status.UNDECIDED


def test_a_limit_on_depth_counts_transitions(answers: Answers) -> None:
    text = """
    int[0,9] n = 0;
    process Main() { init location A { to A { guard n < 9; assign n = n + 1; } } }
    system Main;
    property P : E<> n == 3;
    """
    assert answers(text, limits=Limits(depth=3)) == {"P": "holds"}
    assert answers(text, limits=Limits(depth=2)) == {"P": "unknown"}
