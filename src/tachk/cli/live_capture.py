"""`tachk monitor --live`: a capture that is being made."""

from __future__ import annotations

import sys
import time
from pathlib import Path

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.monitors.formulas import NamedFormula
from tachk.xrce.traces.arriving import GrowingFile, Pipe
from tachk.xrce.traces.live import LivePackets, needs_hindsight


def open_live(trace: str, ports: tuple[int, ...]) -> LivePackets:
    """A capture on standard input, or a file that grows. Raises UsageError."""
    if trace == "-":
        return LivePackets(trace, Pipe(sys.stdin.fileno()), ports, time.monotonic_ns)
    path = Path(trace)
    if not path.is_file():
        raise UsageError(f"there is no file {path}")
    return LivePackets(trace, GrowingFile(path), ports, time.monotonic_ns)


def without_hindsight(formulas: tuple[NamedFormula, ...], are_chosen: bool) -> tuple[NamedFormula, ...]:
    """The formulas that can be judged while a capture is made; says which cannot.

    Args:
        are_chosen: somebody has asked for these formulas by their names; then all stay.
    """
    if are_chosen:
        return formulas
    late = [one.name for one in formulas if needs_hindsight(one.columns)]
    if late and len(late) < len(formulas):
        print(f"left out, for they are known only when the capture is over: {', '.join(late)}", file=sys.stderr)
        return tuple(one for one in formulas if one.name not in late)
    return formulas
