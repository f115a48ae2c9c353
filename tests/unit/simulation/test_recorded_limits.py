"""A run that is recorded obeys the limits on time and memory while it is recorded, however long it is."""

from __future__ import annotations

import pytest

import tachk
from tachk import _core
from tachk.base import job
from tachk.base.job import OutOfMemoryError, OutOfTimeError, check_job, limited
from tachk.engine.options import Limits
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, RecordedChanges, SimulationOptions
from tachk.model.network import Network
from tachk.simulation.columns import all_columns
from tachk.simulation.runs import Runs

MEGABYTE = 1 << 20
TICKING = """
    clock x; int[0, 9] n;
    process P() { init location a { invariant x <= 1; to a { guard x >= 1; assign x = 0, n = (n + 1) % 10; } } }
    system P;
"""
FLOWING = "hybrid clock h; process P() { init location a { invariant h' == 1; } } system P;"
KINDS = [
    RecordedChanges(),
    RecordedChanges(actions=True),
    RecordedChanges(observed=True),
    RecordedChanges(clocks=True),
]


def runs_of(network: Network) -> Runs:
    return Runs(network, all_columns(network))


@pytest.fixture
def sizes(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """What the process takes, look after look; the last number stays. Every call looks."""
    told = [100 * MEGABYTE]
    monkeypatch.setattr(job, "resident_bytes", lambda: told.pop(0) if len(told) > 1 else told[0])
    monkeypatch.setattr(job, "_SECONDS_BETWEEN_CHECKS", 0.0)
    return told


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("recorded", KINDS)
def test_a_run_looks_while_it_is_drawn(sizes: list[int], recorded: RecordedChanges, threads: int) -> None:
    runs = runs_of(tachk.loads(TICKING).network)
    drawing = SimulationOptions(until=100_000 * TICKS_PER_UNIT, threads=threads)
    with limited(memory=10 * MEGABYTE):
        sizes[:] = [100 * MEGABYTE, 100 * MEGABYTE, 500 * MEGABYTE]  # the second look is that between runs
        check_job()
        with pytest.raises(OutOfMemoryError):
            next(runs.draw(drawing, range(threads), recorded))


def test_a_record_does_not_grow_beyond_what_is_left(sizes: list[int]) -> None:
    """Before a part of the record is copied into a larger place it asks whether that fits."""
    runs = runs_of(tachk.loads(TICKING).network)
    with limited(memory=10 * MEGABYTE), pytest.raises(OutOfMemoryError):
        list(runs.draw(SimulationOptions(until=3_000_000 * TICKS_PER_UNIT), range(1), RecordedChanges(observed=True)))


def test_the_time_is_polled(monkeypatch: pytest.MonkeyPatch) -> None:
    runs = runs_of(tachk.loads(TICKING).network)
    with limited(seconds=1000):
        drawn = runs.draw(SimulationOptions(until=100_000 * TICKS_PER_UNIT), range(1), RecordedChanges(observed=True))
        moments = iter([0.0, 0.0])
        monkeypatch.setattr(job, "monotonic", lambda: next(moments, float("inf")))
        with pytest.raises(OutOfTimeError):
            next(drawn)


@pytest.mark.parametrize("threads", [1, 2])
def test_what_a_look_raises_ends_all_threads(threads: int) -> None:
    runs = runs_of(tachk.loads(TICKING).network)

    def look(more: int) -> None:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        runs.simulator._core.run(
            policy=_core.Policy.STOCHASTIC,
            seed=0,
            first=0,
            runs=2,
            until=2**50,
            ticks_per_unit=1,
            steps=2**63,
            threads=threads,
            actions=False,
            observed=False,
            clocks=False,
            check=look,
        )


@pytest.mark.parametrize(
    ("model", "query"),
    [
        (TICKING, "simulate [<=500000; 1] {n, n + 1, n + 2}"),
        (TICKING, "simulate [<=500000; 1] {x}"),
        (FLOWING, "simulate [#<=5; 1] {h}"),  # no transition comes, and rows for ever
    ],
)
def test_a_query_says_that_memory_was_missing(sizes: list[int], model: str, query: str) -> None:
    """The process is as large as ever: it is what the run takes next that would not fit."""
    report = tachk.loads(f"{model} property q: {query};").verify(limits=Limits(memory_bytes=10 * MEGABYTE))
    answer = report.estimates["q"]
    assert (answer.found, answer.reason) == (None, "memory limit")


def test_the_trace_of_a_run_fits_or_is_not_made(sizes: list[int]) -> None:
    runs = runs_of(tachk.loads(TICKING).network)
    (run,) = runs.draw(SimulationOptions(until=200_000 * TICKS_PER_UNIT), range(1), RecordedChanges(observed=True))
    with limited(memory=200 * MEGABYTE):
        assert runs.trace(run).rows == len(run.times)
    with limited(memory=2 * MEGABYTE), pytest.raises(OutOfMemoryError):
        runs.trace(run)
