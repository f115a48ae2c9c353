"""Drawn runs as scripts want them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from tachk.engine.simulation.simulator import RecordedChanges, SimulationEnding, SimulationOptions
from tachk.model.network import Network
from tachk.recordings.traces.trace import Trace
from tachk.simulation.columns import all_columns, chosen_columns
from tachk.simulation.orders import ordered, orders_of
from tachk.simulation.runs import Runs


@dataclass(frozen=True, slots=True)
class DrawnRun:
    """A run.

    Attributes:
        number: of the run; with the seed it determines the run.
        ending: why it ends, such as ``SimulationEnding.HORIZON``.
        end: when, in time units of the model.
        trace: its signals over exact time, which `tachk.monitor` judges.
    """

    number: int
    ending: SimulationEnding
    end: Fraction
    transitions: int
    trace: Trace = field(repr=False)

    @property
    def times(self) -> NDArray[np.float64]:
        """Of the rows, in the unit of the model; ``trace`` has them exactly."""
        return self.trace.times / self.trace.ticks_per_unit

    def __getitem__(self, name: str) -> NDArray[Any]:
        """A column: numbers, truth values, or the names of locations. Raises KeyError."""
        return column_of(self.trace, name)

    def to_columns(self) -> dict[str, NDArray[Any]]:
        """``time`` and every column, for `pandas.DataFrame` and the like."""
        return {"time": self.times, **{name: self[name] for name in self.trace.columns}}


@dataclass(frozen=True, slots=True)
class Simulation(Sequence[DrawnRun]):
    """Runs, in the order of their numbers."""

    runs: tuple[DrawnRun, ...]

    @overload
    def __getitem__(self, index: int) -> DrawnRun: ...
    @overload
    def __getitem__(self, index: slice) -> Simulation: ...
    def __getitem__(self, index: int | slice) -> DrawnRun | Simulation:
        return Simulation(self.runs[index]) if isinstance(index, slice) else self.runs[index]

    def __len__(self) -> int:
        return len(self.runs)

    def __iter__(self) -> Iterator[DrawnRun]:
        return iter(self.runs)

    def to_columns(self) -> dict[str, NDArray[Any]]:
        """All runs one below the other, with a column ``run``."""
        numbers = [np.full(run.trace.rows, run.number) for run in self.runs]
        parts = [run.to_columns() for run in self.runs]
        joined = {name: np.concatenate([part[name] for part in parts]) for name in (parts[0] if parts else ())}
        return {"run": np.concatenate(numbers) if numbers else np.empty(0, dtype=np.int64), **joined}

    def __repr__(self) -> str:
        return f"<{len(self.runs)} {'run' if len(self.runs) == 1 else 'runs'}>"


def drawn_runs(
    network: Network, drawing: SimulationOptions, numbers: range, record: Sequence[str], orders: Sequence[str]
) -> Simulation:
    """Runs of a network with these columns, all if there are none, and orders for faults. Raises UsageError."""
    wanted = ordered(network, orders_of(orders))
    drawn = Runs(wanted.network, chosen_columns(network, record) if record else all_columns(network))
    found = drawn.draw(drawing, numbers, RecordedChanges(observed=True))
    return Simulation(
        tuple(
            DrawnRun(run.number, run.ending, Fraction(run.end, run.ticks_per_unit), run.transitions, drawn.trace(run))
            for run in found
            if len(run.times)
        )
    )


def column_of(trace: Trace, name: str) -> NDArray[Any]:
    """A column with values as scripts want them. Raises KeyError."""
    values = trace.columns[name]
    if name in trace.texts:
        return np.array(trace.labels, dtype=object)[values.astype(np.int64)]
    return values.astype(bool) if values.dtype.kind == "u" else values
