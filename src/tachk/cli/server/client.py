"""The thin way of the program `tachk` to a server: a copy of that does the work, on the streams of this program.

It is loaded before everything else of tachk, and imports next to nothing: what is done here is what a call costs. So it
uses the modules in C behind `socket`, `signal` and `json`, and reads the lines of a server of the same version only.
"""

from __future__ import annotations

import os
import sys
from _json import encode_basestring_ascii as quoted
from _signal import SIG_DFL, SIG_IGN, SIGCONT, SIGHUP, SIGINT, SIGKILL, SIGSTOP, SIGTERM, SIGTSTP, getsignal, signal  # type: ignore[import-not-found]
from _socket import AF_UNIX, SCM_RIGHTS, SOCK_STREAM, SOL_SOCKET, socket

from tachk.cli.server.identity import key, mistake_of_folder, usual_socket

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import NoReturn

IDLE_SECONDS = 600.0
"""After so much time without a request a server ends."""

_BAD_INPUT, _INTERNAL_ERROR = 2, 70  # as `ExitStatus` has them
_ITSELF = {"serve", "mcp", "step", "proxy", "bridge"}
"""Commands that are no work for a server: they converse on a terminal, or run until they are stopped."""

_OF_A_PROCESS = ("/dev/fd/", "/dev/tty", "/proc/")
"""Beginnings of paths that mean something else in each process, such as ``<(zcat log.gz)`` of a shell."""

_IGNORABLE = {"SIGHUP": SIGHUP, "SIGINT": SIGINT, "SIGTERM": SIGTERM}
_CREDENTIALS = 12
"""Bytes of the process, user and group at the other end of a socket, of four bytes each."""


def use_server(setting: str) -> None:
    """Lets a server carry out the command line and ends the program; returns where the program is to do it itself.

    Args:
        setting: ``auto``, or the path of a socket.
    """
    if None in (sys.stdin, sys.stdout, sys.stderr) or not _is_work_for_server(sys.argv[1:]):
        return
    own = key()
    path = usual_socket(own) if setting == "auto" else os.path.abspath(setting)
    try:
        connection = connected(path)
    except OSError as error:
        connection, why = None, error.strerror or str(error)
    if connection is not None:
        why = _ended_by(connection, own)  # returns only if nothing has been done
    if setting != "auto":
        _end_with(f"{path}: {why}", _BAD_INPUT, "start a server by tachk serve --socket PATH, or set TACHK_SERVER=auto")
    _start(path)  # also where a server has ended because it does not fit any more


def _is_work_for_server(words: list[str]) -> bool:
    return _ITSELF.isdisjoint(words[:2]) and not any(name in word for word in words for name in _OF_A_PROCESS)


def connected(path: str) -> socket:
    """Raises OSError where no server of this user takes connections."""
    mistake = mistake_of_folder(os.path.dirname(path))
    if mistake:
        raise OSError(0, f"no private folder: {mistake}")
    connection = socket(AF_UNIX, SOCK_STREAM)
    connection.connect(path)
    if owner_of(connection) not in (None, os.getuid()):
        raise OSError(0, "the server belongs to another user")
    return connection


def owner_of(connection: socket) -> int | None:
    """The number of the user at the other end; None where the system does not say it."""
    return credentials_of(connection)[1]


def credentials_of(connection: socket) -> tuple[int | None, int | None]:
    """The process and the user at the other end; None where the system does not say it."""
    if sys.platform != "linux":
        return None, None
    from _socket import SO_PEERCRED

    found = connection.getsockopt(SOL_SOCKET, SO_PEERCRED, _CREDENTIALS)
    return int.from_bytes(found[:4], sys.byteorder), int.from_bytes(found[4:8], sys.byteorder)


def _start(path: str) -> None:
    """Starts a server for later calls. Where that is not possible this call goes on all the same."""
    from tachk.cli.server.binding import UnusableSocketError, start_in_background

    try:
        start_in_background(path, IDLE_SECONDS)
    except (OSError, UnusableSocketError):
        return


