"""The verdicts so far on a trace that is evaluated as it comes."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

from tachk.recordings.monitors.record import MonitorRecord
from tachk.recordings.traces.conventions import TraceEnding
from tachk.recordings.traces.node_signal import Truth


@dataclass(frozen=True, slots=True, eq=False)
class OnlineVerdict:
    """The verdict on one formula, on what has come of a growing trace.

    Attributes:
        formula: in canonical form.
        sentence: as written, if it was a sentence.
        measured: what has been seen says.
        truth: the same; after the end, with the meaning that was given to it.
        decided_at: what the clock showed when the verdict was decided; None before.
        violated: the earliest known stretch in which what must always hold does not: from, until.
        robustness: bounds for all continuations; None if it was not requested.
        story: the violation explained on the rows that were kept; None for other verdicts, and where too few were kept.
    """

    name: str
    title: str
    formula: str
    sentence: str
    measured: Truth
    truth: Truth
    decided_at: Fraction | None
    violated: tuple[Fraction, Fraction] | None
    robustness: tuple[float, float] | None
    story: MonitorRecord | None = field(default=None, repr=False)


@dataclass(frozen=True, slots=True)
class OnlineViolation:
    """A violation on a trace that grows; instants as the clock of the trace shows them, between two ticks the middle.

    Attributes:
        name: of the formula.
        violated: what has to be true, such as ``p -> q`` in ``G (p -> q)``.
        since: from when on it is not.
        until: when it is again, or the trace has ended; None: it goes on.
    """

    name: str
    violated: str
    since: Fraction
    until: Fraction | None


@dataclass(frozen=True, slots=True, eq=False)
class OnlineRecord:
    """Everything that a monitor has found on a growing trace so far.

    Attributes:
        begin, end: what the clock showed at the first row and shows now.
        violations: those that have ended; None if they were not requested.
        dated: times are seconds since 1970, and were dates.
        notes: what the reader of the trace has to say, such as that times are rounded.
    """

    trace: str
    rows: int
    begin: Fraction
    end: Fraction
    unit: str
    ending: TraceEnding
    verdicts: tuple[OnlineVerdict, ...]
    violations: tuple[OnlineViolation, ...] | None = None
    dated: bool = False
    notes: tuple[str, ...] = ()
