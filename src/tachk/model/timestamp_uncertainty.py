"""How exact the recorded times of events are, apart for inputs and outputs of the system."""

from __future__ import annotations

from fractions import Fraction

from tachk.base.records import dataclass


@dataclass(frozen=True, slots=True)
class TimestampUncertainty:
    """How far the time at which an event was recorded may be from the one at which it happened, in units of the model.

    An output that is recorded at t happened in [t - output_late, t + tolerance], an input that is recorded at t happens
    in [t - tolerance, t + input_late].

    Attributes:
        tolerance: how much earlier or later than recorded something may have happened: how exact the clock is.
        input_late: how much later than it is recorded an input may come to the system.
        output_late: how much later than it happens an output may be recorded.
    """

    tolerance: Fraction
    input_late: Fraction
    output_late: Fraction

    @staticmethod
    def of(tolerance: Fraction, late: Fraction) -> TimestampUncertainty:
        """Inputs and outputs are late by the same."""
        return TimestampUncertainty(tolerance, late, late)

    def around(self, is_output: bool) -> tuple[Fraction, Fraction]:
        """How much earlier, and how much later than it was recorded an event may have happened."""
        return (self.output_late, self.tolerance) if is_output else (self.tolerance, self.input_late)

    @property
    def earliest(self) -> Fraction:
        """How much earlier than it was recorded any event may have happened at most."""
        return max(self.output_late, self.tolerance)

    @property
    def largest(self) -> Fraction:
        """How far the two times may be apart at most."""
        return max(self.tolerance, self.input_late, self.output_late)

    @property
    def width(self) -> Fraction:
        """The length of the longest window that a recorded time leaves open."""
        return self.tolerance + self.late

    @property
    def least_late(self) -> Fraction:
        """The smaller lateness."""
        return min(self.input_late, self.output_late)

    @property
    def late(self) -> Fraction:
        """How late an event may be at most: the larger lateness."""
        return max(self.input_late, self.output_late)


@dataclass(frozen=True, slots=True)
class Allowances:
    """What is said of the uncertainty, by a model or by a caller, in units of the model; None where nothing is said."""

    tolerance: Fraction | None = None
    input_late: Fraction | None = None
    output_late: Fraction | None = None

    def over(self, others: Allowances) -> Allowances:
        """These, and where they say nothing the others."""
        return Allowances(
            others.tolerance if self.tolerance is None else self.tolerance,
            others.input_late if self.input_late is None else self.input_late,
            others.output_late if self.output_late is None else self.output_late,
        )

    def uncertainty(self) -> TimestampUncertainty:
        """The uncertainty. Without a tolerance there is none; a lateness that is not said is as large as it."""
        tolerance = Fraction(0) if self.tolerance is None else self.tolerance
        return TimestampUncertainty(
            tolerance,
            tolerance if self.input_late is None else self.input_late,
            tolerance if self.output_late is None else self.output_late,
        )
