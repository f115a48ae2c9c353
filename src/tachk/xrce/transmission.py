"""A message on its way: who sent it, when, and whether it arrived."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from tachk.base.records import dataclass
from tachk.xrce.events import SubmessageEvent
from tachk.xrce.messages import Endpoint
from tachk.xrce.wire import SubmessageKind


@dataclass(frozen=True, slots=True)
class Link:
    """The way between a client and the Agent.

    Attributes:
        client: its endpoint, at the side of the client.
        agent: the Agent's, at the side of the Agent.
        key: of the client, as its CREATE_CLIENT says; empty if that is not in the capture.
        relay: the endpoint that the client takes for the Agent where both sides of a relay are recorded.
    """

    client: Endpoint
    agent: Endpoint
    key: str
    relay: Endpoint | None

    @property
    def name(self) -> str:
        return f"client {self.key}" if self.key else f"client {self.client}"


@dataclass(frozen=True, slots=True)
class TransmissionArrival:
    """``time`` in nanoseconds since the epoch, ``packet`` the number in the capture."""

    time: int
    packet: int


class Transmission(Protocol):
    """A message that was sent once."""

    @property
    def link(self) -> int:
        """The index of its link."""

    @property
    def to_agent(self) -> bool:
        """Whether the client sent it."""

    @property
    def sent(self) -> int:
        """When it left its sender, in nanoseconds since the epoch."""

    @property
    def packet(self) -> int:
        """In which packet."""

    @property
    def arrivals(self) -> tuple[TransmissionArrival, ...] | None:
        """Where it was seen behind the relay, several times if it was duplicated, never if it was lost; None if nobody
        looked."""

    @property
    def events(self) -> Sequence[SubmessageEvent]:
        """Its submessages."""

    @property
    def kinds(self) -> frozenset[SubmessageKind | None]:
        """Those of its submessages."""

    @property
    def is_reliable(self) -> bool:
        """True if its number is acknowledged."""

    @property
    def is_lost(self) -> bool: ...

    @property
    def is_observed(self) -> bool:
        """True if somebody looked whether it arrived."""

    @property
    def arrived(self) -> int:
        """The time of its arrival, if that is known; of a lost one the time when it was sent."""


@dataclass(frozen=True, slots=True)
class ReadTransmission:
    """A `Transmission` with all that it has."""

    link: int
    to_agent: bool
    sent: int
    packet: int
    arrivals: tuple[TransmissionArrival, ...] | None
    events: tuple[SubmessageEvent, ...]

    @property
    def kinds(self) -> frozenset[SubmessageKind | None]:
        return frozenset(event.kind for event in self.events)

    @property
    def is_reliable(self) -> bool:
        return any(event.is_reliable for event in self.events)

    @property
    def is_lost(self) -> bool:
        return self.arrivals == ()

    @property
    def is_observed(self) -> bool:
        return self.arrivals is not None

    @property
    def arrived(self) -> int:
        return self.arrivals[0].time if self.arrivals else self.sent
