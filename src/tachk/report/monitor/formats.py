"""The formats of the report of `tachk monitor` about a whole trace, one row each, listed here only.

The module of a format is imported when a report is written in it: the command line names all of them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TextIO

from tachk.base.plugins import load_object

if TYPE_CHECKING:
    from rich.console import Console

    from tachk.recordings.monitors.record import MonitorRecord

MONITOR_FORMATS = {
    "text": "tachk.report.monitor.text:write_text",
    "json": "tachk.report.monitor.json:write_json",
    "jsonl": "tachk.report.monitor.event_lines:write_lines",
    "junit": "tachk.report.monitor.junit:write_junit",
}
"""The function that writes each format. Its arguments are those of `write_monitor` from the second on."""


def write_monitor(
    form: str, record: MonitorRecord, out: TextIO, console: Callable[[TextIO], Console], all_violations: bool
) -> None:
    """Args:
    form: one of `MONITOR_FORMATS`.
    console: makes the console for a stream that people read.
    all_violations: each is reported, not only the first of each formula.
    """
    load_object(MONITOR_FORMATS[form])(record, out, console, all_violations)
