"""The packets of a run of an XRCE model, from the report of `tachk verify --format json`.

The model speaks through the channels of `models/lib/messages.ta`, ``send[link][kind]`` and ``deliver[link][kind]``;
client c sends on the link 2 * c and gets what comes on 2 * c + 1. ``created_again[c]`` is one more CREATE_CLIENT of
this client that reaches the Agent. What a link loses it counts in ``losses``, what it duplicates in ``copies``. A
message of a client that gets samples is taken for READ_DATA, that of another one for WRITE_DATA.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from typing import Any, Final

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.exact_numbers import is_whole
from tachk.base.records import dataclass
from tachk.xrce.proxy.rules import PacketDirection
from tachk.xrce.wire import SubmessageKind

_CHANNEL: Final = re.compile(r"(send|deliver)\[(\w+)\]\[(\w+)\]")
_AGAIN: Final = re.compile(r"created_again\[(\w+)\]")
_KINDS: Final = {
    "DATA": (SubmessageKind.WRITE_DATA, SubmessageKind.DATA),
    "HEARTBEAT": (SubmessageKind.HEARTBEAT, SubmessageKind.HEARTBEAT),
    "ACKNACK": (SubmessageKind.ACKNACK, SubmessageKind.ACKNACK),
    "PING": (SubmessageKind.GET_INFO, None),
}
"""The messages of `models/micro_xrce_dds/protocol.ta` on the wire: to the Agent, to the client."""

REPORT_WITH_RUN = "tachk verify MODEL --property NAME --format json -o TRACE.json makes one"
"""The command for a report with a run."""


@dataclass(frozen=True, slots=True)
class ModelMessage:
    """A message of a run.

    Attributes:
        client: its number.
        way: where it goes.
        kind: what it is on the wire.
        count: which one of this kind on this way, from 1.
    """

    client: int
    way: PacketDirection
    kind: SubmessageKind
    count: int


@dataclass(frozen=True, slots=True)
class Happening:
    """A message is sent, lost at once, or delivered; a copy of it may stay under way."""

    message: ModelMessage
    sent: bool
    lost: bool = False
    stays: bool = False


@dataclass(frozen=True, slots=True)
class ModelRun:
    """The fates of messages, in the order of time; ``clients``: how many the model has."""

    clients: int
    happenings: tuple[Happening, ...]


def read_run(document: object, name: str, prop: str | None = None) -> ModelRun:
    """The run that shows a property false.

    Args:
        document: the report.
        name: what messages call it.
        prop: which property; None where one has a run.

    Raises UsageError for what is no such report, or has no message.
    """
    return run_of_trace(*_trace(document, name, prop), name)


def run_of_trace(constants: Mapping[str, int], trace: Sequence[Mapping[str, Any]], name: str) -> ModelRun:
    """The packets of a run, from its states as reports have them. Raises UsageError where it has no message.

    Args:
        constants: of the model.
        name: what messages call it.
    """
    decoder = _RunDecoder(constants)
    for state in trace:
        transition = state.get("transition")
        changes = state.get("variables", {})
        if transition is not None:
            decoder.step(transition, changes)
        decoder.values.update({key: changes[key] for key in ("losses", "copies") if key in changes})
    if not decoder.happenings:
        raise UsageError(f"{name}: no message is sent in the run", "it should be a run of a model that uses models/lib")
    readers = {one.message.client for one in decoder.happenings if one.message.kind is SubmessageKind.DATA}
    return ModelRun(decoder.clients, tuple(_as_read(one, readers) for one in decoder.happenings))


def _trace(document: object, name: str, prop: str | None) -> tuple[Mapping[str, int], list[dict[str, Any]]]:
    runs = document.get("runs") if isinstance(document, dict) else None
    if not isinstance(runs, list):
        raise UsageError(f"{name} is not a report of tachk verify", REPORT_WITH_RUN)
    try:
        found = {
            result["name"]: (run["constants"], result["trace"])
            for run in runs
            for result in run["results"]
            if result["trace"]
        }
    except (KeyError, TypeError, AttributeError):
        raise UsageError(f"{name} is not a report of tachk verify", REPORT_WITH_RUN) from None
    if not found:
        raise UsageError(
            f"{name} has no run of a model: no property is shown false, no state is found in it", REPORT_WITH_RUN
        )
    names = ", ".join(found)
    if prop is None and len(found) > 1:
        raise UsageError(f"{name} has several runs", f"choose one with --property: {names}")
    if prop is not None and prop not in found:
        raise UsageError(f"{name} has no run for {prop}", f"it has runs for {names}")
    return found[next(iter(found)) if prop is None else prop]


def _as_read(happening: Happening, readers: Collection[int]) -> Happening:
    """The messages of a client that gets samples are requests for them."""
    message = happening.message
    if message.client not in readers or message.kind is not SubmessageKind.WRITE_DATA:
        return happening
    message = ModelMessage(message.client, message.way, SubmessageKind.READ_DATA, message.count)
    return Happening(message, happening.sent, happening.lost, happening.stays)


class _RunDecoder:
    def __init__(self, constants: Mapping[str, int]) -> None:
        self.constants = constants
        self.kinds = {str(constants[kind]): kind for kind in _KINDS if kind in constants}
        self.clients = constants.get("LINKS", 0) // 2
        self.values: dict[str, int] = {}
        self.happenings: list[Happening] = []
        self.counts: dict[tuple[int, PacketDirection, SubmessageKind], int] = {}
        self.payload: dict[int, dict[ModelMessage, set[str]]] = {}
        """The messages under way in a link, and the processes that received when they were sent."""

    def step(self, transition: Mapping[str, Any], changes: Mapping[str, int]) -> None:
        channel = str(transition["channel"])
        if again := _AGAIN.fullmatch(channel):
            message = self.message(
                self.number(again[1], channel), PacketDirection.TO_AGENT, SubmessageKind.CREATE_CLIENT
            )
            self.happenings.append(Happening(message, False))
        elif found := _CHANNEL.fullmatch(channel):
            link, name = self.number(found[2], channel), self.kinds.get(found[3], found[3])
            kind = _KINDS.get(name, (None, None))[link % 2]
            if kind is None:
                raise UsageError(f"{channel}: it is not known which packets this stands for", _known())
            parts = transition["participants"]
            senders = {part["process"] for part in parts if part["role"] == "sends"}
            listeners = {part["process"] for part in parts} - senders
            if found[1] == "send":
                self.sent(kind, link, listeners, changes)
            else:
                self.delivered(kind, link, senders, changes)

    def number(self, name: str, channel: str) -> int:
        """The link, client or number of a name."""
        if not is_whole(name) and name not in self.constants:
            raise UsageError(f"{channel}: {name} is not a constant of the model")
        return int(name) if is_whole(name) else self.constants[name]

    def message(self, client: int, way: PacketDirection, kind: SubmessageKind) -> ModelMessage:
        key = (client, way, kind)
        self.counts[key] = self.counts.get(key, 0) + 1
        return ModelMessage(client, way, kind, self.counts[key])

    def sent(self, kind: SubmessageKind, link: int, listeners: set[str], changes: Mapping[str, int]) -> None:
        message = self.message(link // 2, PacketDirection.TO_CLIENT if link % 2 else PacketDirection.TO_AGENT, kind)
        lost = self.grows("losses", changes)
        self.happenings.append(Happening(message, True, lost))
        if not lost:
            self.payload.setdefault(link, {})[message] = listeners

    def delivered(self, kind: SubmessageKind, link: int, carriers: set[str], changes: Mapping[str, int]) -> None:
        """The message that the carrier has taken first leaves; a model may hide which one carries it."""
        under_way = self.payload.get(link, {})
        fitting = (one for one in under_way if one.kind is kind and under_way[one] >= carriers)
        message = next(fitting, None)
        if message is None:
            raise UsageError(f"link {link} delivers {kind.name} that was not sent")
        stays = self.grows("copies", changes)
        if not stays:
            del under_way[message]
        self.happenings.append(Happening(message, False, stays=stays))

    def grows(self, name: str, changes: Mapping[str, int]) -> bool:
        return changes.get(name, 0) > self.values.get(name, 0)


def _known() -> str:
    return f"kinds of messages are {', '.join(_KINDS)}"
