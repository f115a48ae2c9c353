"""From a capture to its submessages, piece by piece."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import BinaryIO

from tachk.xrce.datagrams import datagrams
from tachk.xrce.messages import Endpoint, MessageReader
from tachk.xrce.packets import CaptureError, read_packets
from tachk.xrce.submessages import Submessages, submessages


class CaptureDecoder:
    """Attributes:
    packets: how many have been read.
    time: of the last one, in nanoseconds since the epoch.
    problem: why the capture ends too early; empty if it does not, or is not known to.
    """

    def __init__(self, stream: BinaryIO, ports: Iterable[int]) -> None:
        self._stream = stream
        self._messages = MessageReader(ports)
        self.packets = 0
        self.time = 0
        self.problem = ""

    @property
    def endpoints(self) -> list[Endpoint]:
        """The endpoints that sent or received, by number."""
        return self._messages.endpoints

    def pieces(self) -> Iterator[Submessages]:
        """The datagrams to or from the ports of Agents, at last those that TCP has not completed.

        Raises CaptureError for what is not a capture.
        """
        try:
            for packets in read_packets(self._stream):
                if len(packets.times):
                    self.packets = packets.first + len(packets.times) - 1
                    self.time = int(packets.times[-1])
                yield submessages(self._messages.read(datagrams(packets)))
        except CaptureError as error:
            if not self.packets:
                raise
            self.problem = str(error)
        yield submessages(self._messages.close())
