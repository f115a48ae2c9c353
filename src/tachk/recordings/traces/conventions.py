"""Conventions for values between two rows and after the last one. Imports nothing heavy."""

from __future__ import annotations

from enum import StrEnum


class Interpolation(StrEnum):
    """What columns of numbers do between two rows: they keep their values, or move in straight lines. Truth values
    always keep theirs, and after the last row everything does."""

    CONSTANT = "constant"
    LINEAR = "linear"


class TraceEnding(StrEnum):
    """The value of a formula that the end of the trace leaves undetermined.

    WEAK: what is still pending counts as satisfied; STRONG: as violated.
    """

    UNDETERMINED = "undetermined"
    WEAK = "weak"
    STRONG = "strong"
