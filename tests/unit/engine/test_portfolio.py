"""The portfolio beside the ordinary search: what it finds, when it is tried, and that it changes no verdict."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest

import tachk
from tachk import _core
from tachk.engine import portfolio
from tachk.engine.compiler.program import Goal, Program
from tachk.engine.options import Limits, Options, SearchOrder
from tachk.engine.outcome import INTERRUPTED
from tachk.engine.portfolio import SearchProblem
from tachk.engine.program_image import encode
from tachk.verify.verdict import Answer, Verdict
from tests.support.counters import COUNTERS, NEVER, REACHED
from tests.support.reductions.verdict_agreement import BY_DEFAULT, compare_verdicts, random_questions
from tests.support.seeds import seeds
from tests.support.strategies import with_search_budgets

STORED = 5_000
"""So much work is done before the first of the other attempts."""
ALL_STATES = Options().off("unblocked", "sliced", "symmetry", "local-times", "simulated", "best-first")


def verdict(query: str, options: Options = ALL_STATES, limits: Limits | None = None) -> Verdict:
    (found,) = tachk.loads(COUNTERS).verify(query, options=options, limits=limits)
    return found


def test_what_nothing_hinders_is_found_soon_after_many_states() -> None:
    found = verdict(REACHED)
    assert found.answer is Answer.HOLDS
    assert STORED < found.statistics.states_stored < 1.2 * STORED
    assert found.strategy == "probe"
    assert found.trace is not None
    more = Limits(states=3 * STORED)
    assert verdict(REACHED, ALL_STATES.off("attempts"), more).answer is Answer.UNKNOWN


def test_a_small_turn_comes_before_the_first_one_of_a_budget_in_proportion(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[Program] = []
    with_search_budgets(monkeypatch, after=100)
    with_search_budgets(monkeypatch, "probe", begin=lambda problem: seen.append(problem.program))
    verdict(REACHED, limits=Limits(states=200))
    (compiled,) = seen
    probe = portfolio.PORTFOLIO[-1]
    early = probe.from_the_start(compiled)
    assert (early.after, early.work, early.explored) == (STORED, probe.early_work, None)
    assert early.later() is probe and probe.later().after > probe.after
    assert replace(probe, early_work=0).from_the_start(compiled).after == probe.after
    many = replace(compiled, edges=compiled.edges[:1] * 200)
    assert early.after < probe.from_the_start(many).after < probe.after
    assert probe.from_the_start(replace(many, edges=many.edges * 100)) is probe


def test_turns_that_grow_take_a_fifth_of_the_work_at_most() -> None:
    rows = [row for row in portfolio.PORTFOLIO if row.share > 0]
    done = 0
    for _ in range(60):
        row = min(rows, key=lambda row: row.after)
        assert row.work is not None
        done += row.work
        assert done <= 0.2 * row.after
        rows[rows.index(row)] = later = row.later()
        assert later.work is not None and later.work >= 2 * row.work and later.after >= 2 * row.after
    assert rows[0].after > 10**9


def test_the_time_of_both_searches_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    clock, begin, later = time.perf_counter, portfolio.PORTFOLIO[-1].begin, [0.0]

    def taking_long(problem: SearchProblem) -> Any:
        later[0] = 100.0
        return begin(problem)

    monkeypatch.setattr(time, "perf_counter", lambda: clock() + later[0])
    with_search_budgets(monkeypatch, after=100)
    with_search_budgets(monkeypatch, "probe", begin=taking_long)
    assert 100 < verdict(REACHED).statistics.seconds < 200


def test_interchangeable_processes_keep_their_places_depth_first(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where one state stands for others, the first process is another one after each step."""
    searched = []

    def noting(program: Program, goals: Sequence[Goal]) -> list[int]:
        searched.append(program)
        return encode(program, goals)

    with_search_budgets(monkeypatch, after=100)
    monkeypatch.setattr(portfolio, "encode", noting)
    found = verdict(REACHED, ALL_STATES.on("symmetry"))
    assert found.answer is Answer.HOLDS and found.statistics.interchangeable == 7
    assert searched and all(not program.interchangeable for program in searched)


