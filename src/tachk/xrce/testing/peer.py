"""What the systems under test of DDS-XRCE have in common: a command with a port, and packets as events.

The events of packets are those of captures (`tachk.xrce.conformance.packet_events`) without the client, since there is
one only: ``sent(link, kind, number, detail)`` leaves a real program, ``arrived(link, kind, number, detail)`` reaches
one. What the client sends is on link 0, what the Agent sends on link 1. Numbers count from the end of the set-up, which
the models leave out. All other events are lines of JSON on the standard streams of the program.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import Final

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.conformance.events import Cell
from tachk.simulation.testing.program_system import StartedProgram, StreamedProgram, command_of
from tachk.simulation.testing.system_adapter import SeenOutput
from tachk.xrce.bridge.packets import KINDS, ProtocolWord, Translator, submessages_of
from tachk.xrce.testing.packet_socket import PacketSocket

ARRIVED: Final = "arrived"
SENT: Final = "sent"
TO_AGENT, TO_CLIENT = 0, 1
PORT: Final = "{port}"
PROGRAM, PACKET = "program", "packet"
QUIET: Final = 100_000_000
"""Nanoseconds without a packet after which the set-up is taken to be over."""
SECONDS_TO_END: Final = 0.1
_SECONDS_TO_BEGIN: Final = 30


class ProgramBySocket(StartedProgram):
    """What a real client and a real Agent have in common: a program, and the socket by which the test speaks to it."""

    def __init__(self, program: StreamedProgram, socket: PacketSocket, nanoseconds: Fraction) -> None:
        """Args: nanoseconds: of a unit of the model."""
        super().__init__(program, nanoseconds)
        self.socket = socket

    def close(self) -> None:
        self.program.end(SECONDS_TO_END)
        self.socket.close()

    def abandon(self) -> None:
        self.close()


def command_with_port(text: str, port: int) -> list[str]:
    """The words of a command, with the port in place of ``{port}``. Raises UsageError for one without it."""
    words = command_of(text)
    if not any(PORT in word for word in words):
        raise UsageError(
            f"the command `{text}` does not say where the port of the test goes", f"write {PORT} in its place"
        )
    return [word.replace(PORT, str(port)) for word in words]


def start_deadline() -> int:
    """The moment of `time.monotonic_ns` at which the set-up must be over."""
    return time.monotonic_ns() + _SECONDS_TO_BEGIN * 10**9


def word_of(name: str, cells: Mapping[str, Cell], link: int) -> ProtocolWord:
    """The message of an input. Raises UsageError for one that is on another link or says no message."""
    try:
        word = ProtocolWord(int(cells["kind"]), int(cells["number"]), int(cells["detail"]))
        known = int(cells["link"]) == link and 0 <= word.kind < len(KINDS)
    except (KeyError, ValueError):
        known = False
    if not known:
        raise UsageError(
            f"the model sends `{name}` with {dict(cells)}, which is no message to this program",
            f"visible arrive[link][kind] as {ARRIVED}(link, kind, number, detail), with link = {link}",
        )
    return word


def link_of(name: str, cells: Mapping[str, Cell]) -> int:
    """The link of an input. Raises UsageError for one that does not say it."""
    if cells.get("link") not in (TO_AGENT, TO_CLIENT):
        raise UsageError(f"the model sends `{name}` with {dict(cells)}, which does not say the link, 0 or 1")
    return int(cells["link"])


def sent_events(octets: bytes, translator: Translator, link: int, time: Fraction) -> Iterator[SeenOutput]:
    """The outputs in a packet of a program; what the models have no word for is named as DDS-XRCE does."""
    words = list(translator.words(octets))
    for word in words:
        cells: dict[str, Cell] = {"link": link, "kind": word.kind, "number": word.number, "detail": word.detail}
        yield SeenOutput(time, SENT, cells)
    if not words:
        kinds = [event.kind for event in submessages_of(octets)]
        for kind in kinds or [None]:
            yield SeenOutput(time, "malformed packet" if kind is None else kind.name, {})
