"""Simulation and replaying for scripts: `tachk.simulate`, `tachk.replay`."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from tachk.base.arguments import checked_arguments
from tachk.base.diagnostics.diagnostic import Diagnostic, UsageError
from tachk.engine.simulation.policy import Policy
from tachk.engine.simulation.simulator import SimulationOptions
from tachk.formats.loading.load import load_model
from tachk.meaning.run_view import RunNames, Snapshot, TraceView, view_trace
from tachk.model.network import Network
from tachk.model.run import TimedTrace
from tachk.recordings.traces.trace import Trace
from tachk.simulation.columns import columns_for
from tachk.simulation.library import Simulation, drawn_runs
from tachk.simulation.stepping.files import check_determined, read_claims
from tachk.simulation.stepping.refusals import refusal_diagnostic
from tachk.simulation.stepping.replaying import replay_claims
from tachk.simulation.stepping.run_file import run_text
from tachk.simulation.stepping.signals import signals_of
from tachk.simulation.times import horizon_of


class HasNetwork(Protocol):
    """Such as `tachk.Model`."""

    @property
    def network(self) -> Network: ...


@dataclass(frozen=True, slots=True)
class Replay:
    """What came of a run that was executed on a model. It is true if all of it is a run.

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
        """How many steps were taken."""
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
        """What can be observed of the run, for `tachk.monitor`: signals, locations and variables, or the named ones."""
        columns = columns_for(self.names.network, tuple(record), ())
        return signals_of(self.names, columns, self.trace, "the run").trace

    def to_text(self) -> str:
        """The run as `tachk step` saves it."""
        return run_text(self.names, self.trace)


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
    end = horizon_of(str(until), network.time_unit, "until")
    drawing = SimulationOptions(seed, end.ticks, Policy(policy), max_steps, threads, end.ticks_per_unit)
    orders = [fault] if isinstance(fault, str) else list(fault)
    return drawn_runs(network, drawing, range(first, first + runs), tuple(record), orders)


@checked_arguments
def replay(model: HasNetwork, run: str | os.PathLike[str], property: str | None = None) -> Replay:
    """Executes a run on a model, by the semantics that judges counterexamples.

    Args:
        run: a file: a report of `tachk verify --format json`, or a run as `tachk step` and `tachk simulate` write it.
        property: of a report with several runs, the one about this property.

    The model is taken as it is loaded: with other constants than the run was made with, it may be none.

    Raises:
        InputError: a line of the file is not understood.
        UsageError: the file cannot be read, or holds no run.
    """
    check_determined(model.network)
    names = RunNames(model.network)
    replayed = replay_claims(names, read_claims(Path(run), property))
    refusal = None if replayed.refusal is None else refusal_diagnostic(replayed.refusal)
    return Replay(names, replayed.trace, refusal)
