"""What moments of a recording and its events are called."""

from __future__ import annotations

from fractions import Fraction

from tachk.conformance.conform import Conformance
from tachk.conformance.events import Event


def moment(found: Conformance, units: int | Fraction) -> str:
    """A time of the model as a time of the recording."""
    time = Fraction(units) / found.queues.scale + found.queues.origin
    return f"{float(time):.6f}".rstrip("0").rstrip(".")


def event_text(event: Event) -> str:
    """``light(on=1, level=7)``"""
    cells = ", ".join(f"{name}={value}" for name, value in event.cells.items() if value != "")
    return f"{event.name}({cells})"
