"""Simulation and replaying for scripts: `tachk.simulate`, `tachk.replay`."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import Any, Protocol, overload

import numpy as np
from numpy.typing import NDArray

from tachk.base.arguments import checked_arguments
from tachk.base.diagnostics.diagnostic import Diagnostic, UsageError
from tachk.base.diagnostics.render import render
from tachk.base.diagnostics.suggestion import unknown_key
from tachk.base.frames import data_frame
from tachk.base.notebook import html_table, preformatted
from tachk.base.span import Source
from tachk.engine.simulation.policy import Policy
from tachk.engine.simulation.simulator import RecordedChanges, SimulationEnding, SimulationOptions
from tachk.formats.loading.load import load_model
from tachk.frontend.loaded import LoadedModel
from tachk.meaning.run_view import RunNames, Snapshot, TraceView, rows_of_run, view_trace
from tachk.model.network import Network
from tachk.model.quantity import decimal
from tachk.model.run import TimedTrace
from tachk.recordings.traces.trace import Trace
from tachk.simulation.columns import all_columns, chosen_columns, columns_for
from tachk.simulation.fault_injection import read_plan, with_faults
from tachk.simulation.runs import Runs
from tachk.simulation.simulated import simulated
from tachk.simulation.stepping.files import check_determined, read_submitted
from tachk.simulation.stepping.rejections import rejection_diagnostic
from tachk.simulation.stepping.replaying import replay_submitted
from tachk.simulation.stepping.run_file import read_run_file, run_text
from tachk.simulation.stepping.signals import signals_of
from tachk.simulation.stepping.submitted import SubmittedRun
from tachk.simulation.times import parsed_time_bound

_MOST_SHOWN = 20
"""Rows of a table in a notebook."""


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
        """The times of the rows, in the unit of the model; ``trace`` has them exactly."""
        return self.trace.times / self.trace.ticks_per_unit

    def __getitem__(self, name: str) -> NDArray[Any]:
        """A column: numbers, truth values, or the names of locations. Raises KeyError."""
        return column_of(self.trace, name)

    def to_columns(self) -> dict[str, NDArray[Any]]:
        """``time`` and every column, for `pandas.DataFrame` and the like."""
        return {"time": self.times, **{name: self[name] for name in self.trace.columns}}

    def to_rows(self) -> list[dict[str, Any]]:
        """A row for each time at which a column changes, and one for the end."""
        return _rows(self.to_columns())

    def to_frame(self) -> Any:
        """`to_rows` as a `pandas.DataFrame`. Raises UsageError where pandas is not installed."""
        return data_frame(self.to_columns())

    def __repr__(self) -> str:
        return f"<run {self.number}: {self.transitions} transitions until {decimal(self.end)}, {self.ending}>"

    def _repr_html_(self) -> str:
        columns = self.to_columns()
        rows = [list(row.values()) for row in _rows({name: all_[:_MOST_SHOWN] for name, all_ in columns.items()})]
        left_out = self.trace.rows - _MOST_SHOWN
        more = f"; {left_out} more rows: to_frame() has them" if left_out > 0 else ""
        return html_table(list(columns), rows, f"{self!r}"[1:-1] + more)


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

    def to_rows(self) -> list[dict[str, Any]]:
        """A row for each run and each time at which one of its columns changes."""
        return _rows(self.to_columns())

    def to_frame(self) -> Any:
        """`to_rows` as a `pandas.DataFrame`. Raises UsageError where pandas is not installed."""
        return data_frame(self.to_columns())

    def __repr__(self) -> str:
        return f"<{len(self.runs)} {'run' if len(self.runs) == 1 else 'runs'}>"

    def _repr_html_(self) -> str:
        columns = ("run", "ending", "end", "transitions", "rows")
        rows = [
            (run.number, str(run.ending), decimal(run.end), run.transitions, run.trace.rows)
            for run in self.runs[:_MOST_SHOWN]
        ]
        left_out = len(self.runs) - _MOST_SHOWN
        caption = f"{self!r}"[1:-1] + (f"; {left_out} more than are shown" if left_out > 0 else "")
        return html_table(columns, rows, caption)


def _rows(columns: Mapping[str, NDArray[Any]]) -> list[dict[str, Any]]:
    """A dictionary for each row of columns, with Python's own numbers."""
    lists = [column.tolist() for column in columns.values()]
    return [dict(zip(columns, row, strict=True)) for row in zip(*lists, strict=True)]


def drawn_runs(
    network: Network, drawing: SimulationOptions, numbers: range, record: Sequence[str], plan: Sequence[str]
) -> Simulation:
    """Runs of a network with these columns, all if there are none, and a fault-injection plan. Raises UsageError."""
    wanted = with_faults(network, read_plan(plan))
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
    """A column with values as scripts want them: numbers of a model that are whole are integers. Raises KeyError."""
    if name not in trace.columns:
        raise unknown_key(name, trace.columns)
    values = trace.columns[name]
    if name in trace.texts:
        return np.array(trace.labels, dtype=object)[values.astype(np.int64)]
    if values.dtype.kind == "u":
        return values.astype(bool)
    return values if name in trace.floating else values.astype(np.int64)


class HasNetwork(Protocol):
    """Such as `tachk.Model`."""

    @property
    def network(self) -> Network: ...


class HasRun(Protocol):
    """Such as `tachk.Report.run` gives it."""

    @property
    def network(self) -> Network: ...

    @property
    def trace(self) -> TimedTrace: ...


