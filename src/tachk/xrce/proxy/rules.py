"""Rules of a relay for packets. A rule in words is the input of `tachk.xrce.proxy.fault_plan`."""

from __future__ import annotations

from enum import Enum
from fractions import Fraction
from typing import Final

from tachk.base.records import dataclass
from tachk.base.span import Span
from tachk.base.time_units import NANOSECONDS
from tachk.xrce.wire import SubmessageKind

EVERY: Final = 1 << 62
"""As the last of a range of packets: no end."""


class PacketDirection(Enum):
    """The direction of a packet."""

    TO_AGENT = "client->agent"
    TO_CLIENT = "agent->client"


ONE_WAY: Final = {
    **dict.fromkeys(
        (
            SubmessageKind.CREATE_CLIENT,
            SubmessageKind.CREATE,
            SubmessageKind.DELETE,
            SubmessageKind.WRITE_DATA,
            SubmessageKind.READ_DATA,
        ),
        PacketDirection.TO_AGENT,
    ),
    **dict.fromkeys((SubmessageKind.RESET, SubmessageKind.TIMESTAMP), PacketDirection.TO_AGENT),
    **dict.fromkeys(
        (SubmessageKind.STATUS_AGENT, SubmessageKind.STATUS, SubmessageKind.DATA, SubmessageKind.TIMESTAMP_REPLY),
        PacketDirection.TO_CLIENT,
    ),
}
"""The kinds of submessages that go one way only."""

NUMBERED: Final = frozenset(
    {
        SubmessageKind.CREATE,
        SubmessageKind.DELETE,
        SubmessageKind.STATUS,
        SubmessageKind.INFO,
        SubmessageKind.GET_INFO,
        SubmessageKind.WRITE_DATA,
        SubmessageKind.READ_DATA,
        SubmessageKind.DATA,
    }
    | {SubmessageKind.FRAGMENT, SubmessageKind.ACKNACK, SubmessageKind.HEARTBEAT}
)
"""The kinds of submessages that have a number: that of their message, or the first that they speak of."""


@dataclass(frozen=True, slots=True)
class ChosenPackets:
    """Some packets.

    Attributes:
        kind: of a submessage in them; None for all packets.
        names_missing: only ACKNACKs that name a missing message.
        number: of the message in its stream; of ACKNACK and HEARTBEAT the first that they speak of.
        way: None for both.
        port: where the relay listens for the client; None for every client.
    """

    kind: SubmessageKind | None = None
    names_missing: bool = False
    number: int | None = None
    way: PacketDirection | None = None
    port: int | None = None

    def __str__(self) -> str:
        kind = "NACK" if self.names_missing else "packet" if self.kind is None else self.kind.name
        return " ".join(
            (
                kind,
                *(() if self.number is None else (str(self.number),)),
                *(() if self.way is None else (self.way.value,)),
                *(() if self.port is None else (f"on {self.port}",)),
            )
        )


@dataclass(frozen=True, slots=True)
class Chosen:
    """The packets that a rule is about, counted for each client.

    Attributes:
        packets: which are counted.
        first, last: the first and the last one by count, from 1.
        since: counting begins with the first of these; None: at once.
    """

    packets: ChosenPackets
    first: int = 1
    last: int = 1
    since: ChosenPackets | None = None

    def __str__(self) -> str:
        if self.last == EVERY:
            which = "every" if self.first == 1 else f"the {ordinal(self.first)} and every further"
        elif self.first == self.last:
            which = f"the {ordinal(self.first)}"
        else:
            which = f"the {ordinal(self.first)} to {ordinal(self.last)}"
        return f"{which} {self.packets}" + (f" since {self.since}" if self.since is not None else "")


@dataclass(frozen=True, slots=True)
class RuleWindow:
    """Between two times in nanoseconds, or until each of some packets has passed.

    A packet that goes the same way has passed when it has left the relay or is lost, one that goes the other way when
    it has come.
    """

    shortest: int = 0
    longest: int = 0
    events: tuple[Chosen, ...] = ()

    def __str__(self) -> str:
        if self.events:
            return " and ".join(map(str, self.events))
        return in_words(self.shortest) + (f" to {in_words(self.longest)}" if self.longest != self.shortest else "")


class RelayAction(Enum):
    """The action of a rule."""

    DROP = "drop"
    DELAY = "delay"
    DUPLICATE = "duplicate"


@dataclass(frozen=True, slots=True)
class RelayRule:
    """The rules for packets.

    Attributes:
        action: what happens to the packets.
        chosen: with which.
        share: how many of them, by chance; None for all.
        wait: how long they are held, or after how long their copy follows.
        begin, end: nanoseconds since the first packet of the client between which the rule counts and acts.
        span: where it stands.
    """

    action: RelayAction
    chosen: Chosen
    span: Span
    share: Fraction | None = None
    wait: RuleWindow = RuleWindow()
    begin: int = 0
    end: int = EVERY

    def __str__(self) -> str:
        chosen = self.chosen
        what = str(chosen)
        if self.share is not None:
            since = "" if chosen.since is None else f" since {chosen.since}"
            what = f"{_decimal(self.share * 100)} % of {chosen.packets}{since}"
        match self.action:
            case RelayAction.DROP:
                how = ""
            case RelayAction.DELAY:
                how = f" {'until' if self.wait.events else 'by'} {self.wait}"
            case RelayAction.DUPLICATE:
                how = f" after {self.wait}"
        when = f" between {in_words(self.begin)} and {in_words(self.end)}" if self.end != EVERY else ""
        return f"{self.action.value} {what}{how}{when}"


def ordinal(number: int) -> str:
    """``1st``, ``2nd``, ``11th``."""
    last = number % 10 if number % 100 not in (11, 12, 13) else 0
    return f"{number}{ {1: 'st', 2: 'nd', 3: 'rd'}.get(last, 'th') }"


def in_words(nanoseconds: int) -> str:
    """A time in the largest unit that gives a whole number, up to seconds."""
    unit = next(unit for unit in ("s", "ms", "us", "ns") if nanoseconds % NANOSECONDS[unit] == 0)
    return f"{nanoseconds // NANOSECONDS[unit]} {unit}"


def _decimal(number: Fraction) -> str:
    return str(number.numerator) if number.denominator == 1 else f"{float(number):g}"
