"""A real Agent as the system under test: the test is its network and a client that writes and reads one topic."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import Final

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.conformance.events import Cell
from tachk.simulation.testing.arrivals import Arrival
from tachk.simulation.testing.program_system import StreamedProgram
from tachk.simulation.testing.system_adapter import SeenOutput
from tachk.xrce.bridge.packets import Translator
from tachk.xrce.bridge.session import ClientSession
from tachk.xrce.testing.packet_socket import HOST, Address, PacketSocket, free_port
from tachk.xrce.testing.peer import (
    PACKET,
    PROGRAM,
    QUIET,
    TO_AGENT,
    TO_CLIENT,
    ProgramBySocket,
    command_with_port,
    sent_events,
    start_deadline,
    word_of,
)

_KEY: Final = b"tchk"
_TOPIC: Final = "Numbers"


class TestedAgent(ProgramBySocket):
    """A program with an Agent. The test sets a session up; the model starts when it is answered and nothing more comes.

    What the program writes is its log, and ignored.
    """

    __test__ = False  # pytest takes it for a test

    def __init__(self, command: str, nanoseconds: Fraction) -> None:
        """Args: nanoseconds: of a unit of the model."""
        self._agent: Address = HOST, free_port()
        program = StreamedProgram(command_with_port(command, self._agent[1]))
        super().__init__(program, PacketSocket(), nanoseconds)
        self._session = ClientSession(_KEY, _TOPIC, reads=True, writes=True)
        self._translator = Translator(True, self._session.before)

    def start(self) -> None:
        self.program.spawn()
        self.program.read_into(self.arrivals, PROGRAM)
        self.socket.read_into(self._take)
        deadline = start_deadline()
        while not self._session.is_open:
            now = time.monotonic_ns()
            self.check()
            if now > deadline:
                raise UsageError(
                    f"{self.program.command[0]} does not answer CREATE_CLIENT at port {self._agent[1]}",
                    "an Agent of eProsima is started with: MicroXRCEAgent udp4 -p {port} -m ced",
                )
            self._send(self._session.due(now))
            self._answer(self.arrivals.next(min(self._session.wake(), deadline)))
        while (arrival := self.arrivals.next(time.monotonic_ns() + QUIET)) is not None:
            self._answer(arrival)
        self.begin(time.monotonic_ns())

    def _take(self, moment: int, octets: bytes, address: Address) -> None:
        if address == self._agent:
            self.arrivals.put(moment, octets, PACKET)

    def _answer(self, arrival: Arrival | None) -> None:
        if arrival is not None and arrival.source == PACKET:
            self._send(self._session.arrived(arrival.octets, time.monotonic_ns()))

    def _send(self, packets: list[bytes]) -> None:
        for octets in packets:
            self.socket.send(octets, self._agent)

    def send(self, name: str, cells: Mapping[str, Cell]) -> Fraction:
        octets = self._translator.packet(word_of(name, cells, TO_AGENT))
        return self.units(self.socket.send(octets, self._agent))

    def outputs(self, arrival: Arrival) -> Iterator[SeenOutput]:
        if arrival.source == PACKET:
            yield from sent_events(arrival.octets, self._translator, TO_CLIENT, self.units(arrival.moment))
