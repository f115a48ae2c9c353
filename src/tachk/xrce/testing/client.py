"""A real client as the system under test: the test is its network and its Agent."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.conformance.events import Cell
from tachk.simulation.testing.arrivals import Arrival
from tachk.simulation.testing.event_lines import READY, event_line, line_output, read_line
from tachk.simulation.testing.program_system import StreamedProgram
from tachk.simulation.testing.system_adapter import SeenOutput
from tachk.xrce.bridge.packets import Translator
from tachk.xrce.bridge.session import AgentSession
from tachk.xrce.testing.packet_socket import Address, PacketSocket
from tachk.xrce.testing.peer import (
    ARRIVED,
    PACKET,
    PROGRAM,
    TO_AGENT,
    TO_CLIENT,
    ProgramBySocket,
    command_with_port,
    sent_events,
    start_deadline,
    word_of,
)


class TestedClient(ProgramBySocket):
    """A program with a client. The test answers its set-up; the model starts when the program says that it is ready."""

    __test__ = False  # pytest takes it for a test

    def __init__(self, command: str, nanoseconds: Fraction) -> None:
        """Args: nanoseconds: of a unit of the model."""
        socket = PacketSocket()
        try:
            program = StreamedProgram(command_with_port(command, socket.port))
        except UsageError:
            socket.close()
            raise
        super().__init__(program, socket, nanoseconds)
        self._session = AgentSession()
        self._peer: Address | None = None

    def start(self) -> None:
        self.program.spawn()
        self.program.read_into(self.arrivals, PROGRAM)
        self.socket.read_into(self._take)
        deadline, ready = start_deadline(), None
        while ready is None:
            arrival = self.arrivals.next(deadline)
            if arrival is None:
                raise self.program.not_ready()
            if arrival.source == PACKET:
                self._answer(arrival)
            elif read_line(arrival.octets)[0] == READY:
                ready = arrival
        if not self._session.is_open or self._peer is None:
            raise UsageError(
                f"{self.program.command[0]} is ready, but it has created nothing at port {self.socket.port}",
                "let it say so when the Agent has confirmed its objects",
            )
        self._translator = Translator(False, self._session.before)
        self.begin(ready.moment)

    def _take(self, moment: int, octets: bytes, address: Address) -> None:
        if self._peer is None:
            self._peer = address
        if address == self._peer:
            self.arrivals.put(moment, octets, PACKET)

    def _answer(self, arrival: Arrival) -> None:
        assert self._peer is not None
        for octets in self._session.arrived(arrival.octets, time.monotonic_ns()):
            self.socket.send(octets, self._peer)

    def send(self, name: str, cells: Mapping[str, Cell]) -> Fraction:
        if name == ARRIVED:
            assert self._peer is not None
            octets = self._translator.packet(word_of(name, cells, TO_CLIENT))
            return self.units(self.socket.send(octets, self._peer))
        moment = time.monotonic_ns()
        self.program.write(event_line(name, cells))
        return self.units(moment)

    def outputs(self, arrival: Arrival) -> Iterator[SeenOutput]:
        moment = self.units(arrival.moment)
        if arrival.source == PROGRAM:
            yield line_output(arrival.octets, moment)
        elif moment >= 0:  # what is older belongs to the set-up
            yield from sent_events(arrival.octets, self._translator, TO_AGENT, moment)