@dataclass(frozen=True, slots=True)
class Replay:
    """The result of replaying a run on a model. It is true if all of it is a run.

    Attributes:
        trace: the run in numbers, as far as it is one.
        refusal: at which step and why it goes no further, with the places; None if all of it is a run.
    """

    names: RunNames = field(repr=False)
    trace: TimedTrace = field(repr=False)
    refusal: Diagnostic | None

    def __bool__(self) -> bool:
        return self.refusal is None

    def __len__(self) -> int:
        """The number of steps."""
        return len(self.trace.steps)

    @property
    def view(self) -> TraceView:
        """The run by the names of its model."""
        return view_trace(self.names.network, self.trace)

    @property
    def states(self) -> tuple[Snapshot, ...]:
        """The initial state, and the one after each step: locations, variables, clocks and time by name."""
        view = self.view
        return (view.initial, *(step.state for step in view.steps))

    def signals(self, record: Iterable[str] = ()) -> Trace:
        """The columns of the run, for `tachk.monitor`: signals, locations and variables, or the named ones."""
        columns = columns_for(self.names.network, tuple(record), ())
        return signals_of(self.names, columns, self.trace, "the run").trace

    def to_text(self) -> str:
        """The run as `tachk step` saves it."""
        return run_text(self.names, self.trace)

    def to_rows(self) -> list[dict[str, Any]]:
        """A row for the start and for each step: its time, what happens, the locations, the variables and the clocks
        after it. Times and clocks are floating-point numbers here."""
        return rows_of_run(self.view)

    def to_frame(self) -> Any:
        """`to_rows` as a `pandas.DataFrame`. Raises UsageError where pandas is not installed."""
        return data_frame(self.to_rows())

    def __repr__(self) -> str:
        found = "all of it is a run" if self.refusal is None else self.refusal.message
        return f"<Replay of {len(self)} {'step' if len(self) == 1 else 'steps'}: {found}>"

    def _repr_html_(self) -> str:
        rows = self.to_rows()
        table = html_table(list(rows[0]), [list(row.values()) for row in rows], f"{self!r}"[1:-1])
        return table if self.refusal is None else f"{table}\n{preformatted(render(self.refusal))}"


def _network_of(model: HasNetwork | str | os.PathLike[str]) -> Network:
    """With the floating point variables and hybrid clocks of its text, which `tachk.load` leaves out."""
    if isinstance(model, str | os.PathLike):
        return load_model(model, keeps_doubles=True).network
    loaded = getattr(model, "loaded", None)
    return simulated(loaded, getattr(model, "path", "")).network if isinstance(loaded, LoadedModel) else model.network


def names_of_runs(model: HasNetwork | str | os.PathLike[str]) -> RunNames:
    """The names in runs that the reference semantics executes. Raises UsageError, UnsupportedError."""
    network = _network_of(model)
    if network.has_hybrid_clocks and not isinstance(model, str | os.PathLike):
        network = model.network  # which leaves out hybrid clocks: the semantics that judges runs has none
    check_determined(network)
    return RunNames(network)


@checked_arguments
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
        model: such as `tachk.load` gives it, or the path of one. Floating point variables, which `tachk.load` leaves
            out, for they are not checked, are part of the state here.
        until: how long they are: a number of time units of the model, or a duration such as ``"3 min"``.
        seed: the same seed gives the same runs, with any number of threads.
        policy: ``"stochastic"``, ``"uniform"``, ``"earliest"``, ``"latest"`` or ``"boundary"``.
        first: the number of the first run.
        record: signals, processes, variables, and ``"P.location"``; none: all signals, processes and variables.
        fault: faults to inject, such as ``"lost=0.01"``, see docs/faults.md.

    Raises:
        UsageError: an argument has no meaning.
        UnsupportedError: something in the model cannot be simulated.
    """
    network = _network_of(model)
    if policy not in {known.value for known in Policy}:
        raise UsageError(f"there is no policy {policy!r}", f"one of {', '.join(Policy)}")
    if runs < 1 or first < 0 or threads < 1:
        raise UsageError("runs and threads are at least 1, and first at least 0")
    end = parsed_time_bound(str(until), network.time_unit, "until")
    drawing = SimulationOptions(seed, end.ticks, Policy(policy), max_steps, threads, end.ticks_per_unit)
    plan = [fault] if isinstance(fault, str) else list(fault)
    return drawn_runs(network, drawing, range(first, first + runs), tuple(record), plan)


def _submitted(run: HasRun | str | os.PathLike[str], property: str | None) -> SubmittedRun:
    if isinstance(run, str | os.PathLike):
        return read_submitted(Path(run), property)
    return read_run_file(Source("<run>", run_text(RunNames(run.network), run.trace)))


@checked_arguments
def replay(
    model: HasNetwork | str | os.PathLike[str], run: HasRun | str | os.PathLike[str], property: str | None = None
) -> Replay:
    """Executes a run on a model, by the semantics that judges counterexamples.

    Args:
        model: such as `tachk.load` gives it, or the path of one.
        run: a file: a report of `tachk verify --format json`, or what `tachk step` or `tachk simulate` has written; or
            the run of a report, such as ``report.run("mutual_exclusion")``.
        property: of a report with several runs, the one about this property.

    The model is taken as it is loaded: with other constants than the run was made with, it may be none.

    Raises:
        InputError: a line of the file is not understood.
        UsageError: the file cannot be read, or holds no run.
    """
    names = names_of_runs(model)
    replayed = replay_submitted(names, _submitted(run, property))
    rejection = None if replayed.refusal is None else rejection_diagnostic(replayed.refusal)
    return Replay(names, replayed.trace, rejection)
