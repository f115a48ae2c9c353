"""Simulation for scripts: `tachk.simulate`."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, Protocol, overload

import numpy as np
from numpy.typing import NDArray

from tachk.diagnostics.diagnostic import UsageError
from tachk.engines.simulation.policy import Policy
from tachk.engines.simulation.simulator import TICKS_PER_UNIT, Drawing, Ending, Recorded
from tachk.loading.load import load_model
from tachk.model.network import Network
from tachk.runtime.trace import Trace
from tachk.simulation.columns import all_columns, chosen_columns
from tachk.simulation.orders import ordered, orders_of
from tachk.simulation.runs import Runs
from tachk.simulation.times import ticks_of


class HasNetwork(Protocol):
    """Such as `tachk.Model`."""

    @property
    def network(self) -> Network: ...


@dataclass(frozen=True, slots=True)
class DrawnRun:
    """A run.

    Attributes:
        number: of the run; with the seed it determines the run.
        ending: why it ends, such as ``Ending.HORIZON``.
        end: when, in time units of the model.
        trace: its signals over exact time, which `tachk.monitor` judges.
    """

    number: int
    ending: Ending
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


def simulate(
    model: HasNetwork | str | os.PathLike[str],
    runs: int = 1,
    until: float | str = 100,
    seed: int = 0,
    policy: str = "stochastic",
    *,
    first: int = 0,
    threads: int = 1,
    max_steps: int | None = None,
    record: Iterable[str] = (),
    fault: str | Iterable[str] = (),
) -> Simulation:
    """Draws random runs of a model. docs/simulation.md says what they are.

    Args:
        model: such as `tachk.load` gives it, or the path of one. Only then floating point variables are part of the
            state; `tachk.load` leaves them out, for they are not checked.
        until: how long they are: a number of time units of the model, or a duration such as ``"3 min"``.
        seed: the same seed gives the same runs, with any number of threads.
        policy: ``"stochastic"``, ``"uniform"``, ``"earliest"`` or ``"latest"``.
        first: the number of the first run.
        record: signals, processes, variables, and ``"P.location"``; none: all signals, processes and variables.
        fault: orders such as ``"lost=0.01"``, see docs/faults.md.

    Raises:
        UsageError: an argument has no meaning.
        UnsupportedError: something in the model cannot be simulated.
    """
    network = load_model(model, keeps_doubles=True).network if isinstance(model, str | os.PathLike) else model.network
    if policy not in {known.value for known in Policy}:
        raise UsageError(f"there is no policy {policy!r}", f"one of {', '.join(Policy)}")
    if runs < 1 or first < 0 or threads < 1:
        raise UsageError("runs and threads are at least 1, and first at least 0")
    chosen = tuple(record)
    wanted = ordered(network, orders_of([fault] if isinstance(fault, str) else fault))
    drawn = Runs(wanted.network, chosen_columns(network, chosen) if chosen else all_columns(network))
    drawing = Drawing(seed, ticks_of(str(until), network.time_unit, "until"), Policy(policy), max_steps, threads)
    found = drawn.draw(drawing, range(first, first + runs), Recorded(observed=True))
    return Simulation(
        tuple(
            DrawnRun(run.number, run.ending, Fraction(run.end, TICKS_PER_UNIT), run.transitions, drawn.trace(run))
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
