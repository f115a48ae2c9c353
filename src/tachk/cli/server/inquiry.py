"""Questions to a server about itself."""

from __future__ import annotations

import json
import socket
from typing import Any

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli.exit_status import ExitStatus
from tachk.cli.server.client import connected


def run_status(path: str) -> ExitStatus:
    """Prints what the server of a socket does."""
    answered = _answer(path, "status")
    if answered is None:
        print(f"no server at {path}")
        return ExitStatus.NOT_AS_EXPECTED
    print(
        f"tachk {answered['version']} at {path}: process {answered['process']}, for {answered['seconds']} s; "
        f"requests: {answered['under_way']} under way, {answered['carried_out']} carried out"
    )
    return ExitStatus.AS_EXPECTED


def run_stop(path: str) -> ExitStatus:
    """Ends the server of a socket, once its requests have ended."""
    answered = _answer(path, "stop")
    if answered is None:
        print(f"no server at {path}")
    elif answered["under_way"]:
        print(f"the server ends with its requests: {answered['under_way']} under way")
    else:
        print("the server has ended")
    return ExitStatus.AS_EXPECTED


def _answer(path: str, question: str) -> Any:
    """What a server says of itself; None if there is none. One that ends at once has ended.

    Raises UsageError for a socket that belongs to something else.
    """
    try:
        connection = connected(path)
    except (FileNotFoundError, ConnectionRefusedError):
        return None
    with socket.socket(fileno=connection.detach()) as stream, stream.makefile("rb") as lines:
        stream.sendall(json.dumps({"id": 1, "server": question}).encode() + b"\n")
        stream.shutdown(socket.SHUT_WR)
        try:
            answered = json.loads(lines.readline())["server"]
            lines.read()  # until the server ends the connection, or itself
        except (OSError, ValueError, KeyError, TypeError):
            raise UsageError(f"{path} is no socket of a server of tachk") from None
    return answered
