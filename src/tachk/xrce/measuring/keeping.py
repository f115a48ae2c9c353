"""Samples written before a client requests them: how many of them the Agent keeps for a late client."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from tachk.base.records import dataclass
from tachk.xrce.measuring.conversation import MILLISECOND
from tachk.xrce.measuring.quantity import Confidence, Observation, PacketPlace, Quantity, QuantityUnit, seen
from tachk.xrce.transmissions import Capture
from tachk.xrce.wire import SubmessageKind


@dataclass(frozen=True, slots=True)
class LateRequest:
    """The first READ_DATA of a client, sent when samples had come to the Agent that the client gets later.

    Attributes:
        written: how many had come.
        delivered: how many of them the client gets.
        waited: milliseconds from the first of them to READ_DATA.
        packet: of READ_DATA.
        wanted: the samples that it asks for; None is one.
    """

    written: int
    delivered: int
    waited: float
    packet: int
    wanted: int | None


def late_requests(recording: Capture) -> Iterator[LateRequest]:
    """The late requests of every client, as far as samples differ in their content."""
    sent = recording.transmissions
    written = sent.rows(to_agent=True, kinds=(SubmessageKind.WRITE_DATA,))
    written = written[~sent.is_lost[written]]
    for link in range(len(recording.links)):
        request = next(sent.where(link, kinds=frozenset({SubmessageKind.READ_DATA})), None)
        if request is None:
            continue
        before, owners = sent.samples_of(written[sent.arrived[written] < request.sent], SubmessageKind.WRITE_DATA)
        if not len(before):
            continue
        handed = sent.rows(link, to_agent=False, kinds=(SubmessageKind.DATA,))
        got, _ = sent.samples_of(handed[sent.sent[handed] >= request.sent], SubmessageKind.DATA)
        different, first = np.unique(before, return_index=True)
        delivered = int(np.isin(different, got).sum())
        if delivered:
            waited = (request.sent - int(sent.arrived[owners[first]].min())) / MILLISECOND
            detail = next(event for event in request.events if event.kind is SubmessageKind.READ_DATA)
            wanted = detail.fields["max_samples"]
            yield LateRequest(
                len(different), delivered, waited, request.packet, wanted if isinstance(wanted, int) else None
            )


def retained_samples(found: Sequence[tuple[str, LateRequest]]) -> Quantity:
    """The number of samples that the Agent keeps: seen where a client gets fewer than were written, but not where it
    asks for no more."""
    name, title = "kept", "samples that the Agent keeps for a client that asks late"
    fewer = [(file, one) for file, one in found if one.delivered < one.written and one.delivered != (one.wanted or 1)]
    samples = tuple(Observation(one.delivered, (PacketPlace(file, one.packet),)) for file, one in fewer or found)
    if not samples:
        return seen(name, title, (), "no client asks for samples that have been written before", QuantityUnit.COUNT)
    most = max(sample.value for sample in samples)
    if not fewer:
        how = f"at least {most:g}: the client gets all that had been written"
        return Quantity(name, title, QuantityUnit.COUNT, samples, most, Confidence.BOUND, how)
    confidence = Confidence.MEASURED if len(samples) > 1 else Confidence.ONE_SAMPLE
    written = max(one.written for _, one in fewer)
    return Quantity(
        name, title, QuantityUnit.COUNT, samples, most, confidence, f"of up to {written} that had been written"
    )
