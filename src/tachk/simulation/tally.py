"""What is counted over runs while they are drawn."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from tachk.base.job import StoppedError
from tachk.engine.outcome import INTERRUPTED
from tachk.engine.simulation.simulator import (
    RecordedChanges,
    RecordedRows,
    Simulated,
    SimulationEnding,
    SimulationOptions,
)
from tachk.recordings.traces.node_signal import Truth
from tachk.simulation.intervals import clopper_pearson
from tachk.simulation.runs import Runs
from tachk.simulation.tables import decimal_time

if TYPE_CHECKING:
    from tachk.recordings.monitors.formulas import NamedFormula
    from tachk.simulation.fault_injection import FaultedNetwork

WriteRun = Callable[[Simulated, Runs], None]


@dataclass(slots=True)
class Tally:
    """Counts over the runs that were drawn.

    Attributes:
        endings: how many runs end so.
        examples: the first run of each ending, and when it ends.
        truths: for each formula how many runs have each verdict.
        violating: for each formula the runs on which it is false.
        done, missed: how often each ordered fault happened, and how often the model did not allow it.
        stopped: why not all runs were drawn; empty if they were.
        written: how many runs are in a file.
    """

    transitions: int = 0
    endings: Counter[SimulationEnding] = field(default_factory=Counter)
    examples: dict[SimulationEnding, tuple[int, str]] = field(default_factory=dict)
    faults: list[str] = field(default_factory=list)
    truths: dict[str, Counter[Truth]] = field(default_factory=dict)
    violating: dict[str, list[int]] = field(default_factory=dict)
    done: Counter[str] = field(default_factory=Counter)
    missed: Counter[str] = field(default_factory=Counter)
    stopped: str = ""
    written: int = 0

    @property
    def runs(self) -> int:
        return self.endings.total()

    def add(self, run: Simulated) -> None:
        # First the example, or Ctrl-C in between leaves an ending that has none.
        if run.ending not in self.examples:
            self.examples[run.ending] = run.number, decimal_time(run.end, run.ticks_per_unit)
        self.transitions += run.transitions
        self.endings[run.ending] += 1
        if run.fault is not None and not self.faults:
            kind, span = run.fault
            self.faults.append(f"{span}: {kind.name.lower().replace('_', ' ')}")

    def count(self, name: str, number: int, truth: Truth) -> None:
        self.truths.setdefault(name, Counter())[truth] += 1
        if truth is Truth.FALSE:
            self.violating.setdefault(name, []).append(number)

    def probability_of_violation(self, name: str, confidence: float) -> tuple[float, float]:
        """The interval of the probability that a run violates a formula; those that are undetermined may."""
        counts = self.truths[name]
        return clopper_pearson(counts[Truth.FALSE], counts.total(), confidence, maybe=counts[Truth.UNDETERMINED])


EvaluatedRun = tuple[Simulated, Mapping[str, Truth]]
"""A run, and the verdicts of formulas on it."""


def drawn_runs(
    runs: Runs,
    formulas: tuple[NamedFormula, ...],
    drawing: SimulationOptions,
    numbers: range,
    recorded: RecordedChanges,
    *,
    all_rows: bool,
) -> Iterator[EvaluatedRun]:
    """The runs of these numbers, in order. Raises StoppedError between them.

    Args:
        recorded: of all runs without formulas; with them of those on which one is false, and of others the last row.
        all_rows: of other runs, too.
    """
    if not formulas:
        yield from ((run, {}) for run in runs.draw(drawing, numbers, recorded))
        return
    from tachk.simulation.monitored import evaluated  # monitors, where there is a formula

    yield from evaluated(
        runs, formulas, drawing, numbers, recorded, RecordedRows.ALL if all_rows else RecordedRows.VIOLATING
    )


def take_until_stopped(drawn: Iterator[EvaluatedRun], take: Callable[[EvaluatedRun], None], tally: Tally) -> None:
    """Takes the runs. Where a limit or the user ends that, the tally says so."""
    try:
        for run in drawn:
            take(run)
    except StoppedError as error:
        tally.stopped = error.reason
    except KeyboardInterrupt:
        tally.stopped = INTERRUPTED


def take_run(
    runs: Runs,
    wanted: FaultedNetwork,
    tally: Tally,
    write: WriteRun | None,
    all_runs: bool,
    evaluated: EvaluatedRun,
) -> None:
    """Writes and counts a run; it does not count if a limit or the user ends that.

    Args:
        write: writes a run; None where no file is wanted.
        all_runs: those on which no formula is false are written, too.
    """
    run, truths = evaluated
    counts = runs.counts(run) if wanted.done or wanted.missed else []
    if write is not None and len(run.times) and (all_runs or not truths or Truth.FALSE in truths.values()):
        write(run, runs)
        tally.written += 1
    for name, truth in truths.items():
        tally.count(name, run.number, truth)
    if counts:
        counted = iter(counts)
        tally.done.update(dict(zip(wanted.done, counted, strict=False)))
        tally.missed.update(dict(zip(wanted.missed, counted, strict=False)))
    tally.add(run)
