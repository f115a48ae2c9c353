"""The verdicts of some formulas on one trace: the input of every report and plot about it."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

from tachk.model.quantity import decimal
from tachk.recordings.traces.conventions import Interpolation, TraceEnding
from tachk.recordings.traces.logs.dates import date_text
from tachk.recordings.traces.monitor_program import MonitorProgram
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace import Trace
from tachk.recordings.traces.verdict_explanation import Explainer, Finding
from tachk.recordings.traces.violations import Violations, violations_of


@dataclass(frozen=True, slots=True)
class TimeRobustness:
    """By how much time columns may be shifted, each on its own, without a change of the verdict, in units of the trace;
    negative if it is false. Each as an interval over all continuations (docs/logic.md).

    Attributes:
        ahead: changes may come earlier by less than that.
        behind: changes may come later by less than that.
    """

    ahead: tuple[float, float]
    behind: tuple[float, float]


@dataclass(frozen=True, slots=True, eq=False)
class MonitorVerdict:
    """Attributes:
    formula: in canonical form.
    sentence: as written, if it was a sentence.
    measured: what the trace says.
    truth: what counts, with the meaning that was given to the end of the trace.
    presumably: what an undetermined formula becomes if all values stay as they are at the end; None if it stays
        undetermined, or is determined.
    robustness: how far the trace is from changing the verdict, as an interval over all continuations; None if it was
        not requested.
    time_robustness: None if it was not requested.
    vacuous: it demands something whenever a trigger is true, and the trigger never is.
    explainer: for explanations and plots; it reads the trace on demand.
    """

    name: str
    title: str
    formula: str
    sentence: str
    measured: Truth
    truth: Truth
    presumably: Truth | None
    robustness: tuple[float, float] | None
    vacuous: bool
    program: MonitorProgram = field(repr=False)
    explainer: Explainer = field(repr=False)
    time_robustness: TimeRobustness | None = None

    @property
    def finding(self) -> Finding | None:
        """The first violation, or the position at which the verdict stays open; None if the formula is true.

        It is searched on first use, which reads the trace again. Raises UsageError if a program has
        changed the arrays of the trace meanwhile, so that they no longer have this verdict.
        """
        return self.explainer.finding(self.measured)

    @property
    def violations(self) -> Violations:
        """All violations, and the number of triggers without response. They are searched at each call."""
        return violations_of(self.explainer)

    def __repr__(self) -> str:
        return f"<MonitorVerdict {self.name}: {self.truth.word}, {self.formula}>"


@dataclass(frozen=True, slots=True, eq=False)
class MonitorRecord:
    """Attributes:
    formulas: where they come from: a path, or empty.
    verdicts: one for each formula, in order.
    """

    trace: Trace = field(repr=False)
    formulas: str
    verdicts: tuple[MonitorVerdict, ...]
    ending: TraceEnding = TraceEnding.UNDETERMINED


def clock_text(trace: Trace, tick: int | Fraction) -> str:
    """The time on the clock of the recording at a tick: ``12.5 s``, or a date. Crossings of lines to six decimals."""
    clock = trace.clock(tick)
    return time_text(round(clock, 6) if trace.interpolation is Interpolation.LINEAR else clock, trace.unit, trace.dated)


def time_text(clock: Fraction, unit: str, dated: bool) -> str:
    """A time with its unit, or as a date."""
    if dated:
        return date_text(clock)
    number = decimal(clock, 18)
    return f"{number} {unit}" if unit else number


def cell_time(cell: int) -> Fraction:
    """The instant of a cell in ticks, of an interval between two ticks its middle."""
    return Fraction(cell, 2)


def cell_text(trace: Trace, cell: int) -> str:
    """The time of a cell: ``12.5 s``, or ``just after 12.5 s`` for the interval that begins there.

    In a capture with the packet that was there: ``12.5 s (packet 7)``.
    """
    text, packet = clock_text(trace, cell // 2), trace.packet(cell // 2)
    text += "" if packet is None else f" (packet {packet})"
    return text if cell % 2 == 0 else f"just after {text}"


def value_text(trace: Trace, column: str, cell: int) -> str:
    """The value of a column in a cell, beyond the end the last one: a number by the name that its file has for it."""
    value = trace.value(column, Fraction(cell // 2))
    if column in trace.texts:
        return f'"{trace.labels[int(value)]}"'
    if value.is_integer() and (name := trace.value_names.get(column, {}).get(int(value))) is not None:
        return name
    if trace.columns[column].dtype.kind == "u":
        return "true" if value else "false"
    return f"{value:.6g}"
