"""Turns of the portfolio beside the main search: they change nothing but the time, and end when they have to."""

from __future__ import annotations

import gc
import signal
import threading
import time
from collections.abc import Iterator

import pytest

import tachk
from tachk import _core
from tachk.engine import taking_turns
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import INTERRUPTED
from tachk.verify.verdict import Answer, Verdict
from tachk.verify.verify import verify
from tests.support.counters import COUNTERS, NEVER, REACHED
from tests.support.reductions.verdict_agreement import random_questions
from tests.support.seeds import seeds
from tests.support.strategies import with_search_budgets

ONE = Options().off("unblocked", "sliced", "symmetry", "local-times", "first-runs")
TWO = Options(processes=2, without=ONE.without)


@pytest.fixture(autouse=True)
def beside_from_the_start(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(taking_turns, "BESIDE_FROM", 0)
    yield
    assert all(thread.name != "beside" for thread in threading.enumerate())


def verdict(query: str, options: Options, limits: Limits | None = None) -> Verdict:
    (found,) = tachk.loads(COUNTERS).verify(query, options=options, limits=limits)
    return found


def described(found: Verdict) -> tuple[object, ...]:
    """All of a verdict that does not depend on the clock."""
    s = found.statistics
    counts = s.states_explored, s.states_stored, s.transitions, s.lost
    return found.answer, found.strategy, found.reason, found.notes, found.fault, found.trace, found.path, counts


@pytest.mark.parametrize("name", ["simulated", "best-first", "probe"])
def test_the_row_that_answers_is_that_of_one_core(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    with_search_budgets(monkeypatch, after=5000)
    others = {"simulated", "best-first", "probe"} - {name}
    one = verdict(REACHED, ONE.off(*others))
    assert (one.answer, one.strategy) == (Answer.HOLDS, name)
    for _ in range(5):
        assert described(verdict(REACHED, TWO.off(*others))) == described(one)


@pytest.mark.parametrize("seed", seeds(range(40)))
def test_nothing_depends_on_the_number_of_cores(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where turns begin with the first states, and are short or long."""
    with_search_budgets(monkeypatch, after=(2, 20, 200)[seed % 3])
    with_search_budgets(monkeypatch, "probe", work=3 if seed % 2 else 1000)
    with_search_budgets(monkeypatch, "best-first", work=3 if seed % 2 else 1000)
    asked = random_questions(seed)
    for query in asked.queries:
        one, two, again = (
            verify(asked.network, [query], Options(processes=processes), Limits(states=3000))[0]
            for processes in (1, 2, 2)
        )
        assert described(one) == described(two) == described(again)


class Slow:
    """A search that takes until somebody stops it."""

    begun = threading.Event()

    def budgeted(self, work: int, longest: int | None) -> Slow:
        return self

    def run(self, expansions: int, seconds: float | None = None, poll: object = None) -> _core.Status:
        assert callable(poll)
        self.begun.set()
        while True:
            poll()
            if seconds == 0:
                return _core.Status.TIME_LIMIT
            time.sleep(0.001)

    def reached(self, goal: int) -> None:
        return None


def with_a_slow_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    Slow.begun.clear()
    with_search_budgets(monkeypatch, after=100)
    with_search_budgets(monkeypatch, "probe", begin=lambda problem: Slow())


def test_ctrl_c_ends_the_main_search_and_what_is_beside_it(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt() -> None:
        Slow.begun.wait()
        signal.raise_signal(signal.SIGINT)

    with_a_slow_turn(monkeypatch)
    threading.Thread(target=interrupt).start()
    found = verdict(NEVER, TWO.off("best-first", "simulated"))
    assert (found.answer, found.reason) == (Answer.UNKNOWN, INTERRUPTED)


def test_a_limit_on_time_ends_both(monkeypatch: pytest.MonkeyPatch) -> None:
    with_a_slow_turn(monkeypatch)
    found = verdict(NEVER, TWO.off("best-first", "simulated"), Limits(seconds=0.3))
    assert (found.answer, found.reason) == (Answer.UNKNOWN, "time limit")


def test_what_goes_wrong_beside_goes_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    class Wrong(Slow):
        def run(self, expansions: int, seconds: float | None = None, poll: object = None) -> _core.Status:
            raise ZeroDivisionError("beside")

    with_search_budgets(monkeypatch, after=100)
    with_search_budgets(monkeypatch, "probe", begin=lambda problem: Wrong())
    with pytest.raises(ZeroDivisionError, match="beside"):
        verdict(NEVER, TWO)


def test_no_search_outlives_its_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a circle of references: its memory is free at once."""
    with_search_budgets(monkeypatch, after=100)
    gc.collect()
    gc.disable()
    try:
        verdict(NEVER, TWO, Limits(states=2000))
        assert not any(isinstance(one, taking_turns._Turns | taking_turns._MainSearch) for one in gc.get_objects())
    finally:
        gc.enable()


def test_one_core_takes_turns_in_its_own_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    threads = []
    with_search_budgets(monkeypatch, after=100)
    with_search_budgets(monkeypatch, "probe", begin=lambda problem: Told())

    class Told(Slow):
        def run(self, expansions: int, seconds: float | None = None, poll: object = None) -> _core.Status:
            threads.append(threading.current_thread())
            return _core.Status.FINISHED

    for options in (ONE, TWO):
        verdict(NEVER, options.off("best-first", "simulated"), Limits(states=2000))
    assert threads[0] is threading.main_thread() and threads[1].name == "beside"
