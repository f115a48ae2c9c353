"""The copy of a server that carries out one request, as a process of its own that `tachk` was started as."""

from __future__ import annotations

import atexit
import os
import resource
import signal
import sys
import tempfile
import time
import traceback
from contextvars import Context
from io import BufferedReader, BufferedWriter, FileIO, TextIOWrapper
from typing import BinaryIO, NoReturn, cast

from tachk.base.records import dataclass
from tachk.cli.server.binding import MOST_DESCRIPTORS
from tachk.cli.server.messages import Request
from tachk.cli.start import run_here
from tachk.cli.terminal import end_by

_LIMITS = [getattr(resource, name) for name in dir(resource) if name.startswith("RLIMIT_")]
_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGCHLD)
_AT_START = [getattr(sys, f"__{name}__") for name in ("stdin", "stdout", "stderr")]
_ERRORS = [stream.errors for stream in _AT_START]
"""What the streams of this process do at its start with characters that their encoding lacks."""

_UNWRITTEN = 120
"""The status with which Python ends where output was left that it could not write."""


@dataclass(frozen=True, slots=True)
class ProcessLimits:
    """What the system allows a process: a copy of the server is allowed what its caller is.

    Attributes:
        resources: the limits of the kinds in `_LIMITS`, each now and at most.
        cores: on which it may run.
        niceness: how far it steps back behind others.
    """

    resources: tuple[tuple[int, int], ...]
    cores: frozenset[int]
    niceness: int


def limits_of(process: int) -> ProcessLimits | None:
    """The limits of a process of the same user, 0 for this one; None where the system does not say them.

    Raises OSError where there is no such process.
    """
    if sys.platform != "linux":
        return None
    return ProcessLimits(
        tuple(resource.prlimit(process, kind) for kind in _LIMITS),
        frozenset(os.sched_getaffinity(process)),
        os.getpriority(os.PRIO_PROCESS, process),
    )


def may_become(own: ProcessLimits | None, wanted: ProcessLimits | None) -> bool:
    """True if a process can give itself these limits: it can only have less than it has."""
    if own is None or wanted is None:
        return own is wanted
    most = [hard for _, hard in own.resources]
    return wanted.niceness >= own.niceness and all(
        there == resource.RLIM_INFINITY or (here != resource.RLIM_INFINITY and here <= there)
        for there, (_, here) in zip(most, wanted.resources, strict=True)
    )


def execute(request: Request, streams: tuple[int | None, int, int], wanted: ProcessLimits | None) -> NoReturn:
    """Carries out a request and ends the process. The signals that the server handles are blocked before.

    Args:
        streams: the descriptors of its standard input, output and errors; None: its input is the text of the request.
        wanted: the limits of the caller.
    """
    status = 1
    try:
        _take_streams(request, streams)
        try:
            _take_over(request, wanted)
        except OSError as error:
            print(f"error: {error.filename or request.cwd}: {error.strerror}", file=sys.stderr)
            status = 2
        else:
            status = _ended()
    except BaseException:
        traceback.print_exc()
    finally:
        os._exit(status)


def _take_streams(request: Request, streams: tuple[int | None, int, int]) -> None:
    """The standard streams become those of the caller, as Python opens them at its start. All else is closed."""
    signal.set_wakeup_fd(-1)
    os.setsid()
    given, *outputs = streams
    if given is None:
        with tempfile.TemporaryFile() as file:
            file.write(request.stdin.encode(errors="surrogatepass"))
            file.seek(0)
            os.dup2(file.fileno(), 0)
    else:
        os.dup2(given, 0)
    for number, descriptor in enumerate(outputs, 1):
        os.dup2(descriptor, number)
    os.closerange(3, MOST_DESCRIPTORS)
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        stream = _opened(number)
        setattr(sys, name, stream)
        setattr(sys, f"__{name}__", stream)


def _opened(number: int) -> TextIOWrapper:
    """A standard stream as Python opens it at its start."""
    like, unbuffered = _AT_START[number], isinstance(_AT_START[1].buffer, FileIO)
    plain = FileIO(number, "w" if number else "r", closefd=False)
    buffered = BufferedReader(plain) if not number else plain if unbuffered else BufferedWriter(plain)
    at_once = not unbuffered and (number == 2 or plain.isatty())
    return TextIOWrapper(
        cast("BinaryIO", buffered),
        encoding=like.encoding,
        errors=_ERRORS[number],
        newline="\n" if number else None,
        line_buffering=at_once,
        write_through=unbuffered,
    )


def _take_over(request: Request, wanted: ProcessLimits | None) -> None:
    """Everything else that a program has from its caller."""
    for number in _SIGNALS:
        usual = signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL
        signal.signal(number, signal.SIG_IGN if number in request.ignored else usual)
    if wanted is not None:
        for kind, limits in zip(_LIMITS, wanted.resources, strict=True):
            resource.setrlimit(kind, limits)
        os.sched_setaffinity(0, wanted.cores)
        os.setpriority(os.PRIO_PROCESS, 0, wanted.niceness)
    if request.environment is not None:
        os.environ.clear()
        os.environ.update(request.environment)
        time.tzset()
    if request.umask is not None:
        os.umask(request.umask)
    os.chdir(request.cwd)
    sys.argv = ["tachk", *request.argv]


def _ended() -> int:
    """Carries out the command line, and what Python does at its end; the exit status."""
    status = 0
    try:
        signal.pthread_sigmask(signal.SIG_SETMASK, ())
        Context().run(run_here)
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else int(end.code is not None)
    except KeyboardInterrupt:  # before the command had begun
        print("error: interrupted", file=sys.stderr)
        end_by(signal.SIGINT)
    except BaseException:
        traceback.print_exc()
        status = 1
    if "threading" in sys.modules:
        sys.modules["threading"]._shutdown()
    atexit._run_exitfuncs()
    try:
        sys.stdout.flush()
        sys.stderr.flush()
    except OSError:
        status = _UNWRITTEN
    return status & 0xFF
