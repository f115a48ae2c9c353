"""`tachk serve`: a process that has loaded tachk already and carries out the calls of others."""

from __future__ import annotations

import os
import re
from typing import TYPE_CHECKING

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli import options
from tachk.cli.exit_status import ExitStatus

if TYPE_CHECKING:
    from pathlib import Path

_SECONDS = {"": 1, "s": 1, "min": 60, "h": 3600}
_LONGEST = 10**6
"""Hours, far more than a machine runs."""


@click.command(name="serve")
@click.option(
    "idle",
    "--idle",
    metavar="TIME",
    default="10min",
    show_default=True,
    help="End after this time without a request: 90s, 10min, 2h.",
)
@click.option(
    "path",
    "--socket",
    metavar="PATH",
    type=options.type_of_file,
    help="The socket of the server: programs use it with TACHK_SERVER=PATH. By default the one of TACHK_SERVER=auto.",
)
@click.option("status", "--status", is_flag=True, help="Print what a server does, and end.")
@click.option("stop", "--stop", is_flag=True, help="End a server once its requests have ended.")
def command(idle: str, path: Path | None, status: bool, stop: bool) -> None:
    """Keep tachk loaded, and carry out the calls of others: each starts in milliseconds.

    With TACHK_SERVER=auto in its environment, `tachk` starts such a server by itself, and uses it from the second call
    on. A server answers its user alone, and only programs that start as it did.

    Exit status: 0 when it ends, 10 for --status where there is no server, 2 where it cannot be reached or started.
    """

    options.finish(lambda: _run(idle, path, status, stop))


def _run(idle: str, path: Path | None, status: bool, stop: bool) -> ExitStatus:
    if os.name != "posix":
        raise UsageError("tachk serve needs Unix sockets and copies of processes, which this system does not have")
    from tachk.cli.server.identity import key, usual_socket

    seconds = _seconds(idle)
    if status and stop:
        raise UsageError("--status and --stop are two questions", "give one of them")
    where = usual_socket(key()) if path is None else os.path.abspath(path)
    if status or stop:
        from tachk.cli.server.inquiry import run_status, run_stop

        return run_status(where) if status else run_stop(where)
    return _serve(where, seconds)


def _seconds(text: str) -> float:
    found = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*(s|min|h|)\s*", text, re.ASCII)
    if found is None:
        raise UsageError(f"--idle {text} is no time", "write 90s, 10min or 2h")
    seconds = float(found[1]) * _SECONDS[found[2]]
    if seconds > _LONGEST * _SECONDS["h"]:
        raise UsageError(f"--idle {text} is too long", f"give at most {_LONGEST}h")
    return seconds


def _serve(path: str, seconds: float) -> ExitStatus:
    from tachk.cli.server.binding import UnusableSocketError, bound, server_command

    try:
        listening = bound(path)
    except UnusableSocketError as error:
        raise UsageError(str(error), "name a socket in a folder of yours with mode 700: --socket PATH") from None
    if listening is None:
        raise UsageError(f"a server has {path} already", "tachk serve --stop ends it")
    arguments = server_command(listening, path, seconds)
    print(f"serving {path}", flush=True)
    os.execv(arguments[0], arguments)
