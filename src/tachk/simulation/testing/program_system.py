"""Programs as systems under test: they read inputs from stdin and write outputs to stdout, as JSON lines.

`RealTimeProgram` runs by the clock of the wall. `DrivenProgram` has a clock of its own that the test moves on, so that
a test of hours takes seconds, and is the same each time.
"""

from __future__ import annotations

import os
import select
import shlex
import subprocess
import threading
import time
from collections import deque
from collections.abc import Mapping, Sequence
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.conformance.events import Cell
from tachk.simulation.testing.event_lines import EVENT, READY, event_line, read_line, until_line
from tachk.simulation.testing.system_adapter import SeenOutput, SystemEndedError

_SECONDS_TO_START = 30.0
_SECONDS_TO_ANSWER = 30.0
_SECONDS_TO_READ = 2.0
_SECONDS_TO_END = 2.0
_SECONDS_AT_ONCE = 0.1
_LONGEST_LINE = 1 << 20
"""Bytes; what follows is another line."""


def command_of(text: str) -> list[str]:
    """The words of a command line. Raises UsageError for an empty one or an open quote."""
    try:
        words = shlex.split(text)
    except ValueError as error:
        raise UsageError(f"the command `{text}` cannot be read: {error}") from None
    if not words:
        raise UsageError("there is no command", "write the program and its arguments, such as ./thermostat")
    return words


