"""Drawing runs of a network."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from tachk.compiler.features import check_simulated
from tachk.compiler.lower import lower_simulation
from tachk.engines.simulation.simulator import TICKS_PER_UNIT, Drawing, Recorded, Simulated, Simulator
from tachk.model.network import Network
from tachk.runtime.trace import Trace, Values
from tachk.simulation.columns import Column, observed
from tachk.time_limit import check_time
from tachk.time_units import NANOSECONDS, length_of

_NOTHING = Recorded()
_BATCH, _LONG_BATCH = 64, 1024
"""How many runs are drawn at once, while the limit on time is not looked at: with and without recording."""


class Runs:
    """The runs of a network, with some columns."""

    def __init__(self, network: Network, columns: Sequence[Column]) -> None:
        """Raises UnsupportedError for what is not simulated, and InputError for a wrong initial value."""
        check_simulated(network)
        self.network = network
        self.columns = tuple(columns)
        program, chances = lower_simulation(network, observed(columns))
        self.program = program
        self._simulator = Simulator(program, chances)

    def draw(self, drawing: Drawing, numbers: range, recorded: Recorded = _NOTHING) -> Iterator[Simulated]:
        """The runs of these numbers, in order. Raises TimeLimitError between them."""
        batch = _LONG_BATCH if recorded == _NOTHING else _BATCH
        for first in range(numbers.start, numbers.stop, batch):
            check_time()
            yield from self._simulator.runs(drawing, range(first, min(first + batch, numbers.stop)), recorded)

    def trace(self, run: Simulated) -> Trace:
        """What was observed in a run: the values that last, one row for each instant at which one changes, and one for
        the end."""
        unit, factor = _unit(self.network)
        rows = run.observed.reshape(len(run.times), len(self.columns))
        last = np.append(np.diff(run.times) > 0, True)
        times, rows = run.times[last], rows[last]
        changes = np.append(True, (np.diff(rows, axis=0) != 0).any(axis=1))
        times, rows = times[changes], rows[changes]
        if run.end > times[-1]:
            times, rows = np.append(times, run.end), np.concatenate((rows, rows[-1:]))
        labels = tuple(sorted({label for column in self.columns for label in column.labels}))
        places = {label: place for place, label in enumerate(labels)}
        values: dict[str, Values] = {}
        for number, column in enumerate(self.columns):
            numbers = rows[:, number]
            if column.labels:
                numbers = np.array([places[label] for label in column.labels])[numbers]
            values[column.name] = numbers.astype(np.uint8) if column.truth else numbers.astype(np.float64)
        return Trace(
            f"run {run.number}",
            np.ascontiguousarray(times * factor),
            values,
            int(run.end) * factor,
            TICKS_PER_UNIT,
            unit,
            texts=frozenset(column.name for column in self.columns if column.labels),
            labels=labels,
        )


def _unit(network: Network) -> tuple[str, int]:
    """The unit of the times of a trace, and how many of them are one of the network: of ``10 ms`` ms, and 10."""
    if not network.time_unit:
        return "", 1
    amount, _, name = network.time_unit.strip().rpartition(" ")
    length = length_of(network.time_unit)
    if length is None or name not in NANOSECONDS or not (amount or "1").isdigit():
        return "", 1
    return name, int(amount or 1)
