"""An adapter of a Python program for `tachk test --adapter process:COMMAND`: events as lines of JSON.

Copy this file beside your program.

    adapter = Adapter()                       # the program is ready, the model starts
    adapter.output("heater", on=1)            # an output with its columns, at once
    event = adapter.input(0.5)                # waits so many seconds for an input; None: for ever
    if event is None: ...                     # none came
    event["event"], event.get("cold")         # its name and its columns

`input` raises EOFError where the test is over. Nothing else may read stdin or write to stdout.
"""

from __future__ import annotations

import json
import os
import select
import sys
import time


class Adapter:
    """The standard streams as a place of events."""

    def __init__(self) -> None:
        self._text = b""
        self.output("ready")

    def output(self, event: str, **columns: int | bool | str) -> None:
        """Says that an output happens now."""
        sys.stdout.write(json.dumps({"event": event, **columns}) + "\n")
        sys.stdout.flush()

    def input(self, seconds: float | None = None) -> dict[str, int | bool | str] | None:
        """The next input; None if none comes in this time. Raises EOFError where the test is over."""
        last = None if seconds is None else time.monotonic() + seconds
        while b"\n" not in self._text:
            left = None if last is None else max(last - time.monotonic(), 0.0)
            if not select.select([0], [], [], left)[0]:
                return None
            more = os.read(0, 4096)
            if not more:
                raise EOFError("the test is over")
            self._text += more
        line, self._text = self._text.split(b"\n", 1)
        return json.loads(line)
