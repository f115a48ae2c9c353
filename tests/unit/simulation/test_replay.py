"""Simulated runs are runs: the judge accepts them, and they go nowhere where the search does not."""

from __future__ import annotations

from collections import Counter
from random import Random

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import InputError, UnsupportedError
from tachk.base.job import OutOfTimeError, limited
from tachk.engine.compiler.lower import lower
from tachk.engine.options import Limits
from tachk.engine.simulation.policy import Policy
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, RecordedChanges, SimulationEnding, SimulationOptions
from tachk.engine.zone import explore_everything
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import replay
from tachk.meaning.step import deadlocked, possible
from tachk.model.network import Network
from tachk.simulation.runs import Runs
from tests.support import Shape, random_case
from tests.support.simulated.timed import WITH_STATES, state_columns, timed_trace

SHAPES = (
    Shape(),
    Shape(clocks=2),
    Shape(diagonals=True, clocks=2),
    Shape(stopwatches=True),
    Shape(language=True, exact=0.4, processes=2, clocks=2, constant=3),
    Shape(language=True, clocks_on_broadcast=True, locations=3, clocks=2),
    Shape(priorities=True),
    Shape(priorities=True, clocks=2, processes=3),
)


def _networks(count: int, seed: int) -> list[Network]:
    return [random_case(Random(seed + n), SHAPES[n % len(SHAPES)]).network for n in range(count)]


@pytest.mark.parametrize("policy", Policy)
def test_the_judge_accepts_each_run(policy: Policy) -> None:
    endings: Counter[SimulationEnding] = Counter()
    for number, network in enumerate(_networks(32, seed=4100)):
        try:
            runs = Runs(network, state_columns(network))
        except (UnsupportedError, InputError):
            continue
        model = prepare(network)
        drawing = SimulationOptions(number, 20 * TICKS_PER_UNIT, policy, steps=25)
        for run in runs.draw(drawing, range(2), WITH_STATES):
            endings[run.ending] += 1
            if run.ending is SimulationEnding.INITIAL or not len(run.times):
                continue
            trace = timed_trace(network, run)
            assert len(trace.steps) == run.transitions
            replay(model, trace)
            if run.ending is SimulationEnding.DEADLOCK:
                assert deadlocked(model, trace.states[-1])
                assert not possible(model, trace.states[-1])
    assert {
        SimulationEnding.DEADLOCK,
        SimulationEnding.STEPS,
        *([] if policy is Policy.EARLIEST else [SimulationEnding.HORIZON]),
    } <= endings.keys()


def test_runs_take_only_edges_that_the_search_takes() -> None:
    taken_by_runs = 0
    for number, network in enumerate(_networks(40, seed=4300)):
        try:
            runs = Runs(network, ())
        except (UnsupportedError, InputError):
            continue
        outcome, taken = explore_everything(lower(network)[0], (), limits=Limits(states=2000))
        if outcome.reason:
            continue
        drawing = SimulationOptions(number, 50 * TICKS_PER_UNIT, steps=100)
        for run in runs.draw(drawing, range(10), RecordedChanges(actions=True)):
            used = {(p.process, p.edge) for action in run.actions for p in action.participants}
            assert used <= taken
            taken_by_runs += len(used)
    assert taken_by_runs > 500


def test_threads_and_batches_make_no_difference() -> None:
    network = _networks(1, seed=4102)[0]
    runs = Runs(network, state_columns(network))

    def drawn(threads: int, first: int, last: int) -> list[tuple[object, ...]]:
        drawing = SimulationOptions(7, 20 * TICKS_PER_UNIT, steps=50, threads=threads)
        return [
            (run.number, run.ending, run.end, run.times.tobytes(), run.observed.tobytes())
            for run in runs.draw(drawing, range(first, last), WITH_STATES)
        ]

    together = drawn(1, 0, 100)
    assert together == drawn(2, 0, 100)
    assert together[70:80] == drawn(2, 70, 80)
    assert len({run[3] for run in together}) > 50


def test_a_long_run_ends_when_the_time_is_over() -> None:
    network = tachk.loads("process P() { init location A { exponential_rate 1000000; to A; } } system P;").network
    drawing = SimulationOptions(1, 10**8 * TICKS_PER_UNIT)
    with pytest.raises(OutOfTimeError), limited(0.05):
        list(Runs(network, ()).draw(drawing, range(1)))
