"""Simulated runs: `python -m bench.simulation speed`, `formulas`, `files` and `agree NETWORKS SEED`.

`speed` prints transitions a second of one core without recording, and of a plain simulator in Python. `formulas` prints
what a run costs, alone and with a formula that is evaluated on it; `files` rows a second of processor time that leave
as Parquet, beside runs that are written one by one. `agree` draws runs of random networks with every policy, replays
each, and prints every disagreement with the seed that reproduces it; exit status 1 after one.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

from plain_simulator import PlainSimulator
from random_agreement import SHAPES

import tachk
from tachk.base.diagnostics.diagnostic import InputError, UnsupportedError
from tachk.engine.simulation.policy import Policy
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, RecordedChanges, SimulationEnding, SimulationOptions
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import ReplayError, replay
from tachk.model.network import Network
from tachk.simulation.formulas import columns_with, formulas_for, truths_on
from tachk.simulation.runs import Runs
from tachk.simulation.tables import parquet_of_runs, run_writer
from tests.support import random_case
from tests.support.simulated.timed import WITH_STATES, state_columns, timed_trace

MODELS: tuple[tuple[str, dict[str, int], int], ...] = (
    ("models/classics/train_gate.ta", {"N": 6}, 10_000),
    ("models/classics/fischer.ta", {"N": 6}, 10_000),
    ("models/micro_xrce_dds/paper.ta", {}, 200),
)


def speed() -> None:
    for path, constants, until in MODELS:
        network = tachk.load(path, **constants).network
        runs = Runs(network, ())
        best = 0.0
        for _ in range(5):
            began = time.process_time()
            drawn = runs.draw(SimulationOptions(1, until * TICKS_PER_UNIT), range(2_000_000 // until // 10 + 1))
            transitions = sum(run.transitions for run in drawn)
            best = max(best, transitions / (time.process_time() - began))
        plain = _plain_speed(network, min(until, 200))
        print(f"{path}: {best / 1e6:.2f} million transitions/s, plain Python {plain:.0f}/s, {best / plain:.0f} times")


def _plain_speed(network: Network, until: int) -> float:
    """Of a simulator without tricks, `plain_simulator`."""
    plain, transitions, runs = PlainSimulator(network), 0, 0
    began = time.process_time()
    while time.process_time() - began < 2:
        transitions += plain.run(until, runs)
        runs += 1
    return transitions / (time.process_time() - began)


FORMULAS: tuple[tuple[str, dict[str, int], int, str, str], ...] = (
    (
        "models/classics/train_gate.ta",
        {"N": 6},
        20,
        "<> Train(1).Crossing",
        "G[0,20] (Train(1).Approaching -> F[0,10] Train(1).Crossing)",
    ),
    (
        "models/classics/train_gate.ta",
        {"N": 6},
        100,
        "<> Train(1).Crossing",
        "G[0,100] (Train(1).Approaching -> F[0,50] Train(1).Crossing)",
    ),
    ("models/classics/fischer.ta", {"N": 6}, 50, "<> P(1).critical", "G[0,30] (P(1).request -> F[0,20] P(1).critical)"),
)


def formulas(runs: int = 20_000) -> None:
    """CPU time of a run: drawn only, asked with one operator, with a formula, and recorded first and evaluated then."""
    for path, constants, until, one, several in FORMULAS:
        model = tachk.load(path, **constants)
        print(f"{path} until {until}, {several}: {_costs(model, until, one, several, runs)}")


def _costs(model: tachk.Model, until: int, one: str, several: str, runs: int) -> str:
    network, drawing = model.network, SimulationOptions(1, until * TICKS_PER_UNIT)
    read = formulas_for(several, network)
    recorded = Runs(network, columns_with(network, (), read))

    def evaluate_afterwards() -> None:
        for run in recorded.draw(drawing, range(runs // 20), RecordedChanges(observed=True)):
            truths_on(recorded.trace(run), read)

    alone = _seconds(lambda: list(Runs(network, ()).draw(drawing, range(runs)))) / runs
    asked = _seconds(lambda: model.estimate(f"Pr[<={until}]({one})", runs=runs)) / runs
    formula = _seconds(lambda: model.estimate(f"Pr[<={until}]({several})", runs=runs)) / runs
    after = _seconds(evaluate_afterwards) / (runs // 20)
    return (
        f"CPU µs a run {1e6 * alone:.1f}, with {one} {1e6 * asked:.1f}, with the formula {1e6 * formula:.1f} "
        f"({formula / alone:.2f} times), recorded and evaluated afterwards {1e6 * after:.0f}"
    )


def files(runs: int = 40_000) -> None:
    """Rows that leave as Parquet, drawing left out."""
    network = tachk.load("models/classics/train_gate.ta", N=2).network
    drawn = Runs(network, columns_with(network, (), ()))
    drawing = SimulationOptions(1, 50 * TICKS_PER_UNIT)
    records = list(drawn.draw(drawing, range(runs), RecordedChanges(observed=True)))
    with TemporaryDirectory() as folder:
        path = Path(folder) / "runs.parquet"

        def together() -> None:
            with parquet_of_runs(path) as write:
                for run in records:
                    write(run, drawn)

        def one_by_one() -> None:
            with run_writer(path) as write:
                for run in records[:4000]:
                    write(run.number, drawn.trace(run))

        speeds = [parquet_rows(path) / seconds for work in (together, one_by_one) if (seconds := _seconds(work))]
    print(f"Parquet: {speeds[0] / 1e6:.2f} million rows/s, one by one {speeds[1] / 1e6:.2f}")


def parquet_rows(path: Path) -> int:
    from pyarrow import parquet

    return int(parquet.read_metadata(path).num_rows)


def _seconds(work: Callable[[], object]) -> float:
    """CPU time, the least of three."""
    times = []
    for _ in range(3):
        began = time.process_time()
        work()
        times.append(time.process_time() - began)
    return min(times)


def agree(count: int, seed: int) -> int:
    endings: Counter[str] = Counter()
    runs, wrong = 0, 0
    for number in range(count):
        shape = SHAPES[number % len(SHAPES)]
        network = random_case(Random(seed * 1_000_003 + number), shape).network
        try:
            simulated = Runs(network, state_columns(network))
        except (InputError, UnsupportedError):
            endings["refused"] += 1
            continue
        model = prepare(network)
        for policy in Policy:
            drawing = SimulationOptions(number, 20 * TICKS_PER_UNIT, policy, steps=60)
            for run in simulated.draw(drawing, range(2), WITH_STATES):
                endings[run.ending] += 1
                if run.ending is SimulationEnding.INITIAL or not len(run.times):
                    continue
                runs += 1
                try:
                    replay(model, timed_trace(network, run))
                except ReplayError as error:
                    wrong += 1
                    print(f"network {number} of seed {seed}, {policy}, run {run.number}: {error}")
    print(f"{runs} runs of {count} networks replayed, {wrong} wrong; {dict(endings)}")
    return 1 if wrong else 0


if __name__ == "__main__":
    if sys.argv[1:2] == ["speed"]:
        speed()
    elif sys.argv[1:2] == ["formulas"]:
        formulas()
    elif sys.argv[1:2] == ["files"]:
        files()
    else:
        sys.exit(agree(int(sys.argv[2]), int(sys.argv[3])))
