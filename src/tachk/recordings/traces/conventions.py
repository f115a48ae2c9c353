"""Conventions for values between two rows and after the last one. Imports nothing heavy."""

from __future__ import annotations

from enum import StrEnum

from tachk.base.records import dataclass


class Interpolation(StrEnum):
    """The values of columns of numbers between two rows: they are kept, or move in straight lines. Truth values are
    always kept, and so is everything after the last row."""

    CONSTANT = "constant"
    LINEAR = "linear"


class TraceEnding(StrEnum):
    """The value of a formula that the end of the trace leaves undetermined.

    WEAK: what is still pending counts as satisfied; STRONG: as violated.
    """

    UNDETERMINED = "undetermined"
    WEAK = "weak"
    STRONG = "strong"


@dataclass(frozen=True, slots=True)
class EvaluationOptions:
    """Options of the evaluation of formulas on a trace.

    Attributes:
        ending: the verdict where the trace ends too early to decide.
        interpolation: the values of numbers between rows.
        robustness: compute by how much values could change before the verdict does.
        time_robustness: compute by how much time signals could be shifted.
    """

    ending: TraceEnding = TraceEnding.UNDETERMINED
    interpolation: Interpolation = Interpolation.CONSTANT
    robustness: bool = True
    time_robustness: bool = False
