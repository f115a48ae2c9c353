"""The server: takes connections, copies itself for each request, and reports how the copy ended.

One thread, which waits for none of them alone.
"""

from __future__ import annotations

import os
import select
import signal
import socket
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from errno import EMFILE, ENFILE
from time import monotonic

import tachk
from tachk.cli.server.client import credentials_of
from tachk.cli.server.connection import Connection, TooMuchError
from tachk.cli.server.identity import key
from tachk.cli.server.messages import (
    PROTOCOL_VERSION,
    Request,
    ServerMessage,
    SignalMessage,
    WrongMessageError,
    line,
    parse,
)
from tachk.cli.server.scripts import key_of_own_scripts
from tachk.cli.server.sources import Sources, loaded_files
from tachk.cli.server.work import RequestUnderWay, begun
from tachk.cli.server.worker import limits_of, may_become

_GONE = select.POLLHUP | select.POLLERR | select.POLLNVAL


class DeclinedError(Exception):
    """The server does not carry out a request; says why. Nothing of it has been done."""


class Server:
    """Serves a socket.

    Args:
        listening: the socket, which stands at the path.
        idle: the seconds without a request after which it ends.
        clock: the time in seconds.
    """

    def __init__(
        self, listening: socket.socket, path: str, idle: float, clock: Callable[[], float] = monotonic
    ) -> None:
        listening.setblocking(False)
        self._listening = listening
        self._path = path
        self._place = _place(path)
        self._idle = idle
        self._clock = clock
        self._began = self._quiet_since = clock()
        self._keys = {None, key(), key_of_own_scripts()}
        self._sources = Sources(loaded_files())
        self._limits = limits_of(0)
        self._clients: dict[int, Connection] = {}
        self._works: list[RequestUnderWay] = []
        self._finished = 0
        self._ending = False
        self._full = False

    def serve(self) -> None:
        """Serves until the server has been idle for too long, or is stopped, and its requests have ended."""
        with _received_signals() as signals:
            while not self.is_over():
                self.step(signals, self.patience())
        self.leave()
        for client in self._clients.values():
            client.close()

    def is_over(self) -> bool:
        """True if the server is to end."""
        return not self._works and (self._ending or self.patience() == 0)

    def patience(self) -> float | None:
        """The seconds until the server has been idle for too long; None while there is work."""
        return None if self._works else max(0.0, self._quiet_since + self._idle - self._clock())

    def leave(self) -> None:
        """No new client finds the server."""
        self._ending = True
        self._listening.close()
        if self._place is not None and _place(self._path) == self._place:
            with suppress(OSError):
                os.unlink(self._path)
        self._place = None

    def step(self, signals: int | None, seconds: float | None) -> None:
        """Waits until something happens, at most so many seconds, and handles it.

        Args:
            signals: the pipe with the numbers of signals that have come.
        """
        poll = select.poll()
        if signals is not None:
            poll.register(signals, select.POLLIN)
        if not self._ending and not self._full:
            poll.register(self._listening, select.POLLIN)
        for client in self._clients.values():
            events = 0 if client.ended else select.POLLIN
            poll.register(client, events | (select.POLLOUT if client.unsent else 0))
        pipes = {pipe: work for work in self._works if work.readable for pipe in work.streams}
        for pipe in pipes:
            poll.register(pipe, select.POLLIN)
        for descriptor, events in poll.poll(None if seconds is None else seconds * 1000 + 1):
            if descriptor == signals:
                self._handle_signals(os.read(signals, 1024))
            elif descriptor in pipes:
                if descriptor in pipes[descriptor].streams:
                    pipes[descriptor].copy_output(descriptor)
            elif descriptor in self._clients:
                self._handle_client(self._clients[descriptor], events)
            elif descriptor == self._listening.fileno():
                self._accept()
        self._forget_ended()

    def _handle_signals(self, numbers: bytes) -> None:
        ended = [number for number in numbers if number in (signal.SIGINT, signal.SIGTERM)]
        for _ in ended:
            for work in self._works:
                if self._ending:
                    work.kill()
                else:
                    work.receive(SignalMessage(work.id, signal.SIGTERM))
            self.leave()
        with suppress(ChildProcessError):
            while (found := os.waitpid(-1, os.WNOHANG))[0]:
                for work in self._works:
                    if work.process == found[0] and not work.outcome:
                        work.end(found[1])

    def _accept(self) -> None:
        try:
            connected, _ = self._listening.accept()
        except OSError as error:
            self._full = error.errno in (EMFILE, ENFILE)  # otherwise it is gone again
            return
        process, user = credentials_of(connected)
        if user in (None, os.getuid()):
            self._clients[connected.fileno()] = Connection(connected, process)
        else:
            connected.close()

    def _handle_client(self, client: Connection, events: int) -> None:
        try:
            if events & select.POLLOUT:
                client.say(b"")
            if events & select.POLLIN:
                for text in client.receive():
                    self._handle_line(client, text)
            elif events & _GONE:
                self._drop(client)
        except TooMuchError:
            client.say(line(None, error="the line is too long, or descriptors belong to no request"))
            self._drop(client)
        except OSError:
            self._drop(client)

    def _handle_line(self, client: Connection, text: bytes) -> None:
        try:
            message = parse(text)
        except WrongMessageError as error:
            client.say(line(error.identifier, error=str(error)))
            _close(client.take_descriptors())
            return
        match message:
            case Request():
                try:
                    self._begin(client, message)
                except (DeclinedError, OSError) as error:
                    client.say(line(message.id, error=str(error)))
            case SignalMessage():
                works = [work for work in self._works if work.client is client and work.id == message.id]
                for work in works:
                    work.receive(message)
                if not works:
                    client.say(line(message.id, error="no such request is under way"))
            case ServerMessage():
                self._answer(client, message)

    def _answer(self, client: Connection, message: ServerMessage) -> None:
        if message.server == "stop":
            self.leave()
        about = {
            "version": tachk.__version__,
            "protocol": PROTOCOL_VERSION,
            "process": os.getpid(),
            "seconds": round(self._clock() - self._began),
            "under_way": len(self._works),
            "carried_out": self._finished,
        }
        client.say(line(message.id, server=about, status=0))

    def _begin(self, client: Connection, request: Request) -> None:
        """Raises DeclinedError, and OSError where there can be no further process."""
        given = client.take_descriptors()
        try:
            self._check(client, request, given)
            wanted = None if client.process is None else limits_of(client.process)
            if not may_become(self._limits, wanted):
                self.leave()  # so that another one can take its place
                raise DeclinedError("the system allows the server less than the caller")
        except (DeclinedError, OSError):
            _close(given)
            raise
        work = begun(client, request, given, wanted)
        self._works.append(work)
        client.say(line(request.id, process=work.process))

    def _check(self, client: Connection, request: Request, given: tuple[int, ...]) -> None:
        if self._ending:
            raise DeclinedError("the server is about to end")
        if request.key not in self._keys:
            raise DeclinedError("the server is of another installation, or was started with other settings")
        if len(given) != (3 if request.descriptors else 0):
            raise DeclinedError("`descriptors` needs three descriptors with the line, and without it there are none")
        if any(work.client is client and work.id == request.id for work in self._works):
            raise DeclinedError("a request with this `id` is under way")
        if client.process == 0:
            raise DeclinedError("the caller lives in another namespace of processes")
        if self._sources.changed():
            self.leave()  # so that another one can take its place
            raise DeclinedError("the files of tachk have changed since the server started")

    def _drop(self, client: Connection) -> None:
        """The client is gone: nobody waits for its requests."""
        for work in self._works:
            if work.client is client:
                work.abandon()
        del self._clients[client.fileno()]
        client.close()
        self._full = False  # others may wait

    def _forget_ended(self) -> None:
        ended = [work for work in self._works if work.is_over]
        if ended:
            self._works = [work for work in self._works if not work.is_over]
            self._finished += len(ended)
            self._quiet_since = self._clock()
        busy = {id(work.client) for work in self._works}
        for client in [*self._clients.values()]:
            if client.ended and not client.unsent and id(client) not in busy:
                self._drop(client)


def _close(descriptors: tuple[int, ...]) -> None:
    for descriptor in descriptors:
        os.close(descriptor)


def _place(path: str) -> tuple[int, int] | None:
    """The file at a path."""
    try:
        found = os.lstat(path)
    except OSError:
        return None
    return found.st_dev, found.st_ino


@contextmanager
def _received_signals() -> Iterator[int]:
    """A pipe with the numbers of the signals that come: to end, or because a process has ended."""
    read, write = os.pipe()
    os.set_blocking(read, False)
    os.set_blocking(write, False)
    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGCHLD)
    before = {number: signal.signal(number, _note) for number in numbers}
    previous = signal.set_wakeup_fd(write, warn_on_full_buffer=False)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, numbers)  # those that have come meanwhile, too
    try:
        yield read
    finally:
        signal.set_wakeup_fd(previous)
        for number, handler in before.items():
            signal.signal(number, handler)
        os.close(read)
        os.close(write)


def _note(number: int, frame: object) -> None:
    """The number is in the pipe."""
