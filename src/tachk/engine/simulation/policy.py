"""The policies by which processes choose moments. Imports nothing heavy."""

from __future__ import annotations

from enum import StrEnum

SCRIPT = "script"
"""The name in place of a policy for a file with all decisions: nothing is drawn."""


class Policy(StrEnum):
    """The distribution of the delay of a process before it acts, within its guards and its invariant."""

    STOCHASTIC = "stochastic"
    """UPPAAL's: uniformly up to the end of its invariant, else by the exponential distribution of its location."""
    UNIFORM = "uniform"
    """Uniformly while its guards hold, else exponentially; weights do not count."""
    EARLIEST = "earliest"
    LATEST = "latest"
    """The earliest moment where there is no latest one."""
    BOUNDARY = "boundary"
    """One of four each time: the earliest moment, the latest one, a whole number of units after the earliest, and as
    UNIFORM; weights do not count."""
