"""All quantities of some captures, and the settings that they amount to."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from tachk.base.arguments import checked_arguments
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.frames import data_frame
from tachk.base.notebook import folded, html_table
from tachk.base.records import dataclass, replace
from tachk.xrce.datagrams import Flags
from tachk.xrce.measuring import faults, heartbeats, keeping, sleeps, traffic
from tachk.xrce.measuring.conversation import Conversation, MomentKind, conversations, rows_of
from tachk.xrce.measuring.heartbeats import USUAL_PERIOD, HeartbeatLaw, Starving
from tachk.xrce.measuring.input_windows import input_history, unanswered
from tachk.xrce.measuring.quantity import (
    Confidence,
    Observation,
    PackedSamples,
    Quantity,
    QuantityUnit,
    gathered,
    seen,
)
from tachk.xrce.measuring.recorded_settings import SettingsEvidence, recorded_settings
from tachk.xrce.measuring.settings import LinkDirection, Setting, SettingsFindings, settings
from tachk.xrce.objects import Numbering, Objects
from tachk.xrce.packed_transmissions import PackedTransmissions
from tachk.xrce.packets import CaptureError, Numbers
from tachk.xrce.transmissions import Capture, read_transmissions
from tachk.xrce.wire import SubmessageKind

_ABOUT_OBJECTS = frozenset({SubmessageKind.CREATE, SubmessageKind.READ_DATA})
_DELAYED = 2000.0
"""Milliseconds from the first sample to READ_DATA; what is shorter is set-up."""

_ENOUGH, _NEARLY_ALL, _SHORTLY = 20, 0.9, 50_000_000
"""A line was recorded twice if, of at least 20 messages, nine tenths are there twice within 50 milliseconds."""

_NO_RELAY = "only a capture of both sides of a relay shows what is lost, copied or late"


@dataclass(frozen=True, slots=True)
class Measurement:
    """The parameters of a system of DDS-XRCE, as captures show them.

    Attributes:
        files: the captures, together.
        quantities: everything that was looked for, also what no capture shows.
        settings: constants of a model of the protocol; see `tachk.xrce.measuring.settings`.
        recorded: those of a model that recordings are held against; see `tachk.xrce.measuring.recorded_settings`.
        problems: which captures end too early, and why; which seem to have each message twice.
    """

    files: tuple[str, ...]
    quantities: tuple[Quantity, ...]
    settings: tuple[Setting, ...]
    recorded: tuple[Setting, ...] = ()
    problems: tuple[str, ...] = ()

    def to_rows(self) -> list[dict[str, str | int | float | None]]:
        """A row for each quantity, also for those that no capture shows."""
        return [
            {
                "name": each.name,
                "value": each.value,
                "unit": each.unit.value,
                "min": each.minimum,
                "median": each.median,
                "max": each.maximum,
                "seen": len(each.samples),
                "confidence": each.confidence.value,
                "what": each.title,
            }
            for each in self.quantities
        ]

    def to_frame(self) -> Any:
        """`to_rows` as a `pandas.DataFrame`. Raises UsageError where pandas is not installed."""
        return data_frame(self.to_rows())

    def __repr__(self) -> str:
        seen = sum(bool(each.samples) for each in self.quantities)
        return f"<Measurement of {', '.join(self.files)}: {seen} of {len(self.quantities)} quantities seen>"

    def _repr_html_(self) -> str:
        rows = [list(row.values())[1:] for row in self.to_rows() if row["seen"]]
        unseen = [f"{each.title}: {each.how}" for each in self.quantities if not each.samples]
        settings = [
            f"{each.name} = {each.in_units(1):g}    {each.confidence.value}: {each.how}" for each in self.settings
        ]
        columns = ("value", "unit", "min", "median", "max", "seen", "confidence", "what")
        return "\n".join(
            [
                html_table(columns, rows, f"{self!r}"[1:-1]),
                folded("settings of a model, in ms", "\n".join(settings)),
                folded("not enough evidence", "\n".join((*self.problems, *unseen))),
            ]
        )

    def quantity(self, name: str) -> Quantity:
        """Raises KeyError."""
        return {quantity.name: quantity for quantity in self.quantities}[name]

    def definitions(self, milliseconds: float = 1.0) -> dict[str, int]:
        """The settings as constants of a model whose unit of time has so many milliseconds; `tachk.load` takes them."""
        return {setting.name: setting.in_units(milliseconds) for setting in self.settings}

    def recorded_definitions(self, milliseconds: float = 1.0) -> dict[str, int]:
        """The same for a model that `tachk.conform` holds recordings against."""
        return {setting.name: setting.in_units(milliseconds) for setting in self.recorded}


@checked_arguments
def measure(*files: str | Path, ports: Iterable[int] = ()) -> Measurement:
    """Parameters of clients, Agents and networks in captures of DDS-XRCE.

    Args:
        files: pcap or pcapng captures of the same system; what they show is put together.
        ports: of Agents, and of relays that were recorded on both sides; without any 8888 and wherever a session is
            created.

    Raises UsageError for what is not a capture, OSError for a file that cannot be read.
    """
    wanted = tuple(ports)
    recordings = tuple((Path(file).name, _read(Path(file), wanted)) for file in files)
    return _Measuring(recordings).measured(tuple(map(str, files)))


def _read(file: Path, ports: tuple[int, ...]) -> Capture:
    try:
        return read_transmissions(file, ports)
    except CaptureError as error:
        raise UsageError(f"{file}: {error}", "tcpdump -i any -w FILE.pcap udp port 8888 makes a capture") from None


class _Measuring:
    """The captures, cut into streams."""

    def __init__(self, recordings: Sequence[tuple[str, Capture]]) -> None:
        self.recordings = recordings
        found = [(c, recording) for file, recording in recordings for c in conversations(file, recording)]
        self.of_clients = [conversation for conversation, _ in found if conversation.from_client]
        self.of_agents = [(c, recording) for c, recording in found if not c.from_client]

    def measured(self, files: tuple[str, ...]) -> Measurement:
        law, law_known, period, starved = self._client()
        agent, phase = self._agent()
        dead = sleeps.dead_time(self.of_agents, agent.value)
        asleep = [(file, sleep) for file, recording in self.recordings for sleep in sleeps.sleeps(recording)]
        slices, inbound = _run_slices(starved, period)
        history = traffic.window("history", "window of the client", self.of_clients)
        window = traffic.window("agent_window", "window of the Agent", [c for c, _ in self.of_agents])
        stopped = [(file, stop) for file, recording in self.recordings for stop in self._stops(file, recording, asleep)]
        late = [(file, one) for file, recording in self.recordings for one in keeping.late_requests(recording)]
        quantities = (
            law_known,
            period,
            slices,
            inbound,
            agent,
            phase,
            dead,
            sleeps.sleep_quantity(asleep),
            *self._streams(),
            history,
            window,
            *self._network(),
            faults.stops_quantity(stopped),
            keeping.retained_samples(late),
        )
        requests = [request for _, recording in self.recordings for request in sleeps.read_requests(recording)]
        known = {quantity.name: quantity for quantity in quantities}
        dozing = tuple(sleep for _, sleep in asleep)
        written, pace = self._publisher()
        again = sum(_created_again(recording) for _, recording in self.recordings)
        ways = tuple(dict.fromkeys(self._way(file, stop) for file, stop in stopped))
        delayed = tuple(one for _, one in late if one.waited > _DELAYED)
        findings = SettingsFindings(
            known, law, dozing, tuple(requests), delayed, ways, written, pace, again, self._lost(asleep, stopped)
        )
        problems = tuple(
            f"{file}: {problem}" for file, recording in self.recordings for problem in _problems(recording)
        )
        chosen = settings(findings)
        by_name = {setting.name: setting for setting in chosen}
        not_received = sum(
            int((self._asleep(file, recording, asleep) & (recording.transmissions.counts > 0)).sum())
            for file, recording in self.recordings
        )
        clients = max(len(recording.links) for _, recording in self.recordings)
        not_received += sum(unanswered(recording) for _, recording in self.recordings)
        counted = SettingsEvidence(
            known, by_name, self._samples(), self._longest(), clients, not_received, self._rounds(), self._numberings()
        )
        recorded = recorded_settings(counted)
        recorded += tuple(input_history(recording for _, recording in self.recordings))
        return Measurement(files, quantities, chosen, recorded, problems)

    def _samples(self) -> int:
        kinds = SubmessageKind.WRITE_DATA, SubmessageKind.DATA
        found = [recording.transmissions for _, recording in self.recordings]
        return max(len(np.unique(sent.samples_of(sent.rows(kinds=kinds), *kinds)[0])) for sent in found)

    def _longest(self) -> int:
        everybody = [*self.of_clients, *(conversation for conversation, _ in self.of_agents)]
        numbers = [c.numbers[c.kinds == MomentKind.SENT] for c in everybody]
        for _, recording in self.recordings:
            sent = recording.transmissions
            numbers.append(sent.sequence[(sent.stream > 0) & ~sent.is_reliable])
        return int(max((each.max() for each in numbers if len(each)), default=0)) + 1

    def _numberings(self) -> tuple[Numbering, ...]:
        return tuple(_numbering(recording.transmissions) for _, recording in self.recordings)

    def _rounds(self) -> list[int]:
        """The times at which Agents sent HEARTBEATs."""
        found = (time for c, _ in self.of_agents for time in c.times[c.kinds == MomentKind.HEARTBEAT].tolist())
        return sorted(found) if len(self.recordings) == 1 else []

    def _publisher(self) -> tuple[int, Quantity]:
        """The number of samples of the client that waits longest for an ACKNACK, and its pace."""
        writers = [conversation for conversation in self.of_clients if len(traffic.writes(conversation))]
        if not writers:
            return 0, seen("pace", "", (), "")
        chosen = max(writers, key=traffic.longest_unacknowledged)
        return len(traffic.writes(chosen)), seen("pace", "", gathered([traffic.paces(chosen)]), "")

    def _client(self) -> tuple[HeartbeatLaw | None, Quantity, Quantity, list[Starving]]:
        found = [wait for conversation in self.of_clients for wait in heartbeats.waits(conversation)]
        period = heartbeats.client_period(found, heartbeats.client_law(found)[0])
        usual = period.value or USUAL_PERIOD
        starved = [one for conversation in self.of_clients for one in heartbeats.starvings(conversation, usual)]
        law, law_found = heartbeats.law_quantity(found, starved, usual)
        return law, law_found, period, starved

    def _agent(self) -> tuple[Quantity, Quantity]:
        rounds = [heartbeats.agent_rounds(conversation) for conversation, _ in self.of_agents]
        return heartbeats.agent_period(
            PackedSamples.together([between for between, _ in rounds]),
            PackedSamples.together([first for _, first in rounds]),
        )

    def _streams(self) -> Iterator[Quantity]:
        agents = [conversation for conversation, _ in self.of_agents]
        sides = (("client", self.of_clients, "to_agent"), ("Agent", agents, "to_client"))
        for who, found, _ in sides:
            title = f"from a message of the {who} to its ACKNACK"
            yield _of(f"{who.lower()}_round_trip", title, found, traffic.round_trips, "no message is acknowledged")
        for who, found, way in sides:
            title = f"from a lost message of the {who} to its arrival"
            yield _of(f"repair_{way}", title, found, traffic.repairs, "no lost message is seen to arrive later")
        title = "from a message to a HEARTBEAT that was due when the client was in no run function"
        missing = "no HEARTBEAT follows a message at once"
        yield _of("overdue_heartbeat", title, self.of_clients, heartbeats.overdue, missing)
        title = "between two samples that a client writes"
        yield _of("pace", title, self.of_clients, traffic.paces, "no client writes twice")

    def _network(self) -> Iterator[Quantity]:
        for to_agent, way, words in ((True, "to_agent", "to the Agent"), (False, "to_client", "to clients")):
            samples = gathered(
                s for file, recording in self.recordings for s in traffic.losses(file, recording, to_agent)
            )
            loss = seen(
                f"loss_{way}", f"lost packets {words}, of each client", samples, _NO_RELAY, QuantityUnit.PERCENT
            )
            yield self._together(loss, to_agent)
        none = "no packet arrives {}" if any(link.relay for _, r in self.recordings for link in r.links) else _NO_RELAY
        overtaking = "how much earlier a packet arrives than one that was sent before it"
        answering = "from a message that comes to a client to its next ACKNACK"
        never = none.format("before an older one")
        for name, title, function, unit, missing in (
            ("delay", "delay of a packet", traffic.delays, QuantityUnit.MILLISECONDS, _NO_RELAY),
            ("client_reaction", answering, traffic.reactions, QuantityUnit.MILLISECONDS, _NO_RELAY),
            (
                "copies",
                "arrivals of a packet that was copied",
                traffic.copies,
                QuantityUnit.COUNT,
                none.format("twice"),
            ),
            ("overtaking", overtaking, traffic.overtakings, QuantityUnit.MILLISECONDS, never),
        ):
            observed = (samples for file, recording in self.recordings for samples in function(file, recording))
            yield seen(name, title, gathered(observed), missing, unit)

    def _together(self, loss: Quantity, to_agent: bool) -> Quantity:
        """The loss with all packets counted together."""
        known = lost = 0
        for _, recording in self.recordings:
            sent = recording.transmissions
            rows = sent.rows(to_agent=to_agent)
            known += int(sent.is_observed[rows].sum())
            lost += int(sent.is_lost[rows].sum())
        if not known:
            return loss
        how = f"{lost} of {known} packets came to a relay and not out of it"
        return replace(loss, value=100 * lost / known, confidence=Confidence.MEASURED, how=how)

    @staticmethod
    def _asleep(file: str, recording: Capture, found: Sequence[tuple[str, sleeps.Sleep]]) -> Flags:
        """For each transmission of a capture whether it was sent to a client that slept."""
        return sleeps.asleep(recording, [sleep for name, sleep in found if name == file])

    def _stops(
        self, file: str, recording: Capture, asleep: Sequence[tuple[str, sleeps.Sleep]]
    ) -> Iterator[faults.StreamStop]:
        """Ways that stop for good while both ends are awake."""
        return faults.stops(recording, self._asleep(file, recording, asleep))

    def _way(self, file: str, stop: faults.StreamStop) -> LinkDirection:
        writes = any(c.file == file and c.link == stop.link and len(traffic.writes(c)) for c in self.of_clients)
        return LinkDirection(writes, stop.to_agent)

    def _lost(
        self, asleep: Sequence[tuple[str, sleeps.Sleep]], stopped: Sequence[tuple[str, faults.StreamStop]]
    ) -> int | None:
        """The number of packets that were lost on their way to an awake receiver, on a way that did not stop for good;
        None if that was not recorded."""
        if not any(link.relay for _, recording in self.recordings for link in recording.links):
            return None
        count = 0
        for file, recording in self.recordings:
            lost = recording.transmissions.is_lost & ~self._asleep(file, recording, asleep)
            for name, stop in stopped:
                if name == file:
                    lost[stop.rows] = False
            count += int(lost.sum())
        return count


def _numbering(sent: PackedTransmissions) -> Numbering:
    """The numbers of topics and data readers, as far as whole messages show them."""
    objects = Objects()
    for one in sent.where(to_agent=True, kinds=_ABOUT_OBJECTS):
        for event in one.events:
            objects.note(one.link, event)
            if event.kind is SubmessageKind.READ_DATA:
                objects.read(one.link, event)
    if objects.rate:
        objects.sizes |= _size_of_first(sent, SubmessageKind.DATA)
        objects.written_sizes |= _size_of_first(sent, SubmessageKind.WRITE_DATA)
    return objects.numbering()


def _size_of_first(sent: PackedTransmissions, kind: SubmessageKind) -> set[int]:
    """The octets of the first sample in a submessage of this kind."""
    first = islice(sent.where(kinds=frozenset({kind})), 1)
    return {len(str(event.fields["sample"])) // 2 for one in first for event in one.events if event.kind is kind}


def _problems(recording: Capture) -> Iterator[str]:
    if recording.problem:
        yield recording.problem
    for number, link in enumerate(recording.links):
        ours = recording.transmissions.rows(number) if link.relay is None else np.zeros(0, np.int64)
        if len(ours) >= _ENOUGH and 2 * _twice(recording.transmissions, ours) > _NEARLY_ALL * len(ours):
            yield (
                f"nearly every message of {link.name} is there twice: the line was recorded at two places that "
                "cannot be distinguished, so repetitions and times are wrong; cut out what was recorded at one of them"
            )


def _twice(sent: PackedTransmissions, ours: Numbers) -> int:
    """The number of messages shortly after an equal one of the same direction, each of which is counted once."""
    _, numbers, counts = np.unique(sent.contents(ours), return_inverse=True, return_counts=True)
    several = counts[numbers] > 1
    open_: dict[int, int] = {}
    count = 0
    for content, time in rows_of(numbers[several], sent.sent[ours[several]]):
        if time - open_.pop(content, time - _SHORTLY) < _SHORTLY:
            count += 1
        else:
            open_[content] = time
    return count


def _created_again(recording: Capture) -> int:
    """The number of times that CREATE_CLIENT came to the Agent after messages of the client's streams."""
    sent = recording.transmissions
    rows = sent.rows(to_agent=True)
    rows = rows[sent.is_reliable[rows] & ~sent.is_lost[rows]]
    links, first = np.unique(sent.links[rows], return_index=True)
    times = dict(zip(links.tolist(), sent.arrived[rows[first]].tolist(), strict=True))
    return sum(
        time > times[one.link]
        for one in sent.where(to_agent=True, kinds=frozenset({SubmessageKind.CREATE_CLIENT}))
        if one.link in times
        for time in ([one.sent] if one.arrivals is None else [arrival.time for arrival in one.arrivals])
    )


