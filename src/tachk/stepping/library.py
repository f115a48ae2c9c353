"""Replaying for scripts: `tachk.replay`."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from tachk.diagnostics.diagnostic import Diagnostic
from tachk.model.network import Network
from tachk.report.run.trace_view import Names, Snapshot, TraceView, view_trace
from tachk.runtime.trace import Trace
from tachk.semantics.timed_trace import TimedTrace
from tachk.simulation.columns import columns_for
from tachk.stepping.files import check_determined, read_claims
from tachk.stepping.refusals import refusal_diagnostic
from tachk.stepping.replaying import replay_claims
from tachk.stepping.run_file import run_text
from tachk.stepping.signals import signals_of


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

    names: Names = field(repr=False)
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
    names = Names(model.network)
    replayed = replay_claims(names, read_claims(Path(run), property))
    refusal = None if replayed.refusal is None else refusal_diagnostic(replayed.refusal)
    return Replay(names, replayed.trace, refusal)
