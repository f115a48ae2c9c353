"""Errors as users see them: a place, a reason and advice for their mistakes; a request for a report for defects."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from contextvars import ContextVar

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, Severity, UnsupportedError, UsageError
from tachk.base.job import StoppedError, is_interrupted, limited, remembering_interruption
from tachk.base.optional_packages import MissingPackageError, optional_packages
from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.terminal import wants_colour

_DIAGNOSTICS_SHOWN = 20
_printed: ContextVar[set[str] | None] = ContextVar("printed", default=None)
"""The diagnostics that a call of a command has printed."""
_NO_MEMORY = "the machine was out of memory before there was a result"


def without_result(error: StoppedError) -> str:
    """The message for a command that a limit has ended."""
    return f"the {error.reason} was over before there was a result"


def run_command(action: Callable[[], ExitStatus], seconds: float | None = None) -> ExitStatus:
    """Runs a command; an error becomes a message and the status.

    Args:
        seconds: the limit on the time of the command as a whole.
    """

    def within_limit() -> ExitStatus:
        with remembering_interruption(), limited(seconds):
            status = action()
            return worst((status, ExitStatus.INTERRUPTED)) if is_interrupted() else status

    before = _printed.set(set())
    try:
        return guarded(within_limit)
    finally:
        _printed.reset(before)


def guarded(action: Callable[[], ExitStatus], subject: str = "") -> ExitStatus:
    """Runs an action; an error becomes a message on standard error and an exit status.

    Args:
        subject: what the action is about, where a message alone would not say it.
    """
    try:
        with optional_packages():
            return action()
    except InputError as error:
        print_diagnostics(error.diagnostics)
        errors = [found for found in error.diagnostics if found.severity is Severity.ERROR]
        unsupported = bool(errors) and all(found.is_unsupported for found in errors)
        return ExitStatus.UNSUPPORTED if unsupported else ExitStatus.BAD_INPUT
    except UnsupportedError as error:
        print_diagnostics([error.diagnostic])
        return ExitStatus.UNSUPPORTED
    except MissingPackageError as error:
        complain(f"{subject}: {error.message}" if subject else error.message, error.help)
        return ExitStatus.UNSUPPORTED
    except UsageError as error:
        complain(f"{subject}: {error.message}" if subject else error.message, error.help)
        return ExitStatus.BAD_INPUT
    except BrokenPipeError:
        return ExitStatus.PIPE_CLOSED
    except OSError as error:
        complain(f"{error.filename}: {error.strerror}" if error.filename else error.strerror or str(error))
        return ExitStatus.BAD_INPUT
    except StoppedError as error:
        complain(f"{subject}: {without_result(error)}" if subject else without_result(error))
        return ExitStatus.UNKNOWN
    except MemoryError:
        complain(f"{subject}: {_NO_MEMORY}" if subject else _NO_MEMORY, "--max-memory ends a search before that")
        return ExitStatus.UNKNOWN
    except KeyboardInterrupt:
        complain("interrupted before there was an answer")
        return ExitStatus.INTERRUPTED
    except Exception:  # the last resort of the program: whatever comes here is a defect
        import traceback

        traceback.print_exc()
        complain(
            "this is a defect of tachk, not of your model",
            "please report it with the command, the model and the lines above",
        )
        return ExitStatus.INTERNAL_ERROR


def complain(message: str, help: str | None = None) -> None:
    """Prints an error that has no place in a text."""
    print(f"error: {message}", file=sys.stderr)
    if help:
        print(f"help: {help}", file=sys.stderr)


def print_diagnostics(diagnostics: Iterable[Diagnostic]) -> None:
    """Prints diagnostics with their source lines, each once in a call of a command, errors first where there are too
    many for all of them."""
    from tachk.base.diagnostics.render import render

    printed = _printed.get()
    if printed is None:
        printed = set()
    found = [each for each in dict.fromkeys(diagnostics) if render(each) not in printed]
    printed.update(map(render, found))
    if len(found) > _DIAGNOSTICS_SHOWN:
        found.sort(key=lambda diagnostic: diagnostic.severity is not Severity.ERROR)
    for diagnostic in found[:_DIAGNOSTICS_SHOWN]:
        print(render(diagnostic, colour=wants_colour(sys.stderr)), file=sys.stderr)
    if len(found) > _DIAGNOSTICS_SHOWN:
        print(f"... and {len(found) - _DIAGNOSTICS_SHOWN} more", file=sys.stderr)
