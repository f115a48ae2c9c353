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
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from glob import glob
from pathlib import Path

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.conformance.events import Cell
from tachk.simulation.testing.arrivals import Arrival, Arrivals
from tachk.simulation.testing.event_lines import READY, event_line, line_output, number, read_line, until_line
from tachk.simulation.testing.real_time import RealTimeSystem
from tachk.simulation.testing.system_adapter import SeenOutput, SystemEndedError

_SECONDS_TO_START = 30
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


class StreamedProgram:
    """A process with pipes."""

    def __init__(self, command: Sequence[str]) -> None:
        self.command = command
        self.process: subprocess.Popen[bytes] | None = None
        self._reader: threading.Thread | None = None
        self._waited = 0

    def spawn(self) -> None:
        """Raises UsageError where it cannot be started."""
        try:
            self.process = subprocess.Popen(self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        except OSError as error:
            raise UsageError(f"{self.command[0]} cannot be started: {error.strerror}") from None

    def read_into(self, arrivals: Arrivals, source: str = "") -> None:
        """Lets a thread read the lines that the program writes, until it ends."""
        self._reader = threading.Thread(target=self._read, args=(arrivals, source), daemon=True)
        self._reader.start()

    def _read(self, arrivals: Arrivals, source: str) -> None:
        assert self.process is not None and self.process.stdout is not None
        with self.process.stdout as stdout:
            while line := stdout.readline(_LONGEST_LINE):
                arrivals.put(time.monotonic_ns(), line, source)
        arrivals.end()

    def is_over(self, arrivals: Arrivals) -> bool:
        """Whether the process has ended although something that it has started holds its stdout open."""
        assert self.process is not None
        if self.process.poll() is None or self._reader is None:
            return False
        self._reader.join(_SECONDS_AT_ONCE)  # so that all that it has written is read
        return arrivals.is_empty

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

    def waited(self) -> int:
        """Nanoseconds for which its threads, the one that reads from it, and the one that asks, which sends inputs,
        were ready and had no processor, and for which a host has taken processors from this machine."""
        if self.process is not None and self._reader is not None:
            own = {self._reader.native_id, threading.get_native_id()}
            tasks = [*(f"/proc/self/task/{each}" for each in own), *glob(f"/proc/{self.process.pid}/task/*")]
            self._waited = max(sum(map(_waited, tasks)) + _stolen(), self._waited)
        return self._waited

    def end(self, seconds: float) -> None:
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
        if self._reader is None:
            process.stdout.close()
        else:  # which closes the pipe; a process that is left behind may hold the other end for long
            self._reader.join(_SECONDS_AT_ONCE)

    def not_ready(self) -> UsageError:
        return UsageError(
            f'{self.command[0]} did not write {{"event": "{READY}"}} when it started',
            "let the program write this line, and flush it, when it is ready for inputs: the model starts then",
        )


def _waited(task: str) -> int:
    """Of a thread of Linux; 0 where it has ended, or on another system."""
    try:
        return int(Path(task, "schedstat").read_text(encoding="ascii").split()[1])
    except (OSError, ValueError, IndexError):
        return 0


def _stolen() -> int:
    """Nanoseconds since a virtual machine started in which its host ran something else; 0 where that is unknown."""
    try:
        ticks = int(Path("/proc/stat").read_text(encoding="ascii").split(maxsplit=9)[8])
        return ticks * 10**9 // os.sysconf("SC_CLK_TCK")
    except (OSError, ValueError, IndexError):
        return 0


class StartedProgram(RealTimeSystem):
    """What systems have in common that are a program which the test starts, and which runs by the clock of the wall."""

    def __init__(self, program: StreamedProgram, nanoseconds: Fraction) -> None:
        """Args: nanoseconds: of a unit of the model."""
        super().__init__(nanoseconds)
        self.program = program

    def check(self) -> None:
        if self.arrivals.is_over or self.program.is_over(self.arrivals):
            raise self.program.ended()

    def waited(self) -> Fraction:
        return self.duration(self.program.waited())


class RealTimeProgram(StartedProgram):
    """A program that speaks in lines of JSON. Its first line is ``{"event": "ready"}``: the model starts then."""

    def __init__(self, command: Sequence[str], nanoseconds: Fraction) -> None:
        """Args: nanoseconds: of a unit of the model."""
        super().__init__(StreamedProgram(command), nanoseconds)

    def start(self) -> None:
        self.program.spawn()
        self.program.read_into(self.arrivals)
        first = self.arrivals.next(time.monotonic_ns() + _SECONDS_TO_START * 10**9)
        if first is None or read_line(first.octets)[0] != READY:
            raise self.program.not_ready()
        self.begin(first.moment)

    def send(self, name: str, cells: Mapping[str, Cell]) -> Fraction:
        sent = time.monotonic_ns()
        self.program.write(event_line(name, cells))
        return self.units(sent)

    def outputs(self, arrival: Arrival) -> Iterator[SeenOutput]:
        yield line_output(arrival.octets, self.units(arrival.moment))

    def close(self) -> None:
        self.program.end(_SECONDS_TO_END)

    def abandon(self) -> None:
        self.program.end(_SECONDS_AT_ONCE)


class DrivenProgram:
    """A program whose clock the test moves on.

    To ``{"until": T}`` it answers with its first output until then, ``{"time": t, "event": ...}``, where its clock
    stays, or with ``{"time": T}``. Inputs have a time, too, at which its clock is already; it does not answer them.
    """

    def __init__(self, command: Sequence[str]) -> None:
        self._program = StreamedProgram(command)
        self._now = Fraction(0)
        self._read = b""
        self._question = ""

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
                raise SystemEndedError(
                    f"{self._program.command[0]} gives no answer{self._question} for {_SECONDS_TO_ANSWER:g} s"
                )
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
        question = until_line(until)
        self._question = f" to {question.strip()}"
        self._program.write(question)
        line = self._line()
        if not line:
            raise self._program.ended()
        name, cells, said = read_line(line)
        moment = next((each for each in (until, self._now) if said is not None and float(each) == float(said)), said)
        if moment is None or not self._now <= moment <= until:
            raise UsageError(
                f"the program answers {line.decode('utf-8', 'replace').strip()}, which has no `time` from "
                f"{number(self._now)} to {number(until)}",
                'answer {"until": T} with the first event until then and its time, or with {"time": T}; '
                "write all digits of a time",
            )
        self._now = moment if name is not None else until
        return None if name is None else SeenOutput(moment, name, cells)

    def waited(self) -> Fraction:
        return Fraction(0)

    def close(self) -> None:
        self._program.end(_SECONDS_TO_END)

    def abandon(self) -> None:
        self._program.end(_SECONDS_AT_ONCE)