def _of(
    name: str,
    title: str,
    found: Sequence[Conversation],
    function: Callable[[Conversation], PackedSamples],
    missing: str,
) -> Quantity:
    return seen(name, title, gathered(map(function, found)), missing)


def _run_slices(starved: Sequence[Starving], period: Quantity) -> tuple[Quantity, Quantity]:
    """The run calls of the application, and the events outside that start the timer again."""
    known = period.value or USUAL_PERIOD
    silent = [one for one in starved if one.gap > 3 * known]
    busy = [one for one in starved if one.gap <= 3 * known and one.length > 3 * known and len(one.traffic) > 2]
    name, title = "run_slice", "length of the calls of the run function"
    if silent:
        samples = tuple(Observation(one.gap, one.places) for one in silent)
        how = (
            f"shorter than {known:g} ms: for up to {max(s.value for s in samples):.0f} ms messages were "
            "unacknowledged, nothing left or came in, and no HEARTBEAT was sent"
        )
        slices = Quantity(name, title, QuantityUnit.MILLISECONDS, samples, None, Confidence.BOUND, how)
    elif period.value is not None:
        how = f"at least {known:g} ms: HEARTBEATs came in time"
        slices = Quantity(name, title, QuantityUnit.MILLISECONDS, period.samples, None, Confidence.BOUND, how)
    else:
        slices = seen(name, title, (), "no message was unacknowledged for long enough to decide")
    inbound = [Observation(gap, one.places) for one in busy for gap in one.traffic]
    missing = "no packets of other streams kept HEARTBEATs from being sent"
    return slices, seen("traffic", "between packets that kept HEARTBEATs from being sent", inbound, missing)
