"""What is printed while a trace is judged row by row: nothing, text, one JSON document at the end, or JSON lines."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any, TextIO

from tachk.recordings.monitors.online import Monitor
from tachk.recordings.monitors.online_record import OnlineVerdict, OnlineViolation
from tachk.recordings.traces.node_signal import Truth
from tachk.report.monitor.event_lines import end_event, verdict_event, violation_event
from tachk.report.monitor.online_report import decided_to_text, online_to_json, online_to_text, violation_to_text


class Listener:
    """Prints nothing."""

    def __init__(self, monitor: Monitor, name: str) -> None:
        self._monitor = monitor
        self._name = name

    def hear(self, violations: Iterable[OnlineViolation]) -> None:
        """These have begun or ended."""

    def decided(self, verdict: OnlineVerdict) -> None:
        """This has been decided."""

    def end(self) -> None:
        """No row follows, or none matters."""


class JsonListener(Listener):
    """Prints the whole at the end."""

    def __init__(self, monitor: Monitor, name: str, out: TextIO) -> None:
        super().__init__(monitor, name)
        self._out = out
        self._ended: list[OnlineViolation] | None = [] if monitor.watches_violations else None

    def hear(self, violations: Iterable[OnlineViolation]) -> None:
        if self._ended is not None:
            self._ended += [violation for violation in violations if violation.until is not None]

    def end(self) -> None:
        json.dump(online_to_json(self._monitor.record(self._name, self._ended)), self._out, indent=2)
        self._out.write("\n")


class LineListener(Listener):
    """Prints a line of JSON at each event."""

    def __init__(self, monitor: Monitor, name: str, out: TextIO) -> None:
        super().__init__(monitor, name)
        self._out = out
        self._told: set[str] = set()

    def hear(self, violations: Iterable[OnlineViolation]) -> None:
        self._write(*map(violation_event, violations))

    def decided(self, verdict: OnlineVerdict) -> None:
        self._told.add(verdict.name)
        self._write(verdict_event(verdict))

    def end(self) -> None:
        record = self._monitor.record(self._name)
        self._write(*(verdict_event(verdict) for verdict in record.verdicts if verdict.name not in self._told))
        self._write(end_event(record))

    def _write(self, *events: Mapping[str, Any]) -> None:
        if events:
            self._out.write("".join(json.dumps(event) + "\n" for event in events))
            self._out.flush()


class TextListener(Listener):
    """Prints some lines at each event, and a summary at the end."""

    def __init__(self, monitor: Monitor, name: str, out: TextIO) -> None:
        super().__init__(monitor, name)
        self._out = out
        self._counts: dict[str, int] = {}

    def hear(self, violations: Iterable[OnlineViolation]) -> None:
        for violation in violations:
            if violation.until is None:
                self._counts[violation.name] = self._counts.get(violation.name, 0) + 1
            self._out.write(violation_to_text(violation, self._monitor.unit, self._monitor.dated) + "\n")
        self._out.flush()

    def decided(self, verdict: OnlineVerdict) -> None:
        self._out.write(decided_to_text(verdict, self._monitor.unit, self._monitor.dated) + "\n")
        self._out.flush()

    def end(self) -> None:
        record = self._monitor.record(self._name)
        self._out.write(online_to_text(record))
        if self._monitor.watches_violations:
            for verdict in record.verdicts:
                if verdict.measured is not Truth.TRUE:
                    count = self._counts.get(verdict.name, 0)
                    self._out.write(f"{verdict.name}: {count} {'violation' if count == 1 else 'violations'}\n")
