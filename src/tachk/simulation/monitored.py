"""Formulas that the core evaluates on runs while it draws them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import check_job
from tachk.base.records import dataclass
from tachk.engine.simulation.simulator import (
    MonitoredFormula,
    RecordedChanges,
    RecordedRows,
    Simulated,
    SimulationOptions,
)
from tachk.recordings.monitors.conditions import condition_columns
from tachk.recordings.monitors.formulas import NamedFormula
from tachk.recordings.monitors.offline import prepare, resolved_on
from tachk.recordings.traces.monitor_program import MonitorProgram
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace import LARGEST_TICK, Trace
from tachk.recordings.traces.trace_files import open_trace
from tachk.simulation.formulas import truths_on, with_conditions
from tachk.simulation.runs import Runs, recording

_BATCH = 256
"""The number of runs that are drawn between two checks of the limit on time."""
_TRUTHS = tuple(Truth)


@dataclass(frozen=True, slots=True)
class ObservedColumn:
    """Attributes:
    number: among the observed values of a state.
    floating: these are the bits of floating point numbers.
    """

    number: int
    floating: bool = False


def monitored_formula(
    program: MonitorProgram, columns: Sequence[ObservedColumn], drawing: SimulationOptions
) -> MonitoredFormula:
    """A formula on runs that are drawn, whose ticks are whole in each tick of the runs.

    Args:
        columns: of the program, in its order.

    Raises UsageError for runs that are too long to be counted so finely.
    """
    factor = Fraction(program.ticks_per_unit, drawing.ticks_per_unit)
    assert factor.denominator == 1
    if drawing.until * factor > LARGEST_TICK:
        raise UsageError(
            f"runs are too long to be counted in {program.ticks_per_unit} ticks per unit of time",
            "bounds with fewer decimals, or shorter runs, can be counted",
        )
    return MonitoredFormula(program, [(each.number, each.floating, []) for each in columns], int(factor))


def evaluated(
    runs: Runs,
    formulas: tuple[NamedFormula, ...],
    drawing: SimulationOptions,
    numbers: range,
    recorded: RecordedChanges,
    rows: RecordedRows,
) -> Iterator[tuple[Simulated, Mapping[str, Truth]]]:
    """Runs, and the verdict of each formula on them; none on a run without a state. Raises StoppedError between them.

    Args:
        rows: the runs of which all rows stay; of others the last row does.

    Raises InputError for formulas that have no meaning on the runs.
    """
    if (in_core := _in_core(runs, formulas, drawing)) is None:
        for run in runs.draw(drawing, numbers, recorded):
            yield run, truths_on(runs.trace(run), formulas) if len(run.times) else {}
        return
    for first in range(numbers.start, numbers.stop, _BATCH):
        check_job()
        batch = range(first, min(first + _BATCH, numbers.stop))
        drawn = runs.simulator.monitored(drawing, batch, in_core, rows, recorded.actions)
        truths = [drawn.truths(number).tolist() for number in range(len(formulas))]
        for place, number in enumerate(batch):
            run = runs.simulator.simulated(number, drawing.ticks_per_unit, drawn.record(place), recorded)
            found = {each.name: _TRUTHS[its[place]] for each, its in zip(formulas, truths, strict=True)}
            yield run, found if len(run.times) else {}


def _in_core(
    runs: Runs, formulas: tuple[NamedFormula, ...], drawing: SimulationOptions
) -> list[MonitoredFormula] | None:
    """The formulas as the core evaluates them on runs; None if only a recorded trace tells what they mean."""
    # Whatever the values are, the columns and the times of all runs are like these.
    known = [[0] * len(runs.columns)] * 2
    longest = recording(
        runs.network, runs.columns, "a run", (0, drawing.until), known, drawing.until, drawing.ticks_per_unit, True
    )
    source = open_trace(longest)
    try:
        trace, programs = prepare(resolved_on(with_conditions(formulas, source), source), source)
    except UsageError:
        return None  # the longest run may be too long for a formula, and those that are drawn end sooner
    factor = Fraction(trace.end, drawing.until)
    columns = _columns_of(runs, longest)
    for program in programs:
        texts = trace.texts.intersection(program.columns)
        read_anew = texts != longest.texts.intersection(program.columns) or (texts and trace.labels != longest.labels)
        numbers = [name for name in condition_columns(program) if trace.columns[name].dtype.kind != "u"]
        if read_anew or numbers or factor.denominator != 1 or not columns.keys() >= {*program.columns}:
            return None
    return [MonitoredFormula(program, [columns[name] for name in program.columns], int(factor)) for program in programs]


def _columns_of(runs: Runs, trace: Trace) -> dict[str, tuple[int, bool, list[float]]]:
    places = {label: float(place) for place, label in enumerate(trace.labels)}
    return {
        column.name: (number, column.floating, [places[label] for label in column.labels])
        for number, column in enumerate(runs.columns)
    }
