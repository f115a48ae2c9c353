"""Formulas that are false on every continuation of a trace."""

from __future__ import annotations

from tachk.recordings.traces.conventions import Interpolation
from tachk.recordings.traces.core_monitor import columns_read
from tachk.recordings.traces.monitor_program import MonitorProgram
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.online_monitor import OnlineMonitor
from tachk.recordings.traces.trace import Trace


def is_certainly_false(program: MonitorProgram, trace: Trace) -> bool:
    """True if a formula that is false on the trace is false however it goes on."""
    if trace.known_before is None or trace.interpolation is Interpolation.LINEAR:
        return True
    online = OnlineMonitor(program, robustness=False)
    rows = max(1, int(trace.times.searchsorted(trace.known_before)))
    online.push(trace.times[:rows], [values[:rows] for values in columns_read(program, trace)])
    return online.advance(trace.known_before) is Truth.FALSE
