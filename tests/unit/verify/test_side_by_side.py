"""Searches in processes of their own: what one process answers, and what becomes of those that end early."""

from __future__ import annotations

import os
import signal
import threading
from contextlib import suppress
from pathlib import Path

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.base.job import limited
from tachk.base.span import NOWHERE
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import INTERRUPTED, TIME_LIMIT, Statistics
from tachk.model.query import Query
from tachk.verify.plan import Analysis, Search, Task
from tachk.verify.scheduling import in_order, side_by_side
from tachk.verify.scheduling.in_order import Shares
from tachk.verify.scheduling.side_by_side import SideBySide
from tachk.verify.verdict import Answer, Verdict, none_begun

ROOT = Path(__file__).resolve().parents[3]

pytestmark = [
    pytest.mark.drawn,
    pytest.mark.skipif(not hasattr(os, "fork"), reason="there is one process on this system"),
]


@pytest.mark.parametrize(
    ("path", "constants"),
    [("micro_xrce_dds/publication.ta", {"LOSSES": 0}), ("classics/brp.ta", {}), ("classics/train_gate.ta", {"N": 3})],
)
def test_verdicts_and_runs_are_those_of_one_process(
    path: str, constants: dict[str, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    model = tachk.load(ROOT / "models" / path, **constants)
    one = model.verify().record.verdicts
    monkeypatch.setattr(in_order, "ALONE", -1.0)
    several = model.verify(options=Options(processes=3)).record.verdicts
    assert len(one) > 1
    for first, second in zip(one, several, strict=True):
        assert (first.query, first.answer, first.reason, first.notes) == (
            second.query, second.answer, second.reason, second.notes,
        )  # fmt: skip
        assert (first.trace, first.moves, first.path) == (second.trace, second.moves, second.path)
        assert first.statistics.states_stored == second.statistics.states_stored


def test_progress_names_what_is_being_answered(monkeypatch: pytest.MonkeyPatch) -> None:
    model = tachk.load(ROOT / "models/micro_xrce_dds/spec.ta")
    monkeypatch.setattr(in_order, "ALONE", -1.0)
    told: list[tuple[str, ...]] = []
    model.verify(
        property=["ECRA", "TMRK2"],
        options=Options(processes=2),
        progress=lambda statistics, names: told.append(names),
    )
    assert {"ECRA", "TMRK2"} & {name for names in told for name in names}


QUERIES = tachk.load(ROOT / "models/micro_xrce_dds/publication.ta").loaded.queries[:4]


def searches() -> list[Search]:
    return [Search(Analysis.REACHABILITY, (Task(number, query),)) for number, query in enumerate(QUERIES)]


def found(query: Query) -> Verdict:
    return Verdict(query, Answer.HOLDS, True, "", Statistics())


def answered(answer: side_by_side.Answer, processes: int = 2) -> dict[int, Verdict]:
    return SideBySide(searches(), answer, lambda search: Limits()).answered(processes)


def test_a_process_that_is_killed_leaves_its_query_unknown() -> None:
    def answer(search: Search, limits: Limits) -> dict[int, Verdict]:
        if search.tasks[0].number == 1:
            os.kill(os.getpid(), signal.SIGKILL)
        return {task.number: found(task.query) for task in search.tasks}

    verdicts = answered(answer)
    assert [verdicts[number].answer.value for number in range(4)] == ["holds", "unknown", "holds", "holds"]
    assert verdicts[1].reason == "the process of this search was ended by signal 9"


def test_what_a_search_raises_is_raised_with_its_place() -> None:
    def answer(search: Search, limits: Limits) -> dict[int, Verdict]:
        raise UnsupportedError(Diagnostic("E0601", f"search {search.tasks[0].number} cannot be done", NOWHERE))

    with pytest.raises(UnsupportedError, match="search 0 cannot be done") as raised:
        answered(answer, processes=1)
    assert raised.value.diagnostic.code == "E0601"
    assert "in answer" in "".join(raised.value.__notes__)


def test_an_error_that_no_pipe_takes_is_reported_all_the_same() -> None:
    class OwnError(Exception):
        pass

    def answer(search: Search, limits: Limits) -> dict[int, Verdict]:
        raise OwnError("lost on the way")

    with pytest.raises(Exception, match="lost on the way"):
        answered(answer)


def test_ctrl_c_ends_what_runs_and_begins_nothing() -> None:
    def answer(search: Search, limits: Limits) -> dict[int, Verdict]:
        if search.tasks[0].number == 0:
            return {0: found(search.tasks[0].query)}
        os.kill(os.getppid(), signal.SIGINT)
        try:
            signal.pause()
        except KeyboardInterrupt:
            return none_begun(search.tasks, INTERRUPTED)
        return {}

    before = signal.getsignal(signal.SIGINT)
    verdicts = answered(answer, processes=1)
    assert verdicts[0].answer is Answer.HOLDS
    assert [verdicts[number].reason for number in (1, 2, 3)] == [INTERRUPTED] * 3
    assert signal.getsignal(signal.SIGINT) is before


def test_a_program_in_the_background_does_not_get_ctrl_c() -> None:
    def answer(search: Search, limits: Limits) -> dict[int, Verdict]:
        os.kill(os.getpid(), signal.SIGINT)
        os.kill(os.getppid(), signal.SIGINT)
        return {task.number: found(task.query) for task in search.tasks}

    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        verdicts = answered(answer)
    finally:
        signal.signal(signal.SIGINT, before)
    assert {verdict.answer for verdict in verdicts.values()} == {Answer.HOLDS}


def test_ctrl_c_is_heard_where_another_thread_gets_it() -> None:
    over = threading.Event()
    elsewhere = threading.Thread(target=over.wait)
    elsewhere.start()

    def answer(search: Search, limits: Limits) -> dict[int, Verdict]:
        os.kill(os.getppid(), signal.SIGINT)
        with suppress(KeyboardInterrupt):
            signal.pause()
        return none_begun(search.tasks, INTERRUPTED)

    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # which leaves the other thread to get it
    try:
        verdicts = answered(answer, processes=1)
    finally:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
        over.set()
        elsewhere.join()
    assert {verdict.reason for verdict in verdicts.values()} == {INTERRUPTED}


def test_a_search_whose_time_is_over_leaves_time_to_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    model = tachk.load(ROOT / "models/micro_xrce_dds/client_3_0.ta", LOSSES=3)
    monkeypatch.setattr(in_order, "ALONE", -1.0)
    options, limits = Options(processes=2).off("unblocked", "sliced"), Limits(seconds=1)
    report = model.verify("E<> false", property=["RMIO"], options=options, limits=limits)
    assert {verdict.reason for verdict in report.record.verdicts} == {TIME_LIMIT}


def test_shares_of_the_seconds() -> None:
    first, second, *_ = searches()
    with limited(80):
        in_order = Shares(Limits(), 4)
        assert in_order.begin(first).seconds == pytest.approx(20, abs=2)
        assert in_order.begin(second).seconds == pytest.approx(80 / 3, abs=2)
        side_by_side = Shares(Limits(), 4)
        assert side_by_side.begin(first, 2).seconds == pytest.approx(40, abs=2)
        assert side_by_side.begin(second, 8).seconds == pytest.approx(80, abs=2)
        assert Shares(Limits(seconds_each=3), 4).begin(first).seconds == 3
    assert Shares(Limits(), 4).begin(first).seconds is None
