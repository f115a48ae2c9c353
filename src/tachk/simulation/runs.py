"""Drawing runs of a network."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

import numpy as np

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.exact_numbers import is_whole
from tachk.base.job import check_job
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
    unit, factor = _unit(network)
    while end * factor > LARGEST_TICK and factor % 10 == 0 and ticks % 10 == 0:
        factor, ticks = factor // 10, ticks // 10
    if end * factor >= 2**63:
        raise UsageError(f"{name}: its times are too long to be counted in {unit}", "simulate a shorter time")
    check_job(_BYTES_A_VALUE * len(times) * (len(columns) + 1))
    instants = np.asarray(times, dtype=np.int64)
    known = np.asarray(rows, dtype=np.int64).reshape(len(times), len(columns))
    last = np.append(np.diff(instants) > 0, True)
    instants, known = instants[last], known[last]
    changes = np.append(True, (np.diff(known, axis=0) != 0).any(axis=1))
    instants, known = instants[changes], known[changes]
    if end > instants[-1]:
        instants, known = np.append(instants, end), np.concatenate((known, known[-1:]))
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


def _unit(network: Network) -> tuple[str, int]:
    """The unit of the times of a trace, and how many of them are one of the network: of ``10 ms`` ms, and 10."""
    if not network.time_unit:
        return "", 1
    amount, _, name = network.time_unit.strip().rpartition(" ")
    length = length_of(network.time_unit)
    if length is None or name not in NANOSECONDS or not is_whole(amount or "1"):
        return "", 1
    return name, int(amount or 1)
