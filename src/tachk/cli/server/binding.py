"""The socket of a server, and the process that a client starts for later calls. Imports next to nothing."""

from __future__ import annotations

import fcntl
import os
import sys
from _socket import AF_UNIX, SOCK_STREAM, socket
from contextlib import contextmanager
from stat import S_ISSOCK

from tachk.cli.server.identity import interpreter_options, mistake_of_folder

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator

MOST_DESCRIPTORS = 1 << 16
"""More than a server has; the system may allow a thousand million, each of which an old kernel would close alone."""

_WAITING = 128
"""Clients that wait for being accepted, as while the server is loading tachk."""


class UnusableSocketError(Exception):
    """No server can have this socket; says why."""


def bound(path: str) -> socket | None:
    """A socket at a path that takes connections, which only this user may open; None where a server has it already.

    Raises:
        UnusableSocketError: the folder is not private, or the path is something else, or too long.
        OSError: it cannot be made.
    """
    folder = os.path.dirname(path)
    os.makedirs(folder, 0o700, exist_ok=True)
    mistake = mistake_of_folder(folder)
    if mistake:
        raise UnusableSocketError(f"{folder} is no place for a socket: {mistake}")
    with _alone_in(folder):
        if not os.path.lexists(path):
            return _listening(path)
        if not S_ISSOCK(os.lstat(path).st_mode):
            raise UnusableSocketError(f"{path} is no socket")
        probe = socket(AF_UNIX, SOCK_STREAM)
        try:
            probe.connect(path)
        except ConnectionRefusedError:  # its server has been killed
            os.unlink(path)
            return _listening(path)
        except OSError as error:
            raise UnusableSocketError(f"{path} takes no connections: {error.strerror or error}") from None
        finally:
            probe.close()
    return None


@contextmanager
def _alone_in(folder: str) -> Iterator[None]:
    """No other process is about to make a socket in the folder."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)


def _listening(path: str) -> socket:
    listening = socket(AF_UNIX, SOCK_STREAM)
    before = os.umask(0o177)
    try:
        listening.bind(path)
    except OSError as error:
        listening.close()
        if error.errno is None:  # Python found that it does not fit
            raise UnusableSocketError(f"{path} is too long for a socket") from None
        raise
    finally:
        os.umask(before)
    listening.listen(_WAITING)
    return listening


def server_command(listening: socket, path: str, seconds: float) -> list[str]:
    """The command that serves a socket, which it inherits."""
    os.set_inheritable(listening.fileno(), True)
    program = os.path.join(os.path.dirname(os.path.abspath(__file__)), "__main__.py")
    return [sys.executable, *interpreter_options(), program, str(listening.fileno()), path, str(seconds)]


def start_in_background(path: str, seconds: float) -> None:
    """Starts a server that outlives this program, unless there is one. What it says goes to a file beside the socket.

    Raises UnusableSocketError and OSError as `bound` does.
    """
    listening = bound(path)
    if listening is None:
        return
    command = server_command(listening, path, seconds)
    child = os.fork()
    if child:
        listening.close()
        os.waitpid(child, 0)
        return
    try:
        os.setsid()
        if os.fork():
            os._exit(0)  # so that the server is no child of this program, which may wait for all it has
        log = os.open(f"{path.removesuffix('.sock')}.log", os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
        nothing = os.open(os.devnull, os.O_RDONLY)
        for source, target in ((nothing, 0), (log, 1), (log, 2)):
            os.dup2(source, target)
        first = listening.fileno()
        os.closerange(3, first)
        os.closerange(first + 1, MOST_DESCRIPTORS)
        os.execv(command[0], command)
    finally:
        os._exit(1)
