"""The beginning and the end of a console script."""

from __future__ import annotations

import gc
import os
import signal
import sys
from collections.abc import Callable
from typing import NoReturn

from tachk.base.cycles import collect_rarely
from tachk.cli.exit_status import ExitStatus
from tachk.cli.terminal import end_by, prepare_streams
from tachk.cli.termination import Termination

COMPLETION_VARIABLE = "_TACHK_COMPLETE"
"""With this in the environment click answers what a shell asks when it completes a line."""


def end_program(command: Callable[[], int | None]) -> NoReturn:
    """Runs a command line, which returns its status, and ends the program with that."""
    collect_rarely()
    prepare_streams()
    termination = Termination()
    termination.heed()
    try:
        status = _status_of(command)
    except BrokenPipeError:
        status = ExitStatus.PIPE_CLOSED
    except OSError as error:  # the report cannot be written: the disk is full
        status = ExitStatus.BAD_INPUT
        _leave_unwritten()
        print(f"error: standard output: {error.strerror or error}", file=sys.stderr)
    except KeyboardInterrupt:
        status = ExitStatus.INTERRUPTED
        print("error: interrupted", file=sys.stderr)
    termination.leave()
    if status == ExitStatus.PIPE_CLOSED:
        _leave_unwritten()
        end_by(getattr(signal, "SIGPIPE", signal.SIGTERM))
    if status == ExitStatus.INTERRUPTED:
        termination.end()
    gc.freeze()  # or Python looks through everything once more for what it could free
    sys.exit(status)


def _status_of(command: Callable[[], int | None]) -> int | None:
    """Raises BrokenPipeError where the pipe of the output is closed."""
    stdout = sys.stdout
    try:
        status = command()
        sys.stdout.flush()
    except SystemExit:
        if sys.stdout is stdout:
            raise
        # Where a pipe is closed, click replaces the streams and exits with 1.
        raise BrokenPipeError from None
    return status


def _leave_unwritten() -> None:
    """Sends unwritten output to nowhere: otherwise the interpreter would fail to write it, and say so, at its end."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
