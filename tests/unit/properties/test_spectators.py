"""Answers do not depend on spectators, and runs tell what they heard."""

from __future__ import annotations

from random import Random

from tachk.diagnostics.span import Source
from tachk.engines.protocol import Limits, Options
from tachk.frontend.load import load_model
from tachk.model.query import Query, QueryKind
from tachk.properties.verdict import Answer
from tachk.properties.verify import verify
from tachk.testing.networks import Shape, random_case

MODEL = """
int n = 0;
broadcast chan tick;
process Main() { clock x; init location A { to A { guard x >= 1; sync tick!; assign x = 0, n = n + 1; } } }
process Listener() { int heard = 0; init location Off { to On { sync tick?; assign heard = n; } } location On; }
system Main, Listener;
property three : A[] n < 3;
property in_time : G[0,2] n < 2;
"""


def test_the_run_shows_what_a_spectator_heard() -> None:
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
    for seed in range(30):
        case = random_case(Random(seed), Shape(processes=2, spectators=2, clocks=2, stopwatches=seed % 3 == 0))
        queries = [Query(f"q{i}", QueryKind.POSSIBLY, predicate) for i, predicate in enumerate(case.predicates)]
        with_all = verify(case.network, queries, Options(spectators=True), limits)
        without = verify(case.network, queries, Options(), limits)
        assert [v.answer for v in with_all] == [v.answer for v in without], seed
        assert [v.trace is None for v in with_all] == [v.trace is None for v in without], seed
