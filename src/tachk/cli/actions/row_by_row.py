"""The options of monitoring row by row."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RowByRow:
    """Whether and how rows are judged one by one.

    Attributes:
        online: though the trace is a file.
        follow: wait for more rows at the end of the file.
        decimals: of times and bounds; None: as many as make nanoseconds, at most 9.
    """

    online: bool = False
    follow: bool = False
    decimals: int | None = None