@pytest.mark.parametrize(
    "options",
    [
        replace(ALL_STATES, order=SearchOrder.BFS),
        replace(ALL_STATES, shortest=True),
        ALL_STATES.off("attempts"),
    ],
    ids=["breadth first", "shortest", "off"],
)
def test_nothing_is_tried_where_the_order_is_requested(options: Options, monkeypatch: pytest.MonkeyPatch) -> None:
    with_search_budgets(monkeypatch, after=100)
    assert verdict(REACHED, options, Limits(states=2000)).answer is Answer.UNKNOWN


@pytest.mark.parametrize("limits", [Limits(depth=20), Limits(states=1000)], ids=["depth", "states"])
def test_limits_are_kept(limits: Limits, monkeypatch: pytest.MonkeyPatch) -> None:
    with_search_budgets(monkeypatch, after=1000)
    assert verdict(REACHED, limits=limits).answer is Answer.UNKNOWN
    assert verdict(REACHED, limits=Limits(depth=60, states=2000)).answer is Answer.HOLDS


def test_deadlocks_are_searched_for_depth_first(monkeypatch: pytest.MonkeyPatch) -> None:
    with_search_budgets(monkeypatch, after=100)
    found = verdict("E<> deadlock", limits=Limits(states=2000))
    assert (found.answer, found.statistics.states_stored < 1000) == (Answer.HOLDS, True)
    assert found.trace is not None


# With the abstraction nothing keeps y from growing, although it always equals x.
SEEMINGLY_STUCK = """
process Q() {
    clock x, y;
    init location A { invariant x <= 3; to A { guard y <= 5; } }
}
system P, Q;
"""


def test_a_deadlock_that_only_seems_to_be_found_does_not_count(monkeypatch: pytest.MonkeyPatch) -> None:
    with_search_budgets(monkeypatch, after=5)
    text = COUNTERS.replace("N = 7", "N = 5").replace("system P;", SEEMINGLY_STUCK)
    (found,) = tachk.loads(text).verify("E<> deadlock", options=ALL_STATES)
    (plain,) = tachk.loads(text).verify("E<> deadlock", options=ALL_STATES.off("attempts"))
    assert found.answer is plain.answer is Answer.FAILS


def test_what_is_not_found_depth_first_is_no_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    with_search_budgets(monkeypatch, after=100)
    with_search_budgets(monkeypatch, "probe", work=10, share=0.0)
    assert verdict(REACHED, limits=Limits(states=2000)).answer is Answer.UNKNOWN
    assert verdict(NEVER, limits=Limits(states=2000)).answer is Answer.UNKNOWN


def test_a_limit_on_time_ends_the_attempt(monkeypatch: pytest.MonkeyPatch) -> None:
    with_search_budgets(monkeypatch, after=100)
    with_search_budgets(monkeypatch, "probe", work=10**9)
    found = verdict(NEVER, limits=Limits(seconds=0.3))
    assert (found.answer, found.reason) == (Answer.UNKNOWN, "time limit")


class Interrupted:
    """A search in which Ctrl-C comes at once."""

    def budgeted(self, work: int, longest: int | None) -> Interrupted:
        return self

    def run(self, expansions: int, seconds: float | None = None, look: object = None) -> _core.Status:
        raise KeyboardInterrupt

    def reached(self, goal: int) -> None:
        return None


