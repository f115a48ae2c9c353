"""Random formulas on runs of random networks: the same verdicts and robustness on a run and on each file of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from random import Random

import pytest

import tachk
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, RecordedChanges, SimulationOptions
from tachk.model.network import Network
from tachk.model.random_networks import Shape, random_case
from tachk.recordings.monitors.formulas import NamedFormula, read_formulas
from tachk.recordings.traces.trace import Trace
from tachk.simulation.columns import all_columns
from tachk.simulation.formulas import columns_with
from tachk.simulation.runs import Runs
from tachk.simulation.tables import run_writer
from tests.support.seeds import seeds

ENDINGS = ("csv", "jsonl", "vcd", *(("parquet",) if find_spec("pyarrow") else ()))
FORMULAS = 4
UNTIL = 12

Judged = tuple[str, tuple[float, float]]


def random_network(random: Random) -> Network:
    """A network with a unit of time, so that bounds mean the same in a dump, which counts nanoseconds."""
    network = random_case(random, Shape(processes=random.choice((2, 3)))).network
    return replace(network, time_unit=random.choice(("1 s", "1 ms")))


def condition(random: Random, network: Network) -> str:
    process = random.choice(network.processes)
    place = f"{process.name}.{random.choice(process.locations).name}"
    columns = [column for column in all_columns(network) if not column.labels]
    if not columns or random.random() < 0.5:
        return place
    column = random.choice(columns)
    name = f"({column.name} == true)" if column.truth else column.name
    if column.truth:
        return name if random.random() < 0.5 else f"!{name}"
    return f"{name} {random.choice(('<', '<=', '==', '!=', '>'))} {random.randint(-1, 3)}"


def formula(random: Random, network: Network, depth: int = 2) -> str:
    if depth == 0:
        return f"({condition(random, network)})"
    unit = network.time_unit.partition(" ")[2]
    low, length = random.choice((0, 0, 1, 2.5)), random.choice((0, 1, 3, 7.5))
    window = "" if random.random() < 0.2 else f"[{low}, {low + length} {unit}]" if low == 0 else f"({low} {unit}, inf)"
    one, two = (formula(random, network, depth - 1) for _ in range(2))
    return random.choice(
        (
            f"(F{window} {one})",
            f"(G{window} ({one} -> {two}))",
            f"(O{window} {one})",
            f"({one} U{window} {two})",
            f"({one} && {two})",
            f"!{one}",
            f"rise({condition(random, network)})",
            f"change({random.choice(network.processes).name})",
        )
    )


def judged(formulas: list[NamedFormula], trace: object) -> list[Judged]:
    report = tachk.monitor(formulas, trace)
    return [(verdict.truth.word, verdict.robustness) for verdict in report]


def compared(seed: int, folder: Path) -> Iterator[tuple[str, list[Judged], list[Judged]]]:
    """The ending of each file, what is worth what on a run, and on the file of it."""
    random = Random(seed)
    network = random_network(random)
    formulas = list(read_formulas_of([formula(random, network) for _ in range(FORMULAS)]))
    drawing = SimulationOptions(seed, UNTIL * TICKS_PER_UNIT)
    written = Runs(network, columns_with(network, (), ()))
    drawn = Runs(network, columns_with(network, (), formulas))
    (run,) = drawn.draw(drawing, range(1), RecordedChanges(observed=True))
    (again,) = written.draw(drawing, range(1), RecordedChanges(observed=True))
    expected = judged(formulas, on_its_own(drawn.trace(run)))
    for ending in ENDINGS:
        path = folder / f"{seed}.{ending}"
        with run_writer(path) as write:
            write(0, written.trace(again))
        yield ending, expected, judged(formulas, path)


def read_formulas_of(texts: list[str]) -> Iterator[NamedFormula]:
    for number, text in enumerate(texts):
        yield replace(read_formulas(text)[0], name=f"p{number}")


def on_its_own(trace: Trace) -> Trace:
    """A file does not tell that its run goes on."""
    return replace(trace, known_before=None)


@pytest.mark.parametrize("seed", seeds(range(12)))
def test_a_file_says_what_its_run_says(seed: int, tmp_path: Path) -> None:
    for ending, expected, found in compared(seed, tmp_path):
        assert found == expected, ending
