"""The sequence chart of a capture of DDS-XRCE, in the words of the protocol."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction

from tachk.model.quantity import ranges
from tachk.report.drawing.sequence.chart import Category, Chart, Message, Moment, Phase
from tachk.xrce.events import SubmessageEvent
from tachk.xrce.measuring.sleeps import sleeps
from tachk.xrce.report.text import event_to_text
from tachk.xrce.transmission import Transmission
from tachk.xrce.transmissions import Capture
from tachk.xrce.wire import SubmessageKind

_CATEGORIES = {
    SubmessageKind.WRITE_DATA: Category.DATA,
    SubmessageKind.DATA: Category.DATA,
    SubmessageKind.FRAGMENT: Category.DATA,
    SubmessageKind.ACKNACK: Category.ANSWER,
    SubmessageKind.HEARTBEAT: Category.HEARTBEAT,
}


def chart_of_capture(recording: Capture, name: str) -> Chart:
    """Clients on both sides of their Agent, those that write on the left, and milliseconds since the first message.

    Args:
        name: of the capture.
    """
    lifelines, clients, agents = _lifelines(recording)
    chart_of_capture = _CaptureChart(recording.begin)
    events = []
    for one in recording.transmissions:
        ends = clients[one.link], agents[one.link]
        sender, receiver = ends if one.to_agent else ends[::-1]
        events.append(chart_of_capture.message(one, sender, receiver))
    events.sort(key=lambda message: message.sent)
    phases = tuple(
        Phase(
            clients[sleep.link],
            Moment(chart_of_capture.milliseconds(sleep.begin)),
            Moment(chart_of_capture.milliseconds(sleep.end)),
            "silent: asleep or out of reach",
        )
        for sleep in sleeps(recording)
    )
    lost = sum(one.is_lost for one in recording.transmissions)
    known = "" if any(link.relay for link in recording.links) else "; what was lost is not known"
    description = f"{len(events)} messages between {len(clients)} clients and their Agent, {lost} of them lost{known}"
    return Chart(name, description, "ms", lifelines, tuple(events), phases)


def _lifelines(recording: Capture) -> tuple[tuple[str, ...], list[int], list[int]]:
    """Names from left to right, and where the client and the Agent of each link stand."""
    writing = [_writes(recording, number) for number in range(len(recording.links))]
    left = [number for number, writes in enumerate(writing) if writes] or [0][: len(writing)]
    right = [number for number in range(len(writing)) if number not in left]
    known = list(dict.fromkeys(link.agent for link in recording.links))
    names = [recording.links[number].name for number in left]
    names += ["Agent"] if len(known) == 1 else [f"Agent {agent}" for agent in known]
    names += [recording.links[number].name for number in right]
    places = {number: place for place, number in enumerate(left)}
    places |= {number: len(left) + len(known) + place for place, number in enumerate(right)}
    agents = [len(left) + known.index(link.agent) for link in recording.links]
    return tuple(_distinguished(names)), [places[number] for number in range(len(writing))], agents


def _distinguished(names: Sequence[str]) -> Iterator[str]:
    """Several connections of one client get numbers."""
    often = Counter(names)
    seen: Counter[str] = Counter()
    for name in names:
        seen[name] += 1
        yield f"{name} ({seen[name]})" if often[name] > 1 else name


def _writes(recording: Capture, link: int) -> bool:
    return any(
        event.kind is SubmessageKind.WRITE_DATA
        for one in recording.transmissions
        if one.link == link
        for event in one.events
    )


class _CaptureChart:
    """Makes messages of a chart from those of a capture."""

    def __init__(self, begin: int) -> None:
        self._begin = begin
        self._sent: set[tuple[int, bool, int, int]] = set()

    def milliseconds(self, time: int) -> Fraction:
        return Fraction(time - self._begin, 10**6)

    def message(self, one: Transmission, sender: int, receiver: int) -> Message:
        arrivals: Iterable[Moment]
        if one.arrivals is None:
            arrivals = (Moment(self.milliseconds(one.sent), one.packet),)
        else:
            arrivals = (Moment(self.milliseconds(arrival.time), arrival.packet) for arrival in one.arrivals)
        first = one.events[0]
        detail = "\n".join(" ".join(event_to_text(event, self._begin).split()) for event in one.events)
        return Message(
            sender,
            (receiver,),
            Moment(self.milliseconds(one.sent), one.packet),
            tuple(arrivals),
            label_of(one.events),
            detail,
            Category.OTHER if first.kind is None else _CATEGORIES.get(first.kind, Category.OTHER),
            self._is_repeated(one, first),
            str(one.packet),
            one.is_lost,
        )

    def _is_repeated(self, one: Transmission, first: SubmessageEvent) -> bool:
        if first.kind is SubmessageKind.CREATE_CLIENT:
            self._sent = {sent for sent in self._sent if sent[0] != one.link}
        if not first.is_reliable or first.stream is None or first.sequence is None:
            return False
        number = one.link, one.to_agent, first.stream, first.sequence
        known = number in self._sent
        self._sent.add(number)
        return known


def label_of(events: Sequence[SubmessageEvent]) -> str:
    """A message in a few words: kinds, the number, what is missing or held."""
    first = events[0]
    if first.kind is None:
        return "malformed"
    if first.kind is SubmessageKind.ACKNACK and len(events) == 1:
        missing = first.fields["missing"]
        chart_of_capture = f" missing {ranges(missing)}" if isinstance(missing, list) and missing else ""
        return f"ACKNACK {first.fields['first']}{chart_of_capture}"
    if first.kind is SubmessageKind.HEARTBEAT and len(events) == 1:
        return f"HEARTBEAT {first.fields['first']}..{first.fields['last']}"
    kinds = Counter("malformed" if event.kind is None else event.kind.name for event in events)
    words = ", ".join(name if count == 1 else f"{name} ×{count}" for name, count in kinds.items())
    if first.is_reliable:
        words += f" {first.sequence}"
    if len(events) == 1 and "status" in first.fields:
        words += f" {first.fields['status']}"
    return words
