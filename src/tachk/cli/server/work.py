"""A request that a server carries out: the copy of the server that does it, and how that ends."""

from __future__ import annotations

import codecs
import os
import signal
from contextlib import suppress

from tachk.base.records import dataclass, field
from tachk.cli.server.connection import Connection
from tachk.cli.server.messages import Identifier, Request, SignalMessage, line
from tachk.cli.server.worker import ProcessLimits, execute

_PIECE = 1 << 16
_MOST_UNSENT = 1 << 20
"""Bytes for a client that does not read them: until it does, the output of its request waits."""

_HELD = (signal.SIGINT, signal.SIGTERM, signal.SIGCHLD)
_NAMES = ("stdout", "stderr")


@dataclass(eq=False, slots=True)
class RequestUnderWay:
    """A request that is under way.

    Attributes:
        client: reads the replies.
        id: of the request.
        process: of the copy; the first one of its group.
        streams: the pipes of output that does not go to the client directly, each with its name and its decoder.
        outcome: how the process has ended; empty as long as it runs.
    """

    client: Connection
    id: Identifier
    process: int
    streams: dict[int, tuple[str, codecs.IncrementalDecoder]]
    outcome: dict[str, int] = field(default_factory=dict)

    @property
    def readable(self) -> bool:
        """True if the client has room for more output."""
        return len(self.client.unsent) < _MOST_UNSENT

    def copy_output(self, descriptor: int) -> None:
        """Sends what has come through a pipe."""
        name, decoder = self.streams[descriptor]
        piece = os.read(descriptor, _PIECE)
        text = decoder.decode(piece, not piece)
        if text:
            self.client.say(line(self.id, stream=name, text=text))
        if not piece:
            os.close(descriptor)
            del self.streams[descriptor]
            self._report()

    def end(self, status: int) -> None:
        """The process has ended, with a status as of `os.wait`."""
        code = os.waitstatus_to_exitcode(status)
        self.outcome = {"status": 128 - code, "signal": -code} if code < 0 else {"status": code}
        if self.streams:  # nothing that it has left behind keeps them open
            self.kill()
        self._report()

    @property
    def is_over(self) -> bool:
        return bool(self.outcome) and not self.streams

    def _report(self) -> None:
        if self.is_over:
            self.client.say(line(self.id, **self.outcome))

    def receive(self, message: SignalMessage) -> None:
        """Hands on a signal. That of Ctrl-Z stops all its processes, as a terminal would."""
        with suppress(ProcessLookupError, PermissionError):
            if message.signal == signal.SIGTSTP:
                os.killpg(self.process, signal.SIGSTOP)
            elif message.signal == signal.SIGCONT:
                os.killpg(self.process, signal.SIGCONT)
            elif not self.outcome:
                os.kill(self.process, message.signal)

    def kill(self) -> None:
        """Ends its processes at once."""
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(self.process, signal.SIGKILL)
        if not self.outcome:  # it may not have made its group yet
            with suppress(ProcessLookupError):
                os.kill(self.process, signal.SIGKILL)

    def abandon(self) -> None:
        """The client is gone."""
        self.kill()
        for descriptor in self.streams:
            os.close(descriptor)
        self.streams.clear()


def begun(
    client: Connection, request: Request, given: tuple[int, ...], wanted: ProcessLimits | None
) -> RequestUnderWay:
    """Begins to carry out a request. Raises OSError where there can be no further process.

    Args:
        given: the descriptors of its standard streams, which are closed here; none where output comes back as text.
        wanted: the limits of the process.
    """
    pipes = [] if given else [os.pipe() for _ in _NAMES]
    closed_here = given or tuple(written for _, written in pipes)
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _HELD)
    try:
        process = os.fork()
        if not process:
            source = given[0] if given else None
            execute(request, (source, closed_here[-2], closed_here[-1]), wanted)
    except OSError:
        for read, _ in pipes:
            os.close(read)
        raise
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        for descriptor in closed_here:
            os.close(descriptor)
    decoder = codecs.getincrementaldecoder("utf-8")
    streams: dict[int, tuple[str, codecs.IncrementalDecoder]] = {
        read: (name, decoder("replace")) for name, (read, _) in zip(_NAMES, pipes, strict=False)
    }
    return RequestUnderWay(client, request.id, process, streams)