@pytest.mark.parametrize("name", ["best-first", "one-order", "probe"])
def test_ctrl_c_in_an_attempt_ends_the_search(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    with_search_budgets(monkeypatch, after=100)
    with_search_budgets(monkeypatch, name, begin=lambda problem: Interrupted())
    found = verdict(NEVER, ALL_STATES.on("best-first"), Limits(states=2000))
    assert (found.answer, found.reason) == (Answer.UNKNOWN, INTERRUPTED)


# Twelve alarms that ring at the same time, each for itself.
ALARMS = """
const int N = 12;
typedef int[1, N] id_t;
int[0, 1] rung[N + 1];
process P(const id_t me) {
    clock x;
    init location waiting { invariant x <= 9 + me - me; to ringing { guard x >= 9; assign rung[me] = RUNG; } }
    location ringing { }
}
system P;
"""


def alarms(options: Options = ALL_STATES, limits: Limits | None = None, rung: str = "1") -> Verdict:
    (found,) = tachk.loads(ALARMS.replace("RUNG", rung)).verify("E<> false", options=options, limits=limits)
    return found


def test_one_order_is_enough_where_time_cannot_pass(monkeypatch: pytest.MonkeyPatch) -> None:
    with_search_budgets(monkeypatch, after=500)
    assert alarms(limits=Limits(states=1000)).answer is Answer.FAILS
    assert alarms(ALL_STATES.off("attempts"), Limits(states=1000)).answer is Answer.UNKNOWN
    assert alarms(ALL_STATES.off("attempts"), Limits(states=5000)).statistics.states_stored == 2**12
    with_search_budgets(monkeypatch, "one-order", sample=4, explored=8)
    assert alarms(limits=Limits(states=1000)).answer is Answer.UNKNOWN


def test_run_time_errors_are_met_in_one_order_and_in_all(monkeypatch: pytest.MonkeyPatch) -> None:
    with_search_budgets(monkeypatch, after=500)
    for options in (ALL_STATES, ALL_STATES.off("attempts")):
        found = alarms(options, rung="me == N ? 2 : 1")
        assert (found.answer, found.reason) == (Answer.UNKNOWN, "run-time error")


class Counting:
    """A search that stores two states for each that it explores, until it has explored 1,000."""

    def __init__(self) -> None:
        self.explored = 0

    def run(self, expansions: int, seconds: float | None = None, look: object = None) -> _core.Status:
        self.explored = min(self.explored + expansions, 1000)
        return _core.Status.FINISHED if self.explored == 1000 else _core.Status.RUNNING

    def effort(self) -> int:
        return 2 * self.explored

    def statistics(self) -> tuple[int, int, int, int]:
        return self.explored, 2 * self.explored, 0, 0


@pytest.mark.parametrize("size", [1, 7, 64, 100, 10**6])
def test_a_segment_is_the_same_however_it_is_divided(size: int) -> None:
    for bound, explored in [({"explored": 100}, 100), ({"effort": 300}, 255), ({"effort": 10**6}, 1000)]:
        search = Counting()
        stretch = portfolio.BudgetedSearch(search, **bound)
        while (status := stretch.run(size)) is _core.Status.RUNNING:
            assert search.explored <= explored
        assert search.explored == explored
        assert status is (_core.Status.FINISHED if explored == 1000 else _core.Status.STATE_LIMIT)


@pytest.mark.parametrize("seed", seeds(range(40)))
def test_no_verdict_changes(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where attempts begin with the first states, and are short or long. Runs are replayed."""
    with_search_budgets(monkeypatch, after=2)
    with_search_budgets(monkeypatch, "probe", work=3 if seed % 2 else 1000)
    with_search_budgets(monkeypatch, "best-first", work=3 if seed % 2 else 1000)
    assert compare_verdicts(random_questions(seed), {"default": BY_DEFAULT}).problems == ()


NAMES = [strategy.name for strategy in portfolio.PORTFOLIO]


@pytest.mark.parametrize("name", NAMES)
def test_each_search_can_be_switched_off(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    begun = []
    with_search_budgets(monkeypatch, after=100)
    for strategy in portfolio.PORTFOLIO:
        with_search_budgets(monkeypatch, strategy.name, begin=lambda problem, own=strategy.name: begun.append(own))
    with_search_budgets(monkeypatch, "local-times", after=100, fitted=lambda row, problem: row)
    assert verdict(REACHED, Options().off("unblocked", "sliced", "symmetry", name), Limits(states=300)).reason
    assert begun == [other for other in NAMES if other != name]
