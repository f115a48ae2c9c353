"""A real client and a real Agent as the system under test: the test is the network between them."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import Final

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.conformance.events import Cell
from tachk.simulation.testing.arrivals import Arrival
from tachk.simulation.testing.event_lines import READY, event_line, line_output, read_line
from tachk.simulation.testing.program_system import StreamedProgram
from tachk.simulation.testing.real_time import RealTimeSystem
from tachk.simulation.testing.system_adapter import SeenOutput, SystemEndedError
from tachk.xrce.bridge.packets import ProtocolWord, Translator, submessages_of
from tachk.xrce.testing.packet_socket import HOST, Address, PacketSocket, free_port
from tachk.xrce.testing.peer import (
    ARRIVED,
    PROGRAM,
    QUIET,
    SECONDS_TO_END,
    TO_AGENT,
    TO_CLIENT,
    command_with_port,
    link_of,
    sent_events,
    start_deadline,
    word_of,
)

BETWEEN: Final = " -- "
_LOG, _FROM_CLIENT, _FROM_AGENT = "log", "client", "agent"


class TestedSession(RealTimeSystem):
    """A program with an Agent and one with a client. All packets of the set-up arrive; the model starts when the client
    is ready and nothing more comes. From then on a packet arrives when an input says so, or never.
    """

    __test__ = False  # pytest takes it for a test

    def __init__(self, commands: str, nanoseconds: Fraction) -> None:
        """Args:
            commands: of the Agent and of the client.
            nanoseconds: of a unit of the model.

        Raises UsageError for what is not two commands with ports."""
        super().__init__(nanoseconds)
        agent, between, client = commands.partition(BETWEEN)
        if not between:
            raise UsageError(
                f"`{commands}` are not two commands",
                f"write that of the Agent, `{BETWEEN.strip()}`, that of the client",
            )
        self._agent: Address = HOST, free_port()
        self._client: Address | None = None
        self._agent_program = StreamedProgram(command_with_port(agent, self._agent[1]))
        self._to_client, self._to_agent = PacketSocket(), PacketSocket()
        self._client_program = StreamedProgram(command_with_port(client, self._to_client.port))
        self._before = {TO_AGENT: 0, TO_CLIENT: 0}
        self._passing: dict[tuple[int, ProtocolWord], bytes] = {}

    def start(self) -> None:
        for program, source in ((self._agent_program, _LOG), (self._client_program, PROGRAM)):
            program.spawn()
            program.read_into(self.arrivals, source)
        self._to_client.read_into(self._take_from_client)
        self._to_agent.read_into(self._take_from_agent)
        deadline, is_ready = start_deadline(), False
        while not is_ready:
            arrival = self.arrivals.next(deadline)
            if arrival is None:
                raise self._client_program.not_ready()
            is_ready = arrival.source == PROGRAM and read_line(arrival.octets)[0] == READY
            self._pass_on(arrival)
        while (arrival := self.arrivals.next(time.monotonic_ns() + QUIET)) is not None:
            self._pass_on(arrival)
        to_agent, to_client = self._before[TO_AGENT], self._before[TO_CLIENT]
        self._translators = {
            TO_AGENT: Translator(False, (to_client, to_agent)),
            TO_CLIENT: Translator(True, (to_agent, to_client)),
        }
        self.begin(time.monotonic_ns())

    def _take_from_client(self, moment: int, octets: bytes, address: Address) -> None:
        if self._client is None:
            self._client = address
        if address == self._client:
            self.arrivals.put(moment, octets, _FROM_CLIENT)

    def _take_from_agent(self, moment: int, octets: bytes, address: Address) -> None:
        if address == self._agent:
            self.arrivals.put(moment, octets, _FROM_AGENT)

    def _pass_on(self, arrival: Arrival) -> None:
        """A packet of the set-up arrives."""
        if arrival.source not in (_FROM_CLIENT, _FROM_AGENT):
            return
        link = TO_AGENT if arrival.source == _FROM_CLIENT else TO_CLIENT
        self._send(arrival.octets, link)
        for event in submessages_of(arrival.octets):
            if event.is_reliable and event.sequence is not None:
                self._before[link] = max(self._before[link], event.sequence + 1)

    def _send(self, octets: bytes, link: int) -> int:
        if link == TO_AGENT:
            return self._to_agent.send(octets, self._agent)
        assert self._client is not None
        return self._to_client.send(octets, self._client)

    def send(self, name: str, cells: Mapping[str, Cell]) -> Fraction:
        if name == ARRIVED:
            link = link_of(name, cells)
            word = word_of(name, cells, link)
            if (link, word) not in self._passing:
                raise UsageError(f"the model lets a packet arrive that was not sent: {dict(cells)}")
            return self.units(self._send(self._passing[link, word], link))
        moment = time.monotonic_ns()
        self._client_program.write(event_line(name, cells))
        return self.units(moment)

    def outputs(self, arrival: Arrival) -> Iterator[SeenOutput]:
        moment = self.units(arrival.moment)
        if arrival.source == PROGRAM:
            yield line_output(arrival.octets, moment)
        elif arrival.source != _LOG:
            link = TO_AGENT if arrival.source == _FROM_CLIENT else TO_CLIENT
            words = list(self._translators[link].words(arrival.octets))
            if len(words) > 1:
                raise SystemEndedError("a packet has several messages, which the automata send one by one")
            for word in words:
                self._passing[link, word] = arrival.octets
            yield from sent_events(arrival.octets, self._translators[link], link, moment)

    def check(self) -> None:
        for program in (self._client_program, self._agent_program):
            if program.is_over(self.arrivals):
                raise program.ended()
        if self.arrivals.is_over:
            raise SystemEndedError("the client or the Agent has closed its standard output")

    def waited(self) -> Fraction:
        return self.duration(self._client_program.waited() + self._agent_program.waited())

    def close(self) -> None:
        self._client_program.end(SECONDS_TO_END)
        self._agent_program.end(SECONDS_TO_END)
        self._to_client.close()
        self._to_agent.close()

    def abandon(self) -> None:
        self.close()
