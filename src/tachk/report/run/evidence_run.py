"""The run behind an answer as an object that scripts and notebooks show."""

from __future__ import annotations

from dataclasses import dataclass, field
from html import escape
from typing import Any

from tachk.base.frames import data_frame
from tachk.base.notebook import preformatted
from tachk.meaning.run_view import Snapshot, TraceView, ViewStep, rows_of_run, view_trace
from tachk.model.network import Network
from tachk.model.run import TimedTrace
from tachk.report.run.display import RunDisplay
from tachk.report.text_report import evidence_text
from tachk.verify.verdict import Verdict


@dataclass(frozen=True, slots=True)
class Run:
    """A run by the names of its model: ``print(run)`` shows it as `tachk verify` does, a notebook shows it.

    Attributes:
        verdict: the answer that the run is about.
    """

    network: Network = field(repr=False)
    verdict: Verdict

    @property
    def trace(self) -> TimedTrace:
        """The run in numbers."""
        assert self.verdict.trace is not None
        return self.verdict.trace

    @property
    def view(self) -> TraceView:
        """The run as reports show it: steps and states with their names."""
        return view_trace(self.network, self.trace)

    @property
    def steps(self) -> tuple[ViewStep, ...]:
        """The steps, each with the state behind it."""
        return self.view.steps

    @property
    def states(self) -> tuple[Snapshot, ...]:
        """The initial state, and the one after each step: locations, variables, clocks and time by name."""
        view = self.view
        return (view.initial, *(step.state for step in view.steps))

    def to_text(self, clocks: bool = False, every_step: bool = False) -> str:
        """The run step by step.

        Args:
            clocks: print the value of every clock after each step.
            every_step: print also repeated rounds step by step, and the steps that the model hides.
        """
        return evidence_text(self.network, self.verdict, RunDisplay(clocks, every_step))

    def to_rows(self) -> list[dict[str, Any]]:
        """A row for the start and for each step: its time, what happens, the locations, the variables and the clocks
        after it. Times and clocks are floating-point numbers here."""
        return rows_of_run(self.view)

    def to_frame(self) -> Any:
        """`to_rows` as a `pandas.DataFrame`. Raises UsageError where pandas is not installed."""
        return data_frame(self.to_rows())

    def __len__(self) -> int:
        return len(self.trace.steps)

    def __str__(self) -> str:
        return self.to_text()

    def __repr__(self) -> str:
        plural = "step" if len(self) == 1 else "steps"
        return f"<Run of {len(self)} {plural} about {self.verdict.query.name}>"

    def _repr_html_(self) -> str:
        title, _, text = self.to_text().partition("\n")
        return f"<p><b>{escape(title)}</b></p>\n{preformatted(text)}"
