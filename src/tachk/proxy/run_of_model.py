"""The packets of a run of an XRCE model, from the report of `tachk verify --format json`.

The model speaks through the channels of `models/lib/messages.ta`, ``send[link][kind]`` and ``deliver[link][kind]``;
``created_again`` is a second CREATE_CLIENT that reaches the Agent. What a link loses it counts in ``losses``, what it
duplicates in ``copies``.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, Final

from tachk.diagnostics.diagnostic import UsageError
from tachk.proxy.rules import Way
from tachk.records import dataclass
from tachk.xrce.wire import Kind

_CHANNEL: Final = re.compile(r"(send|deliver)\[(\w+)\]\[(\w+)\]")
_UP, _DOWN = "_UP", "_DOWN"
_AGAIN: Final = "created_again"
_KINDS: Final = {
    "DATA": (Kind.WRITE_DATA, Kind.DATA),
    "HEARTBEAT": (Kind.HEARTBEAT, Kind.HEARTBEAT),
    "ACKNACK": (Kind.ACKNACK, Kind.ACKNACK),
    "READ": (Kind.READ_DATA, None),
    "ACCEPT": (None, Kind.ACKNACK),
    "PING": (Kind.GET_INFO, None),
}
"""What the kinds of messages of `models/micro_xrce_dds/protocol.ta` are on the wire: to the Agent, to the client."""


@dataclass(frozen=True, slots=True)
class Message:
    """A message of a run.

    Attributes:
        client: the name of the link without its direction, such as PUB.
        way: where it goes.
        kind: what it is on the wire.
        count: which one of this kind on this way, from 1.
    """

    client: str
    way: Way
    kind: Kind
    count: int


@dataclass(frozen=True, slots=True)
class Happening:
    """A message is sent, lost at once, or delivered; a copy of it may stay under way."""

    message: Message
    sent: bool
    lost: bool = False
    stays: bool = False


@dataclass(frozen=True, slots=True)
class ModelRun:
    """What happens to messages, in the order of time; ``clients`` of the model, in its order."""

    clients: tuple[str, ...]
    happenings: tuple[Happening, ...]


def read_run(document: object, name: str, prop: str | None = None) -> ModelRun:
    """The run that shows a property false.

    Args:
        document: the report.
        name: what messages call it.
        prop: which property; None where one has a run.

    Raises UsageError for what is no such report, or tells of no message.
    """
    constants, trace = _trace(document, name, prop)
    reading = _Reading(constants)
    for state in trace:
        transition = state.get("transition")
        changes = state.get("variables", {})
        if transition is not None:
            reading.step(transition, changes)
        reading.values.update({key: changes[key] for key in ("losses", "copies") if key in changes})
    if not reading.happenings:
        raise UsageError(f"{name}: no message is sent in the run", "it should be a run of a model that uses models/lib")
    return ModelRun(reading.clients, tuple(reading.happenings))


def _trace(document: object, name: str, prop: str | None) -> tuple[Mapping[str, int], list[dict[str, Any]]]:
    how = "tachk verify MODEL --property NAME --format json -o TRACE.json makes one"
    runs = document.get("runs") if isinstance(document, dict) else None
    if not isinstance(runs, list):
        raise UsageError(f"{name} is no report of tachk verify", how)
    try:
        found = {
            result["name"]: (run["constants"], result["trace"])
            for run in runs
            for result in run["results"]
            if result["trace"]
        }
    except (KeyError, TypeError, AttributeError):
        raise UsageError(f"{name} is no report of tachk verify", how) from None
    if not found:
        raise UsageError(f"{name} has no run of a model: no property is shown false, no state is found in it", how)
    names = ", ".join(found)
    if prop is None and len(found) > 1:
        raise UsageError(f"{name} has several runs", f"choose one with --property: {names}")
    if prop is not None and prop not in found:
        raise UsageError(f"{name} has no run for {prop}", f"it has runs for {names}")
    return found[next(iter(found)) if prop is None else prop]


class _Reading:
    def __init__(self, constants: Mapping[str, int]) -> None:
        links = sorted((value, link) for link, value in constants.items() if link.endswith((_UP, _DOWN)))
        self.links = {str(value): link for value, link in links}
        self.kinds = {str(constants[kind]): kind for kind in _KINDS if kind in constants}
        self.clients = tuple(dict.fromkeys(_client(link) for _, link in links))
        self.values: dict[str, int] = {}
        self.happenings: list[Happening] = []
        self.counts: dict[tuple[str, Way, Kind], int] = {}
        self.carried: dict[str, dict[Message, set[str]]] = {}
        """What is under way in a link, and which processes listened when it was sent."""
        self.owners: dict[str, str] = {}
        """The client that a process has had to do with."""

    def step(self, transition: Mapping[str, Any], changes: Mapping[str, int]) -> None:
        channel = str(transition["channel"])
        processes = [part["process"] for part in transition["participants"]]
        senders = [part["process"] for part in transition["participants"] if part["role"] == "sends"]
        listeners = [process for process in processes if process not in senders]
        if channel == _AGAIN:
            owners = {self.owners[process] for process in processes if process in self.owners}
            for client in sorted(owners, key=self.clients.index):
                self.happenings.append(Happening(self.message(client, Way.TO_AGENT, Kind.CREATE_CLIENT), False))
            return
        found = _CHANNEL.fullmatch(channel)
        if found is None:
            return
        link, name = self.links.get(found[2], found[2]), self.kinds.get(found[3], found[3])
        client, is_up = _client(link), link.endswith(_UP)
        way = Way.TO_AGENT if is_up else Way.TO_CLIENT
        kind = _KINDS.get(name, (None, None))[0 if is_up else 1]
        if kind is None or not link.endswith((_UP, _DOWN)):
            raise UsageError(f"{channel}: it is not known which packets this stands for", _known())
        if found[1] == "send":
            self.owners.update(dict.fromkeys(senders, client))
            self.sent(self.message(client, way, kind), link, listeners, changes)
        else:
            self.owners.update(dict.fromkeys(listeners, client))
            self.delivered(kind, link, senders, changes)

    def message(self, client: str, way: Way, kind: Kind) -> Message:
        key = (client, way, kind)
        self.counts[key] = self.counts.get(key, 0) + 1
        return Message(client, way, kind, self.counts[key])

    def sent(self, message: Message, link: str, listeners: list[str], changes: Mapping[str, int]) -> None:
        lost = self.grows("losses", changes)
        self.happenings.append(Happening(message, True, lost))
        if not lost:
            self.carried.setdefault(link, {})[message] = {*listeners}

    def delivered(self, kind: Kind, link: str, carriers: list[str], changes: Mapping[str, int]) -> None:
        """The message that the carrier has taken first leaves; a model may hide which one carries it."""
        under_way = self.carried.get(link, {})
        fitting = (one for one in under_way if one.kind is kind and under_way[one].issuperset(carriers))
        message = next(fitting, None)
        if message is None:
            raise UsageError(f"the link {link} delivers {kind.name} that nobody has sent")
        stays = self.grows("copies", changes)
        if not stays:
            del under_way[message]
        self.happenings.append(Happening(message, False, stays=stays))

    def grows(self, name: str, changes: Mapping[str, int]) -> bool:
        return changes.get(name, 0) > self.values.get(name, 0)


def _client(link: str) -> str:
    return link.removesuffix(_UP).removesuffix(_DOWN)


def _known() -> str:
    return f"links are constants that end in {_UP} and {_DOWN}, kinds of messages are {', '.join(_KINDS)}"
