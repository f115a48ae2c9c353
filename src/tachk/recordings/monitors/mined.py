"""The tightest value of a parameter with which traces satisfy a formula."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

from tachk.recordings.monitors.record import MonitorRecord


@dataclass(frozen=True, slots=True)
class MinedTrace:
    """Attributes:
    value: the tightest value with which this trace alone satisfies the formula; None: there is none in the range.
    attained: whether the value itself does, or only those beyond it.
    """

    trace: str
    value: Fraction | None
    attained: bool


@dataclass(frozen=True, slots=True, eq=False)
class Mined:
    """Attributes:
    name, formula: of the formula; as in a verdict.
    tightest: "least" or "greatest": which of the values that satisfy it is the tightest one; None where it is not known
        that the formula is monotone, so that values were tried one by one.
    value: the tightest value with which all traces satisfy it; None: there is none.
    attained: whether the value itself does, or only those beyond it.
    exact: all values of the range were decided, not only multiples of a step.
    trace: that which forbids tighter values; None: the whole range satisfies the formula.
    violating: a tighter value; ``record`` says how the trace violates the formula with it.
    traces: the tightest value of each.
    undecided: the traces that end too early to decide with this value.
    ranges: where values were tried one by one, those that satisfy it: first and last of each stretch.
    """

    name: str
    formula: str
    parameter: str
    low: Fraction
    high: Fraction
    tightest: str | None
    value: Fraction | None
    attained: bool
    exact: bool
    trace: str | None
    violating: Fraction | None
    record: MonitorRecord | None = field(repr=False)
    traces: tuple[MinedTrace, ...]
    undecided: tuple[str, ...]
    ranges: tuple[tuple[Fraction, Fraction], ...]

    @property
    def satisfiable(self) -> bool:
        """True if some value in the range satisfies the formula on all traces."""
        return self.value is not None or bool(self.ranges)
