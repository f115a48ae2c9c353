"""Drawing runs of a network."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.exact_numbers import is_whole
from tachk.base.job import check_job
from tachk.base.records import dataclass
from tachk.base.time_units import NANOSECONDS, length_of
from tachk.engine.compiler.features import check_simulated
from tachk.engine.compiler.lower import lower_simulation
from tachk.engine.simulation.simulator import Numbers, RecordedChanges, Simulated, SimulationOptions, Simulator
from tachk.model.network import Network
from tachk.model.run import Transition
from tachk.recordings.traces.trace import LARGEST_TICK, Trace, Values
from tachk.simulation.columns import Column, observed

_NOTHING = RecordedChanges()
_BATCH, _LONG_BATCH = 64, 1024
"""The number of runs that are drawn between two checks of the limit on time: with and without recording."""
_BYTES_A_VALUE = 32
"""The memory that a trace takes for each value of a run while it is made of it: so many copies are held together."""


@dataclass(frozen=True, slots=True)
class RunRows:
    """The rows of some runs, one behind the other.

    Attributes:
        run: the number of the run of each row.
        times: in ticks.
        end: of the longest run.
        unit: of the times; empty if the network has none.
        columns: truth values, whole numbers and floating point numbers as such; of texts the places in ``labels``.
        labels: the texts of each column of texts.
    """

    run: NDArray[np.int64]
    times: NDArray[np.int64]
    end: int
    ticks_per_unit: int
    unit: str
    columns: Mapping[str, NDArray[Any]]
    labels: Mapping[str, tuple[str, ...]]


def _typed(column: Column, numbers: Numbers) -> NDArray[Any]:
    if column.floating:
        return np.ascontiguousarray(numbers).view(np.float64)
    return numbers.astype(np.bool_) if column.truth else numbers


class Runs:
    """The runs of a network, with some columns."""

    def __init__(self, network: Network, columns: Sequence[Column], counters: Sequence[int] = ()) -> None:
        """Args:
            counters: further slots that are observed, for `counts`.

        Raises UnsupportedError for what is not simulated, and InputError for a wrong initial value."""
        check_simulated(network)
        self.network = network
        self.columns = tuple(columns)
        program, chances = lower_simulation(network, [*observed(columns), *counters])
        self.program = program
        self.simulator = Simulator(program, chances)

    def draw(
        self, drawing: SimulationOptions, numbers: range, recorded: RecordedChanges = _NOTHING
    ) -> Iterator[Simulated]:
        """The runs of these numbers, in order. Raises StoppedError between them."""
        batch = _LONG_BATCH if recorded == _NOTHING else _BATCH
        for first in range(numbers.start, numbers.stop, batch):
            check_job()
            yield from self.simulator.runs(drawing, range(first, min(first + batch, numbers.stop)), recorded)

    def trace(self, run: Simulated) -> Trace:
        """The observed columns of a run."""
        name = f"run {run.number}"
        rows = run.observed[:, : len(self.columns)]
        return recording(self.network, self.columns, name, run.times, rows, int(run.end), run.ticks_per_unit, run.lasts)

    def rows(self, drawn: Sequence[Simulated]) -> RunRows:
        """The observed columns of some runs of one length, with the rows and the times that their traces have."""
        end = max(int(run.end) for run in drawn)
        unit, factor, ticks = _units(self.network, f"run {drawn[0].number}", end, drawn[0].ticks_per_unit)
        sizes = [len(run.times) for run in drawn]
        check_job(_BYTES_A_VALUE * sum(sizes) * (len(self.columns) + 1))
        known = np.concatenate([run.observed for run in drawn])[:, : len(self.columns)]
        which, instants, known = _lasting(
            np.concatenate([run.times for run in drawn]), known, sizes, [int(run.end) for run in drawn]
        )
        columns = {column.name: _typed(column, known[:, place]) for place, column in enumerate(self.columns)}
        labels = {column.name: column.labels for column in self.columns if column.labels}
        numbers = np.array([run.number for run in drawn], dtype=np.int64)
        return RunRows(numbers[which], instants * factor, end * factor, ticks, unit, columns, labels)

    def counts(self, run: Simulated) -> list[int]:
        """The counters at the end of a run that was observed."""
        return run.observed[-1, len(self.columns) :].tolist() if len(run.observed) else []


def steps_of(run: Simulated) -> Iterator[tuple[Fraction, Transition | None]]:
    """The transitions of a run whose actions are recorded, with their times; None where only time passes."""
    last = int(run.times[0])
    for time, transition in zip(run.times[1:].tolist(), run.actions, strict=True):
        if transition is not None:
            yield Fraction(time, run.ticks_per_unit), transition
            last = time
    if run.end > last:
        yield Fraction(run.end, run.ticks_per_unit), None


def recording(
    network: Network,
    columns: Sequence[Column],
    name: str,
    times: Numbers | Sequence[int],
    rows: Numbers | Sequence[Sequence[int]],
    end: int,
    ticks: int,
    lasts: bool,
) -> Trace:
    """The values that last: one row for each instant at which one changes, and one for the end.

    Args:
        times: of the states, in ticks.
        rows: the values of the columns in each state.
        ticks: how many are a unit of time.
        lasts: whether time can pass at the end. Else others may follow at the same instant, and nothing is known of
            it, not even what can no longer happen there.

    Raises UsageError for times that do not fit.
    """
    unit, factor, ticks = _units(network, name, end, ticks)
    check_job(_BYTES_A_VALUE * len(times) * (len(columns) + 1))
    known = np.asarray(rows, dtype=np.int64).reshape(len(times), len(columns))
    _, instants, known = _lasting(np.asarray(times, dtype=np.int64), known, [len(times)], [end])
    labels = tuple(sorted({label for column in columns for label in column.labels}))
    places = {label: place for place, label in enumerate(labels)}
    values: dict[str, Values] = {}
    for number, column in enumerate(columns):
        numbers = known[:, number]
        if column.labels:
            numbers = np.array([places[label] for label in column.labels])[numbers]
        if column.floating:
            values[column.name] = np.ascontiguousarray(numbers).view(np.float64)
            continue
        values[column.name] = numbers.astype(np.uint8) if column.truth else numbers.astype(np.float64)
    return Trace(
        name,
        np.ascontiguousarray(instants * factor),
        values,
        end * factor,
        ticks,
        unit,
        texts=frozenset(column.name for column in columns if column.labels),
        labels=labels,
        floating=frozenset(column.name for column in columns if column.floating),
        known_before=(end + 1 if lasts else max(end - 1, 0)) * factor,
    )


def _units(network: Network, name: str, end: int, ticks: int) -> tuple[str, int, int]:
    """The unit of the times of a recording, how many ticks of it are one of the run, and how many are a unit.

    Raises UsageError for times that do not fit.
    """
    unit, factor = _unit(network)
    while end * factor > LARGEST_TICK and factor % 10 == 0 and ticks % 10 == 0:
        factor, ticks = factor // 10, ticks // 10
    if end * factor >= 2**63:
        raise UsageError(f"{name}: its times are too long to be counted in {unit}", "simulate a shorter time")
    return unit, factor, ticks


def _lasting(
    instants: Numbers, known: Numbers, sizes: Sequence[int], ends: Sequence[int]
) -> tuple[Numbers, Numbers, Numbers]:
    """Of some runs, one behind the other, a row for each instant at which a value changes, and one for the end.

    Args:
        instants, known: of each state.
        sizes: how many states each run has, one at least.

    Returns the place of the run of each row, the instants and the values.
    """
    which = np.repeat(np.arange(len(sizes)), sizes)
    last = np.append((np.diff(instants) > 0) | (np.diff(which) > 0), True)
    which, instants, known = which[last], instants[last], known[last]
    changes = np.append(True, (np.diff(known, axis=0) != 0).any(axis=1) | (np.diff(which) > 0))
    which, instants, known = which[changes], instants[changes], known[changes]
    final = np.append(np.flatnonzero(np.diff(which)), len(which) - 1)
    until = np.asarray(ends, dtype=np.int64)
    final, until = final[later := until > instants[final]], until[later]
    behind = final + 1
    return (
        np.insert(which, behind, which[final]),
        np.insert(instants, behind, until),
        np.insert(known, behind, known[final], axis=0),
    )


def _unit(network: Network) -> tuple[str, int]:
    """The unit of the times of a trace, and how many of them are one of the network: of ``10 ms`` ms, and 10."""
    if not network.time_unit:
        return "", 1
    amount, _, name = network.time_unit.strip().rpartition(" ")
    length = length_of(network.time_unit)
    if length is None or name not in NANOSECONDS or not is_whole(amount or "1"):
        return "", 1
    return name, int(amount or 1)