def _request(own: str) -> bytes:
    """Raises OSError where the current folder is gone."""
    mask = os.umask(0o077)
    os.umask(mask)
    words = ",".join(map(quoted, sys.argv[1:]))
    variables = ",".join(f"{quoted(name)}:{quoted(value)}" for name, value in os.environ.items())
    ignored = ",".join(f'"{name}"' for name, number in _IGNORABLE.items() if getsignal(number) == SIG_IGN)
    return (
        f'{{"id":1,"argv":[{words}],"cwd":{quoted(os.getcwd())},"environment":{{{variables}}},"umask":{mask},'
        f'"ignored":[{ignored}],"key":{quoted(own)},"descriptors":true}}\n'
    ).encode("ascii")


def _ended_by(connection: socket, own: str) -> str:
    """Sends the request and ends the program as it ended; returns why it was not even begun."""
    numbers = b"".join(number.to_bytes(4, sys.byteorder) for number in (0, 1, 2))
    signals = _ForwardedSignals(connection)
    process = 0
    try:
        request = _request(own)
        sent = connection.sendmsg([request], [(SOL_SOCKET, SCM_RIGHTS, numbers)])
        connection.sendall(request[sent:])
        signals.forward()
        received = b""
        while piece := connection.recv(4096):
            *lines, received = (received + piece).split(b"\n")
            for line in lines:
                if b'"process":' in line:
                    process = _last_number(line)
                elif b'"status":' in line:
                    _end_as(line)
                else:
                    return line.decode("ascii", "replace")
        why = "the server has ended"
    except OSError as error:
        why = error.strerror or str(error)
    finally:
        signals.leave()
    if process:
        _kill(process)
        _end_with(f"{why} before the command", _INTERNAL_ERROR)
    return why


class _ForwardedSignals:
    """Signals that this program receives for the copy of the server that does its work."""

    def __init__(self, connection: socket) -> None:
        """From now on they wait."""
        self._connection = connection
        self._ready = False
        self._waiting: list[int] = []
        self._before = {
            number: signal(number, self._handle)
            for number in (SIGINT, SIGTERM, SIGTSTP)
            if getsignal(number) != SIG_IGN
        }

    def forward(self) -> None:
        """The request has been sent: from now on signals follow it."""
        self._ready = True
        for number in self._waiting:
            self._send(number)
        self._waiting.clear()

    def leave(self) -> None:
        """The program has its own signals again, and what has come for it."""
        for number, before in self._before.items():
            signal(number, before)
        for number in self._waiting:
            os.kill(os.getpid(), number)

    def _handle(self, number: int, frame: object) -> None:
        if self._ready:
            self._send(number)
        else:
            self._waiting.append(number)

    def _send(self, number: int) -> None:
        self._connection.sendall(b'{"id":1,"signal":%d}\n' % number)
        if number == SIGTSTP:
            os.kill(os.getpid(), SIGSTOP)  # goes on here when the shell continues the program
            self._connection.sendall(b'{"id":1,"signal":%d}\n' % SIGCONT)


def _last_number(line: bytes) -> int:
    return int(line.rstrip(b"}").rpartition(b":")[2])


def _end_as(line: bytes) -> NoReturn:
    """Ends the program with the status of the copy, or by the signal that has ended it."""
    number = _last_number(line)
    if b'"signal":' not in line:
        os._exit(number)
    if number not in (SIGKILL, SIGSTOP):
        signal(number, SIG_DFL)
    os.kill(os.getpid(), number)
    os._exit(128 + number)


def _kill(process: int) -> None:
    try:  # noqa: SIM105
        # `contextlib` takes longer to load than the rest of this module.
        os.killpg(process, SIGKILL)
    except OSError:  # it has ended, too
        pass


def _end_with(message: str, status: int, help: str = "") -> NoReturn:
    print(f"error: {message}", *([f"help: {help}"] if help else []), sep="\n", file=sys.stderr)
    sys.stderr.flush()
    os._exit(status)
