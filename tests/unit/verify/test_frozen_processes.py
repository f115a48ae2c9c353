"""Answers do not depend on processes outside the cone of influence, and runs show what these receive."""

from __future__ import annotations

from random import Random

import pytest

from tachk.base.span import Source
from tachk.base.words import QueryKind
from tachk.engine.options import Limits, Options
from tachk.formats.loading.load import load_model
from tachk.model.fault import RuntimeErrorKind
from tachk.model.query import Query
from tachk.model.random_networks import Shape, random_case
from tachk.verify.verdict import Answer, Verdict
from tachk.verify.verify import verify
from tests.support.seeds import seeds

MODEL = """
int n = 0;
broadcast chan tick;
process Main() { clock x; init location A { to A { guard x >= 1; sync tick!; assign x = 0, n = n + 1; } } }
process Listener() { int heard = 0; init location Off { to On { sync tick?; assign heard = n; } } location On; }
system Main, Listener;
property three : A[] n < 3;
property in_time : G[0,2] n < 2;
"""


def test_the_run_shows_what_a_frozen_process_receives() -> None:
    loaded = load_model(Source("model.ta", MODEL))
    for verdict in verify(loaded.network, loaded.queries):
        assert verdict.answer is Answer.FAILS
        assert verdict.trace is not None
        first = verdict.trace.steps[0]
        assert first.transition is not None
        assert [participant.process for participant in first.transition.participants] == [0, 1]
        assert first.state.discrete.locations == (0, 1)


def test_answers_and_runs_are_those_of_the_whole_network() -> None:
    limits = Limits(states=20_000)
    for seed in seeds(range(30)):
        case = random_case(Random(seed), Shape(processes=2, receivers=2, clocks=2, stopwatches=seed % 3 == 0))
        queries = [Query(f"q{i}", QueryKind.POSSIBLY, predicate) for i, predicate in enumerate(case.predicates)]
        with_all = verify(case.network, queries, Options().off("cone"), limits)
        without = verify(case.network, queries, Options(), limits)
        assert [v.answer for v in with_all] == [v.answer for v in without], seed
        assert [v.trace is None for v in with_all] == [v.trace is None for v in without], seed


OVERRUN = """
int[0,3] n = 0;
process Runs() { clock x; init location A { to A { guard x >= 1; assign n = n + 1, x = 0; } } }
process Main() { init location A { to B; } location B; }
system Runs, Main;
"""


def answers(text: str, *queries: str, trace: bool = True) -> list[Verdict]:
    properties = "\n".join(f"property q{number} : {query};" for number, query in enumerate(queries))
    loaded = load_model(Source("model.ta", f"{text}\n{properties}"))
    return list(verify(loaded.network, loaded.queries, trace=trace))


@pytest.mark.parametrize("query", ["E<> false", "A[] true", "A[] 1 < 2", "A[] not deadlock"])
def test_a_query_that_speaks_of_nothing_explores_everything(query: str) -> None:
    for verdict in answers(OVERRUN, "A[] not Main.B || Main.B", query)[1:]:
        assert verdict.answer is Answer.UNKNOWN
        assert verdict.fault is not None
        assert verdict.fault.kind is RuntimeErrorKind.RANGE


def test_what_was_not_inspected_is_named() -> None:
    holds, fails, shown = answers(OVERRUN, "A[] Main.A || Main.B", "E<> Main.A && Main.B", "E<> Main.B")
    assert (holds.answer, holds.unexamined) == (Answer.HOLDS, ("Runs",))
    assert (fails.answer, fails.unexamined) == (Answer.FAILS, ("Runs",))
    assert (shown.answer, shown.unexamined) == (Answer.HOLDS, ())
    (not_shown,) = answers(OVERRUN, "E<> Main.B", trace=False)
    assert not_shown.unexamined == ("Runs",)


def test_what_cannot_fail_or_was_inspected_is_not_named() -> None:
    guarded = OVERRUN.replace("x >= 1;", "x >= 1 && n < 3;")
    assert [v.unexamined for v in answers(guarded, "A[] Main.A || Main.B")] == [()]
    hindered = OVERRUN.replace("x >= 1;", "x >= 1 && n + 1 < 4;")  # nothing plain, but a search shows it
    assert [v.unexamined for v in answers(hindered, "A[] Main.A || Main.B")] == [("Runs",)]
    assert [v.unexamined for v in answers(hindered, "A[] Main.A || Main.B", "E<> false")] == [(), ()]


def test_updates_that_were_left_out_are_named() -> None:
    text = """
        int[0,3] n = 0; clock y;
        process Hinders() { init location A { invariant y <= 5; } }
        process Main() { init location A { to B { assign n = n + 1; } } location B { to A; } }
        system Hinders, Main;
    """
    (verdict,) = answers(text, "A[] Main.A || Main.B")
    assert (verdict.answer, verdict.unexamined) == (Answer.HOLDS, ("n",))


def test_a_frozen_process_that_goes_wrong_on_the_run_counts() -> None:
    text = """
        int[0,1] heard = 0; broadcast chan tick; int n = 0;
        process Main() {
            init location A { to A { guard n < 4; sync tick!; assign n++; } to B { guard n == 4; } }
            location B;
        }
        process Listener() { init location On { to On { sync tick?; assign heard++; } } }
        system Main, Listener;
    """
    (shown,) = answers(text, "E<> Main.B")
    assert shown.answer is Answer.UNKNOWN
    assert shown.fault is not None
    (not_shown,) = answers(text, "E<> Main.B", trace=False)
    assert (not_shown.answer, not_shown.unexamined) == (Answer.HOLDS, ("Listener",))
