"""The options of monitoring row by row."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RowByRow:
    """Options for evaluating formulas row by row.

    Attributes:
        online: row by row although the trace is a file.
        follow: wait for more rows at the end of the file.
        live: the trace is a capture of packets that is being made.
        fail_fast: stop at the first verdict that is false.
    """

    online: bool = False
    follow: bool = False
    live: bool = False
    fail_fast: bool = False