class _StreamedProgram:
    """A process with pipes."""

    def __init__(self, command: Sequence[str]) -> None:
        self.command = command
        self.process: subprocess.Popen[bytes] | None = None

    def spawn(self) -> subprocess.Popen[bytes]:
        try:
            self.process = subprocess.Popen(self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        except OSError as error:
            raise UsageError(f"{self.command[0]} cannot be started: {error.strerror}") from None
        return self.process

    def write(self, line: str) -> None:
        """Raises SystemEndedError, also where the pipe is full and stays so."""
        assert self.process is not None and self.process.stdin is not None
        pipe, rest = self.process.stdin.fileno(), line.encode()
        try:
            while rest:
                if not select.select([], [pipe], [], _SECONDS_TO_READ)[1]:
                    raise SystemEndedError(f"{self.command[0]} does not read its inputs")
                rest = rest[os.write(pipe, rest[: select.PIPE_BUF]) :]
        except BrokenPipeError:
            raise self.ended() from None

    def ended(self) -> SystemEndedError:
        assert self.process is not None
        try:
            status = self.process.wait(_SECONDS_TO_END)
        except subprocess.TimeoutExpired:
            return SystemEndedError(f"{self.command[0]} has closed its standard streams")
        how = f"with status {status}" if status >= 0 else f"by signal {-status}"
        return SystemEndedError(f"{self.command[0]} has ended {how}")

    def end(self, seconds: float, reader: threading.Thread | None = None) -> None:
        """Ends the process, which has so many seconds to end by itself, and the thread that reads from it."""
        process = self.process
        if process is None:
            return
        assert process.stdin is not None and process.stdout is not None
        try:
            process.stdin.close()
            process.wait(seconds)
        except subprocess.TimeoutExpired:
            pass
        finally:  # also where the user interrupts the wait
            process.kill()
            process.wait()
        if reader is None:
            process.stdout.close()
        else:  # which closes the pipe; a process that is left behind may hold the other end for long
            reader.join(_SECONDS_AT_ONCE)

    def not_ready(self) -> UsageError:
        return UsageError(
            f'{self.command[0]} did not write {{"event": "{READY}"}} when it started',
            "let the program write this line, and flush it, when it is ready for inputs: the model starts then",
        )


class RealTimeProgram:
    """A program that runs by the clock of the wall. Its first line is ``{"event": "ready"}``: the model starts then."""

    def __init__(self, command: Sequence[str], nanoseconds: Fraction) -> None:
        """Args: nanoseconds: of a unit of the model."""
        self._program = _StreamedProgram(command)
        self._nanoseconds = nanoseconds
        self._begun = 0
        self._seen: deque[tuple[int, bytes]] = deque()
        self._over = False
        self._change = threading.Condition()
        self._reader: threading.Thread | None = None

    def start(self) -> None:
        process = self._program.spawn()
        self._reader = threading.Thread(target=self._read, args=(process,), daemon=True)
        self._reader.start()
        with self._change:
            self._change.wait_for(lambda: self._seen or self._over, _SECONDS_TO_START)
            first = self._seen.popleft() if self._seen else None
        if first is None or read_line(first[1])[0] != READY:
            raise self._program.not_ready()
        self._begun = first[0]

    def _read(self, process: subprocess.Popen[bytes]) -> None:
        assert process.stdout is not None
        with process.stdout as stdout:
            while line := stdout.readline(_LONGEST_LINE):
                with self._change:
                    self._seen.append((time.monotonic_ns(), line))
                    self._change.notify()
        with self._change:
            self._over = True
            self._change.notify()

    def time(self) -> Fraction:
        return self._units(time.monotonic_ns())

    def _units(self, moment: int) -> Fraction:
        return (moment - self._begun) / self._nanoseconds

    def send(self, name: str, cells: Mapping[str, Cell]) -> Fraction:
        sent = time.monotonic_ns()
        self._program.write(event_line(name, cells))
        return self._units(sent)

    def next_output(self, until: Fraction) -> SeenOutput | None:
        last = self._begun + int(until * self._nanoseconds)
        with self._change:
            while not self._seen:
                if self._over:
                    raise self._program.ended()
                left = last - time.monotonic_ns()
                if left <= 0:
                    return None  # what is read from now on is later
                self._change.wait(left / 1e9)
            moment, line = self._seen.popleft()
        name, cells, _ = read_line(line)
        if name is None:
            raise UsageError(
                f"a line of the program has no `{EVENT}`: {line.decode('utf-8', 'replace').strip()}",
                "a program that answers with times has a clock that is driven: --adapter driven:COMMAND",
            )
        return SeenOutput(self._units(moment), name, cells)

    def close(self) -> None:
        self._program.end(_SECONDS_TO_END, self._reader)

    def abandon(self) -> None:
        self._program.end(_SECONDS_AT_ONCE, self._reader)


class DrivenProgram:
    """A program whose clock the test moves on.

    To ``{"until": T}`` it answers with its first output until then, ``{"time": t, "event": ...}``, where its clock
    stays, or with ``{"time": T}``. Inputs have a time, too, at which its clock is already; it does not answer them.
    """

    def __init__(self, command: Sequence[str]) -> None:
        self._program = _StreamedProgram(command)
        self._now = Fraction(0)
        self._read = b""

    def start(self) -> None:
        self._program.spawn()
        line = self._line()
        if not line or read_line(line)[0] != READY:
            raise self._program.not_ready()

    def _line(self) -> bytes:
        process = self._program.process
        assert process is not None and process.stdout is not None
        pipe = process.stdout.fileno()
        while b"\n" not in self._read and len(self._read) < _LONGEST_LINE:
            if not select.select([pipe], [], [], _SECONDS_TO_ANSWER)[0]:
                raise SystemEndedError(f"{self._program.command[0]} gives no answer for {_SECONDS_TO_ANSWER:g} s")
            block = os.read(pipe, 1 << 16)
            if not block:
                break
            self._read += block
        line, end, self._read = self._read.partition(b"\n")
        return line + end

    def time(self) -> Fraction:
        return self._now

    def send(self, name: str, cells: Mapping[str, Cell]) -> Fraction:
        self._program.write(event_line(name, cells, self._now))
        return self._now

    def next_output(self, until: Fraction) -> SeenOutput | None:
        self._program.write(until_line(until))
        line = self._line()
        if not line:
            raise self._program.ended()
        name, cells, moment = read_line(line)
        if moment is None or not self._now <= moment <= until:
            raise UsageError(
                f"the program answers {line.decode('utf-8', 'replace').strip()}, which has no `time` from "
                f"{float(self._now):g} to {float(until):g}",
                'answer {"until": T} with the first event until then and its time, or with {"time": T}',
            )
        self._now = moment if name is not None else until
        return None if name is None else SeenOutput(moment, name, cells)

    def close(self) -> None:
        self._program.end(_SECONDS_TO_END)

    def abandon(self) -> None:
        self._program.end(_SECONDS_AT_ONCE)
