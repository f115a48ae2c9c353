"""From a run of a model to rules that make the network do the same.

Each packet is known by its kind, its way and its count, from the first sample on. What the model loses is dropped. What
it delivers must not reach the receiver before what the receiver has sent and got earlier in the run: a packet is held
until that has passed. Who holds all packets so lets both ends see what they see in the run, as long as they send the
same; the times in between are those of the real network. Holding is left out where the order is not a choice of the
network: an answer comes after what it answers, and packets that nobody holds do not overtake each other.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.span import Source, Span
from tachk.xrce.proxy.rules import Chosen, ChosenPackets, PacketDirection, RelayAction, RelayRule, RuleWindow
from tachk.xrce.proxy.run_of_model import Happening, ModelMessage, ModelRun
from tachk.xrce.wire import SubmessageKind

_OTHER: Final = {
    PacketDirection.TO_AGENT: PacketDirection.TO_CLIENT,
    PacketDirection.TO_CLIENT: PacketDirection.TO_AGENT,
}


def rules_of(run: ModelRun, ports: Sequence[int], name: str) -> tuple[RelayRule, ...]:
    """Rules that make a network lose, hold and duplicate what the run does.

    Args:
        run: the run.
        ports: where the relay listens: for the clients of the model, or for those that occur in the run, in their
            order, and then for others.
        name: of the file that holds the run.

    Raises UsageError for too few ports.
    """
    rules: list[RelayRule] = []
    nowhere = Source(name, "")
    for client, port in _ports(run, ports).items():
        own = [happening for happening in run.happenings if happening.message.client == client]
        rules += _ClientMessages(own, port if len(ports) > 1 else None, Span(nowhere, 0, 0)).rules()
    return tuple(rules)


def _ports(run: ModelRun, ports: Sequence[int]) -> Mapping[int, int]:
    occurring = sorted({happening.message.client for happening in run.happenings})
    if len(ports) >= run.clients:
        return dict(zip(range(run.clients), ports, strict=False))
    if len(ports) == len(occurring):
        return dict(zip(occurring, ports, strict=True))
    raise UsageError(
        f"the run has {len(occurring)} clients, and the relay listens for {len(ports)}",
        "give one --listen for each client, in the order of the model",
    )


class _ClientMessages:
    """The fates of the messages of one client.

    Attributes:
        before: by index, what comes before in any network that obeys the rules so far, as indices.
        held: the messages that a rule delays.
    """

    def __init__(self, happenings: Sequence[Happening], port: int | None, span: Span) -> None:
        self.happenings = happenings
        self.port = port
        self.span = span
        self.before: list[set[int]] = []
        self.held: set[ModelMessage] = set()
        self.sent_at = {one.message: index for index, one in enumerate(happenings) if one.sent}
        samples = [
            one.message for one in happenings if one.message.kind in (SubmessageKind.WRITE_DATA, SubmessageKind.DATA)
        ]
        writes = any(message.kind is SubmessageKind.WRITE_DATA for message in samples)
        self.since = ChosenPackets(SubmessageKind.WRITE_DATA if writes else SubmessageKind.DATA) if samples else None

    def rules(self) -> list[RelayRule]:
        drops, waits = [], []
        under_way: dict[ModelMessage, None] = {}
        copied: set[ModelMessage] = set()
        for index, happening in enumerate(self.happenings):
            message = happening.message
            self.before.append(self.certain(index))
            if happening.lost:
                drops.append(RelayRule(RelayAction.DROP, self.chosen(message, self.port), self.span))
            elif happening.sent:
                under_way[message] = None
            else:
                if not happening.stays:
                    under_way.pop(message, None)
                action = (
                    RelayAction.DUPLICATE if message in copied or message not in self.sent_at else RelayAction.DELAY
                )
                waits += self.wait(index, message, action, self.before[index])
                if happening.stays:
                    copied.add(message)
        for message in under_way:  # which come after all that the run shows
            if message not in copied:
                sent = self.sent_at[message]
                waits += self.wait(len(self.happenings), message, RelayAction.DELAY, {sent, *self.before[sent]})
        return drops + waits

    def certain(self, index: int) -> set[int]:
        """The events before an event in any network."""
        happening = self.happenings[index]
        message = happening.message
        causes: list[int] = []
        if not happening.sent:
            causes += [self.sent_at[message]] if message in self.sent_at else []
        else:
            causes += [self.sent_at[one] for one in [_one_before(message)] if one in self.sent_at]
            if message.kind is SubmessageKind.ACKNACK:
                causes += self.answered(index)
        return {found for cause in causes for found in (cause, *self.before[cause])}

    def answered(self, index: int) -> list[int]:
        """The deliveries to a sender directly before it sends."""
        way = self.happenings[index].message.way
        for earlier in range(index - 1, -1, -1):
            one = self.happenings[earlier]
            if one.sent and one.message.way is way:
                return []
            if not one.sent and one.message.way is not way:
                return [earlier]
        return []

    def wait(self, index: int, message: ModelMessage, action: RelayAction, before: set[int]) -> list[RelayRule]:
        """Holds a message until all has passed that its receiver sends and gets before this index.

        Args:
            before: what comes before without this rule; with it, at the end.
        """
        needed = self.needed(index, message, before)
        for other in needed:
            before |= {other, *self.before[other]}
        if action is RelayAction.DELAY:
            if not needed:
                return []
            self.held.add(message)
        events = tuple(self.chosen(self.happenings[other].message) for other in needed)
        return [RelayRule(action, self.chosen(message, self.port), self.span, wait=RuleWindow(events=events))]

    def needed(self, index: int, message: ModelMessage, before: set[int]) -> list[int]:
        """The events to wait for: those before the index that are neither certain nor implied."""
        last: dict[tuple[bool, SubmessageKind], int] = {}
        for earlier, one in enumerate(self.happenings[:index]):
            if one.sent and one.message.way is _OTHER[message.way]:
                last[(True, one.message.kind)] = earlier
            elif _is_delivery_before(one, message):
                last[(False, message.kind)] = earlier
        wanted = [earlier for earlier in sorted(last.values(), reverse=True) if not self.is_natural(earlier, message)]
        wanted = [earlier for earlier in wanted if earlier not in before]
        implied = {found for earlier in wanted for found in self.before[earlier]}
        return [earlier for earlier in wanted if earlier not in implied]

    def is_natural(self, earlier: int, message: ModelMessage) -> bool:
        """True if a delivery comes before that of the message because it was sent before it and is not held."""
        one = self.happenings[earlier]
        sent = self.sent_at.get(one.message)
        if one.sent or sent is None or message not in self.sent_at:
            return False
        return one.message not in self.held and sent < self.sent_at[message]

    def chosen(self, message: ModelMessage, port: int | None = None) -> Chosen:
        packets = ChosenPackets(message.kind, way=message.way, port=port)
        if message.kind is SubmessageKind.CREATE_CLIENT:
            return Chosen(packets)
        return Chosen(packets, message.count, message.count, self.since)


def _one_before(message: ModelMessage) -> ModelMessage:
    return ModelMessage(message.client, message.way, message.kind, message.count - 1)


def _is_delivery_before(one: Happening, message: ModelMessage) -> bool:
    """True if a packet waits for this delivery. A second CREATE_CLIENT waits for the same as the packets after it."""
    other = one.message
    return (
        not one.sent
        and other.way is message.way
        and other != message
        and other.kind is not SubmessageKind.CREATE_CLIENT
    )
