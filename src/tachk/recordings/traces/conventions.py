"""Conventions for values between two rows and after the last one. Imports nothing heavy."""

from __future__ import annotations

from enum import StrEnum


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
